//! Filled and stroked shapes of SVG files (<https://www.w3.org/TR/SVG2/>), whose styles, transforms and references usvg resolves.

use std::{collections::HashMap, fmt::Display};

use kurbo::PathEl;
use reflet_scene::desc::{FigureDesc, FillRule, OutlineDesc};
use usvg::{
    FillRule as Rule, Group, ImageHrefResolver, Node, Options, Tree,
    roxmltree::{Document, ParsingOptions},
    tiny_skia_path::{PathSegment, PathStroker, Point},
};

use super::{
    Fault, Supplies,
    flatten::{Filled, Pen},
};

/// Largest size of a file, bytes, and of the elements that it uses again.
const MOST_BYTES: usize = 1_000_000;
/// Largest number of elements and texts of a file, and of elements within each other.
const MOST_NODES: u32 = 10_000;
const MOST_DEPTH: usize = 100;
/// Whatever fills and strokes nothing, or would be repeated along a path, is not made.
const PATHS_ALONE: &str = "* { marker: none !important; clip-path: none !important; mask: none !important; \
                           filter: none !important }";
/// Scale for which curves beside strokes are drawn: they are as near as a quarter of a pixel is at this size.
const STROKE_SCALE: f32 = 64.0;

fn wrong(what: impl Display, help: &str) -> Fault {
    Fault::new("wrong-svg", format!("this SVG file {what}")).help(help)
}

/// The filled shapes of an outline's file and the outlines of its strokes, in its pixels, y upwards; none of an outline without a file.
///
/// # Errors
/// `wrong-svg` for bytes that are no such file, and one that is too large, has text or no shape; `wrong-outline`
/// for one of too many chords.
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
    add(&mut parts, &mut Pen::new(segments), tree.root())?;
    if parts.is_empty() {
        let help = "give a path of it a fill or a stroke";
        return Err(wrong("has no filled or stroked shape", help));
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
fn add(parts: &mut Vec<Filled>, pen: &mut Pen, group: &Group) -> Result<(), Fault> {
    for node in group.children() {
        let path = match node {
            Node::Group(group) => {
                add(parts, pen, group)?;
                continue;
            }
            Node::Path(path) if path.is_visible() => path,
            _ => continue,
        };
        let filled = path.fill().map(|fill| match fill.rule() {
            Rule::NonZero => (FillRule::Nonzero, path.data().clone()),
            Rule::EvenOdd => (FillRule::Evenodd, path.data().clone()),
        });
        let scale = STROKE_SCALE * PathStroker::compute_resolution_scale(&path.abs_transform());
        let stroked = path.stroke().and_then(|stroke| {
            let stroke = stroke.to_tiny_skia();
            let dashed = (stroke.dash.as_ref()).map(|dash| path.data().dash(dash, scale));
            let line = dashed.unwrap_or_else(|| Some(path.data().clone()))?;
            Some((FillRule::Nonzero, line.stroke(&stroke, scale)?))
        });
        let upwards = path.abs_transform().post_scale(1.0, -1.0);
        let at = |p: Point| (f64::from(p.x), f64::from(p.y)).into();
        for (rule, outline) in filled.into_iter().chain(stroked) {
            let moved = outline.transform(upwards);
            for segment in moved.iter().flat_map(|path| path.segments()) {
                pen.draw(match segment {
                    PathSegment::MoveTo(p) => PathEl::MoveTo(at(p)),
                    PathSegment::LineTo(p) => PathEl::LineTo(at(p)),
                    PathSegment::QuadTo(a, p) => PathEl::QuadTo(at(a), at(p)),
                    PathSegment::CubicTo(a, b, p) => PathEl::CurveTo(at(a), at(b), at(p)),
                    PathSegment::Close => PathEl::ClosePath,
                });
            }
            parts.push((rule, pen.finish()?));
        }
    }
    Ok(())
}
