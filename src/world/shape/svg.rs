//! Filled and stroked shapes of SVG files (<https://www.w3.org/TR/SVG2/>), whose styles, transforms and references usvg resolves.

use std::{collections::HashMap, fmt::Display};

use kurbo::{ParamCurveArclen, PathEl};
use reflet_base::digits::grouped;
use reflet_scene::{
    desc::{FigureDesc, FillRule, OutlineDesc},
    suggest,
};
use usvg::{
    FillRule as Rule, Group, ImageHrefResolver, Node, Options, Path as Shape, Stroke, Tree,
    roxmltree::{Document, ParsingOptions},
    tiny_skia_path::{Path, PathBuilder, PathSegment, Point},
};

use super::{
    Fault, Supplies,
    flatten::{Filled, MOST_CHORDS, Pen},
};

/// Largest size of a file, bytes, and of the elements that it uses again.
const MOST_BYTES: usize = 1_000_000;
/// Largest number of elements and texts of a file, and of elements within each other.
const MOST_NODES: u32 = 10_000;
const MOST_DEPTH: usize = 100;
/// Style that takes away markers, which are repeated along a path, and clips, masks and filters, which are no shapes.
const PATHS_ALONE: &str = "* { marker: none !important; clip-path: none !important; mask: none !important; \
                           filter: none !important }";
/// Largest number of dashes of a stroke, as each has four sides or more.
const MOST_DASHES: usize = MOST_CHORDS / 4;
/// Distance that a stroke tells apart, relative to the largest coordinate: about what 32-bit floats do.
const TOLERANCE: f64 = 1e-6;

fn wrong(what: impl Display, help: &str) -> Fault {
    Fault::new("wrong-svg", format!("this SVG file {what}")).help(help)
}

/// The filled shapes of an outline's file and the outlines of its strokes, in its pixels, y upwards; none of an outline without a file.
///
/// # Errors
/// `wrong-svg` for bytes that are no such file, and one that is too large, has text, no shape or a stroke that cannot
/// be made; `wrong-outline` for one of too many chords.
pub fn parts(desc: &OutlineDesc, supplies: &Supplies) -> Result<Vec<Filled>, Fault> {
    let FigureDesc::Svg(file) = &desc.figure else {
        return Ok(Vec::new());
    };
    let bytes = supplies
        .files
        .get(&file.file)
        .map_or(&[][..], |bytes| bytes);
    read(bytes, desc.segments.max(3)).map_err(|fault| fault.placed(file.at.0.clone()))
}

fn read(bytes: &[u8], segments: u32) -> Result<Vec<Filled>, Fault> {
    let broken = |error: &dyn Display| {
        let help = "save it again as plain SVG, not compressed, for example with Inkscape";
        wrong(format!("cannot be read: {error}"), help)
    };
    let text = std::str::from_utf8(bytes).map_err(|error| broken(&error))?;
    if text.len() > MOST_BYTES || text.contains("<!ENTITY") {
        return Err(broken(
            &"it is larger than 1 MB, or has entities of its own",
        ));
    }
    let reading = ParsingOptions {
        allow_dtd: true,
        nodes_limit: MOST_NODES,
        ..ParsingOptions::default()
    };
    let document = Document::parse_with_options(text, reading).map_err(|error| broken(&error))?;
    check(&document)?;
    let options = Options {
        // An image is no outline, and any file could have its name.
        image_href_resolver: ImageHrefResolver {
            resolve_data: Box::new(|_, _, _| None),
            resolve_string: Box::new(|_, _| None),
        },
        style_sheet: Some(PATHS_ALONE.to_owned()),
        ..Options::default()
    };
    let tree = Tree::from_xmltree(&document, &options).map_err(|error| broken(&error))?;
    let mut parts = Vec::new();
    add(&mut parts, &mut Pen::new(segments), segments, tree.root())?;
    if parts.is_empty() {
        let help = "give a path a color as `fill`, or as `stroke` with a `stroke-width` above 0";
        let what = "has no filled shape, and no stroke with a color, a width and a length";
        return Err(wrong(what, help));
    }
    Ok(parts)
}

/// Refuses elements that would be left out without a word, and elements whose copies are not bounded by the file's size.
fn check(document: &Document) -> Result<(), Fault> {
    let nodes = document.descendants();
    let by_id: HashMap<_, _> = nodes
        .filter_map(|n| Some((n.attribute("id")?, n)))
        .collect();
    let mut used = 0;
    for node in document.descendants() {
        let mut is_unbounded = || {
            let href = node.attributes().find(|a| a.name() == "href");
            let name = href.map_or("", |href| href.value().trim().trim_start_matches('#'));
            let target = by_id.get(name);
            used += target.map_or(0, |target| target.range().len());
            let mut copies = target.iter().flat_map(|target| target.descendants());
            used > MOST_BYTES || copies.any(|copy| copy.tag_name().name() == "use")
        };
        let (what, help) = match node.tag_name().name() {
            _ if node.ancestors().count() > MOST_DEPTH => {
                ("too many groups in groups", "ungroup them")
            }
            "text" => (
                "text",
                "turn it into paths, in Inkscape by Path > Object to Path",
            ),
            "pattern" => ("a pattern", "fill its shapes with a color"),
            "use" if is_unbounded() => (
                "too many clones",
                "unlink them, in Inkscape by Edit > Clone",
            ),
            _ => continue,
        };
        let at = document.text_pos_at(node.range().start);
        return Err(wrong(format!("has {what}, at {at}"), help));
    }
    Ok(())
}

/// Adds the filled and stroked shapes of a group, with its groups.
fn add(parts: &mut Vec<Filled>, pen: &mut Pen, segments: u32, group: &Group) -> Result<(), Fault> {
    for node in group.children() {
        let path = match node {
            Node::Group(group) => {
                add(parts, pen, segments, group)?;
                continue;
            }
            Node::Path(path) if path.is_visible() => path,
            _ => continue,
        };
        let filled = path.fill().map(|fill| match fill.rule() {
            Rule::NonZero => (FillRule::Nonzero, path.data().clone()),
            Rule::EvenOdd => (FillRule::Evenodd, path.data().clone()),
        });
        let stroked = match path.stroke() {
            Some(stroke) => stroked(path, stroke, segments)?,
            None => None,
        };
        let stroked = stroked.map(|outline| (FillRule::Nonzero, outline));
        let upwards = path.abs_transform().post_scale(1.0, -1.0);
        for (rule, outline) in filled.into_iter().chain(stroked) {
            let moved = outline.transform(upwards);
            let drawn = moved.iter().flat_map(pieces);
            drawn.for_each(|piece| pen.draw(piece));
            parts.push((rule, pen.finish()?));
        }
    }
    Ok(())
}

/// Pieces of a path.
fn pieces(path: &Path) -> impl Iterator<Item = PathEl> {
    let at = |p: Point| (f64::from(p.x), f64::from(p.y)).into();
    path.segments().map(move |segment| match segment {
        PathSegment::MoveTo(p) => PathEl::MoveTo(at(p)),
        PathSegment::LineTo(p) => PathEl::LineTo(at(p)),
        PathSegment::QuadTo(a, p) => PathEl::QuadTo(at(a), at(p)),
        PathSegment::CubicTo(a, b, p) => PathEl::CurveTo(at(a), at(b), at(p)),
        PathSegment::Close => PathEl::ClosePath,
    })
}

/// The path with `segments` chords for a whole turn of its curves: both edges of its stroke then have the same turns, and
/// are as far apart as the stroke is wide.
fn of_chords(path: &Path, segments: u32) -> Result<Option<Path>, Fault> {
    let (mut pen, mut chords) = (Pen::new(segments), PathBuilder::new());
    for piece in pieces(path) {
        pen.draw(piece);
        match piece {
            PathEl::MoveTo(p) => chords.move_to(p.x as f32, p.y as f32),
            PathEl::ClosePath => chords.close(),
            PathEl::LineTo(p) => chords.line_to(p.x as f32, p.y as f32),
            PathEl::QuadTo(..) | PathEl::CurveTo(..) => {
                for [_, to] in pen.take_open().iter().map(|chord| chord.ends) {
                    chords.line_to(to.x as f32, to.y as f32);
                }
            }
        }
    }
    pen.finish()?;
    Ok(chords.finish())
}

/// The outline of the stroke of a shape; `None` for a stroke that covers nothing, such as a dashed one that begins with a
/// long gap.
fn stroked(shape: &Shape, stroke: &Stroke, segments: u32) -> Result<Option<Path>, Fault> {
    let refuse = |what: &str, help| {
        let name = match shape.id() {
            "" => String::new(),
            id => format!(", in the shape {}", suggest::text(id)),
        };
        Err(wrong(format!("has a stroke {what}{name}"), help))
    };
    let brush = stroke.to_tiny_skia();
    let Some(mut line) = of_chords(shape.data(), segments)? else {
        return Ok(None);
    };
    let points = line.points().iter();
    let reach = points.fold(brush.width, |most, p| most.max(p.x.abs()).max(p.y.abs()));
    let tolerance = f64::from(reach) * TOLERANCE;
    // A power of two, by which directions are multiplied without rounding.
    let scale = (0.25 / tolerance).log2().ceil().clamp(-100.0, 100.0).exp2() as f32;
    let lengths = kurbo::segments(pieces(&line)).map(|piece| piece.arclen(tolerance));
    let length: f64 = lengths.sum();
    if let Some((dash, pattern)) = brush.dash.as_ref().zip(stroke.dasharray()) {
        let repeat: f64 = pattern.iter().map(|part| f64::from(*part)).sum();
        if length / repeat * (pattern.len() / 2) as f64 > MOST_DASHES as f64 {
            let what = format!("of more than {} dashes", grouped(MOST_DASHES as u64));
            let help = "make the parts of its `stroke-dasharray` longer, or remove it";
            return refuse(&what, help);
        }
        let Some(dashed) = line.dash(dash, scale) else {
            return Ok(None);
        };
        line = dashed;
    }
    match line.stroke(&brush, scale) {
        None if length > 0.0 && brush.dash.is_none() => refuse(
            "that cannot be made",
            "draw it smaller, and check its `stroke-width`",
        ),
        outline => Ok(outline),
    }
}
