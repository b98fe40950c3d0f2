//! Shapes that are described by numbers.

mod check;
mod read;

use std::sync::Arc;

use glam::Vec3;
use reflet_text::Lines;

pub(super) use self::check::{MOST_CURVE_POINTS, wrong_curve};
use super::{
    At, BevelDesc, FigureDesc, FileDesc, OutlineDesc, PlacementDesc, Written, outline::SEGMENTS,
    placement::placed,
};
use crate::{
    range::{ABOVE_0, ANY, FROM_0, Range, UNIT, range},
    table::{
        Keys,
        points::{Numbers, Points},
    },
};

/// Range of a part of a turn, degrees.
const TURN_DEG: Range = range(0.0, 360.0).above();

declared! {
    /// `shape = { kind = "…" }`, centered on the origin unless said; spheres and capsules are exact, other curved ones are tessellated.
    #[derive(Clone, Debug, PartialEq)]
    #[kinds(check::shape)]
    #[table(
        "shape = { kind = …, … }", files(file: "png" | "jpg" | "jpeg" | "webp", font: "ttf" | "otf" | "ttc"),
        instead(read::kind_of)
    )]
    pub enum ShapeDesc {
        /// `"plane"`: in XZ, facing +Y.
        Plane = "plane" {
            /// Edge lengths along X and Z, meters, above 0. Default [1, 1].
            size: [f32; 2] [ABOVE_0] = [1.0, 1.0],
        },
        /// `"box"`
        Box = "box" {
            /// Edge lengths, meters, above 0. Default [1, 1, 1].
            size: Vec3 [ABOVE_0] = Vec3::ONE,
            /// Rounding of the edges.
            ///
            /// - `bevel`: how far edges are cut or rounded, meters, 0 or more, at most half of the shortest length.
            ///   Default 0.
            /// - `bevel_segments`: steps of the bevel, 1 to 64: 1 is a flat cut, more is rounder. Default 4.
            #[by(|t| BevelDesc::read(t, size?.min_element() / 2.0, "half of the shortest length"))]
            bevel: BevelDesc,
        },
        /// `"sphere"`
        Sphere = "sphere" {
            /// Radius, meters, above 0. Default 0.5.
            radius: f32 [ABOVE_0] = 0.5,
            /// Divisions around, 3 to 1024; half as many from pole to pole. Without it the sphere is exact, or has 128
            /// where its material needs triangles: textures, anisotropy, `light = true`, or an `alpha` that varies.
            segments: Option<u32> [SEGMENTS],
        },
        /// `"cylinder"`: axis Y, standing on y = 0, with caps.
        Cylinder = "cylinder" {
            /// Radius, meters, above 0. Default 0.5.
            radius: f32 [ABOVE_0] = 0.5,
            /// Height, meters, above 0. Default 1.
            height: f32 [ABOVE_0] = 1.0,
            /// Divisions around, 3 to 1024. Default 64.
            segments: u32 [SEGMENTS] = 64,
        },
        /// `"cone"`: axis Y, standing on y = 0, with a cap below.
        Cone = "cone" {
            /// Radius of the foot, meters, above 0. Default 0.5.
            radius: f32 [ABOVE_0] = 0.5,
            /// Height, meters, above 0. Default 1.
            height: f32 [ABOVE_0] = 1.0,
            /// Divisions around, 3 to 1024. Default 64.
            segments: u32 [SEGMENTS] = 64,
        },
        /// `"disk"`: in XZ, facing +Y.
        Disk = "disk" {
            /// Radius, meters, above 0. Default 0.5.
            radius: f32 [ABOVE_0] = 0.5,
            /// Divisions around, 3 to 1024. Default 64.
            segments: u32 [SEGMENTS] = 64,
        },
        /// `"torus"`: a ring around axis Y.
        Torus = "torus" {
            /// Distance from the center to the middle of the tube, meters, above 0. Default 0.5.
            radius: f32 [ABOVE_0] = 0.5,
            /// Radius of the tube, meters, above 0 and at most `radius`. Default 0.15.
            tube_radius: f32 [ABOVE_0] = 0.15,
            /// Divisions around, 3 to 1024; half as many around the tube. Default 96.
            segments: u32 [SEGMENTS] = 96,
            /// Part of the turn around Y, degrees, above 0 and at most 360, from +Z towards +X; less than a turn has
            /// flat ends. Default 360.
            angle_deg: f32 [TURN_DEG] = 360.0,
        },
        /// `"capsule"`: a cylinder with half spheres at its ends, axis Y, standing on y = 0.
        Capsule = "capsule" {
            /// Radius, meters, above 0. Default 0.25.
            radius: f32 [ABOVE_0] = 0.25,
            /// Length from end to end, meters, above 0 and at least twice the radius. Default 1.
            height: f32 [ABOVE_0] = 1.0,
            /// Divisions around, 3 to 1024. Without it the capsule is exact, or has 64 where a sphere would have 128.
            segments: Option<u32> [SEGMENTS],
        },
        /// `"lathe"`: an outline turned around axis Y, with exactly one of `points` and `outline`.
        ///
        /// - `points`: an outline from below upwards, 2 to 1000 points, each the distance from the axis, 0 or more, and
        ///   the height, meters. Its right side is outside; bends of more than 40° are edges. Where it ends away from
        ///   the axis the shape is open, but for a part of a turn, whose ends are joined to the axis.
        /// - `outline`: a flat figure whose x is the distance from the axis, nowhere less than 0, and whose y is the
        ///   height: the solid that it passes through.
        Lathe = "lathe" {
            /// Figure that is turned.
            #[by(LatheSource::read)]
            source: LatheSource,
            /// Divisions around, 3 to 1024, for a whole turn. Default 64.
            segments: u32 [SEGMENTS] = 64,
            /// Part of a turn, degrees, above 0 and at most 360, from +Z towards +X; less than a turn has flat ends.
            /// Default 360.
            angle_deg: f32 [TURN_DEG] = 360.0,
        },
        /// `"extrude"`: a flat figure with a thickness: in XY, from z = 0 to its face at z = `depth`. Texture
        /// coordinates of the faces span the outline's bounds; coordinates of its sides run once around, and from the
        /// face to the back.
        Extrude = "extrude" {
            /// The figure.
            #[by(read::outline)]
            outline: OutlineDesc,
            /// Thickness along Z, meters, above 0. Default 0.1.
            depth: f32 [ABOVE_0] = 0.1,
            /// Rounding of the edges of face and back.
            ///
            /// - `bevel`: how far the edges of face and back are cut or rounded, meters, 0 or more, at most half of
            ///   `depth` and as far as the outline is wide enough. Default 0.
            /// - `bevel_segments`: steps of the bevel, 1 to 64: 1 is a flat cut, more is rounder. Default 4.
            #[by(|t| BevelDesc::read(t, depth? / 2.0, "half of `depth`"))]
            bevel: BevelDesc,
        },
        /// `"sweep"`: a profile moved along a curve, without turning about it: cables, rails, frames. At corners it is
        /// mitered. Texture coordinates run once around the profile, and along the curve.
        Sweep = "sweep" {
            /// The profile; seen along the curve, its x points right and its y up. Default: a circle of radius 0.05.
            #[by(read::profile)]
            outline: OutlineDesc,
            /// Points of the curve, each x, y and z, meters, 2 to 10000.
            points: Vec<[f32; 3]> as Points,
            /// How the curve goes through its points. Default `"centripetal"`.
            curve: SweepCurve = SweepCurve::Centripetal,
            /// Whether the curve returns to its first point. Default false: it has flat ends.
            closed: bool = false,
            /// Turn of the profile from start to end, degrees, clockwise seen along the curve; a multiple of 360 if
            /// `closed`. Default 0.
            twist_deg: f32 = 0.0,
            /// Size of the profile at the end, as a factor on that at the start, 0 to 1000; 0 is a tip. In between it
            /// changes evenly along the curve. Default 1; a closed curve has no other.
            taper: f32 [range(0.0, 1000.0)] = 1.0,
            /// Steps from one point to the next of a curve that bends, 1 to 256: more is smoother. Default 16.
            segments: u32 [range(1.0, 256.0)] = 16,
            /// Place where the points are written.
            #[by(|t| Some(t.written("points")))]
            at: Written,
        },
        /// `"text"`: letters with a thickness: from z = 0 to their faces at z = `depth`, the first line standing on y =
        /// 0.
        Text = "text" {
            /// The text, 1 to 1000 characters; `\n` begins a new line. Letters are joined and kerned as the font says;
            /// words of scripts from right to left stand in their order (UAX #9).
            text: String,
            /// A font: a file with outlines (`.ttf`, `.otf`, or the first of a `.ttc`), searched beside the scene, then in
            /// each `--assets` folder, or the name of a font, such as `"DejaVu Sans Bold"`, whose file is in these folders
            /// or below them. Default: Ubuntu Light.
            #[by(|t| Some(FileDesc::read(t, "font")))]
            font: Option<FileDesc>,
            /// Size of the font (its em), meters, above 0; capitals are some 0.7 of it high. Default 0.2.
            size: f32 [ABOVE_0] = 0.2,
            /// Thickness along Z, meters, above 0. Default 0.05.
            depth: f32 [ABOVE_0] = 0.05,
            /// Rounding of the edges of the faces.
            ///
            /// - `bevel`: how far the edges of the faces are cut or rounded, meters, 0 or more, at most half of `depth`
            ///   and as far as the letters are wide enough. Default 0.
            /// - `bevel_segments`: steps of the bevel, 1 to 64: 1 is a flat cut, more is rounder. Default 4.
            #[by(|t| BevelDesc::read(t, depth? / 2.0, "half of `depth`"))]
            bevel: BevelDesc,
            /// Where x = 0 is in each line. Default `"center"`.
            align: TextAlign = TextAlign::Center,
            /// Distance between lines, as a factor on `size`, 0 to 100. Default 1.2.
            line_height: f32 [range(0.0, 100.0)] = 1.2,
            /// Space that is added after each letter and its marks, as a factor on `size`, -1 to 100; with any, letters have
            /// no ligatures. Default 0.
            letter_spacing: f32 [range(-1.0, 100.0)] = 0.0,
            /// Number of the only letter that is shown, 0 to 999, counted from left to right and line after line without
            /// spaces and other characters that cannot be seen; letters that the font draws as one count once. Its place in
            /// the text, which `text_letters` of scripts tells, is then at the origin. Default: all letters.
            letter: Option<u32> [range(0.0, 999.0)],
            /// Place where the letter is written.
            #[by(|t| Some(t.written("letter")))]
            letter_at: Written,
            /// Chords of a full turn of a curve, 3 to 1024: more is rounder. Default 64.
            segments: u32 [SEGMENTS] = 64,
            /// Place where the text is written.
            #[by(|t| Some(t.written("text")))]
            at: Written,
        },
        /// `"union"`: closed shapes as one: all points inside any of them.
        Union = "union" {
            /// The shapes, 2 to 100 tables, each with its place. All must be closed and none may pass through itself;
            /// where faces lie on each other they are joined. Each face keeps its texture coordinates.
            #[by(read::parts)]
            parts: Vec<PartDesc>,
        },
        /// `"difference"`: all points inside the first of closed shapes and in none of the others.
        Difference = "difference" {
            /// The shapes, 2 to 100 tables, each with its place: the first, from which the others are cut. All must be
            /// closed and none may pass through itself; where faces lie on each other no skin is left. Each face keeps
            /// its texture coordinates.
            #[by(read::parts)]
            parts: Vec<PartDesc>,
        },
        /// `"intersection"`: all points inside all of closed shapes.
        Intersection = "intersection" {
            /// The shapes, 2 to 100 tables, each with its place. All must be closed and none may pass through itself.
            /// Each face keeps its texture coordinates.
            #[by(read::parts)]
            parts: Vec<PartDesc>,
        },
        /// `"displaced"`: another shape, cut finer, smoothed and moved in and out by noise. It stays closed.
        Displaced = "displaced" {
            /// The shape, with the keys of any other.
            #[by(read::displaced)]
            shape: Box<ShapeDesc>,
            /// Times that each triangle is cut into four, 0 to 8. More shows finer noise and is smoother. Default 3.
            subdivide: u32 [range(0.0, 8.0)] = 3,
            /// Whether edges and corners are rounded (Loop subdivision); else the shape keeps them. Default false.
            smooth: bool = false,
            /// Noise along the normals.
            ///
            /// - `height`: distance that noise moves the surface in or out at most, meters, 0 or more. Default 0.
            /// - `size`: size of the largest bumps, meters, above 0. Default 0.2.
            /// - `octaves`: number of sizes of bumps, each half of the size before, 1 to 8. Default 4.
            /// - `seed`: number that other bumps follow from, 0 to 1000000. Default 0.
            #[by(Keys::read_keys)]
            noise: NoiseDesc,
        },
        /// `"mesh"`: triangles, most often of a script: `setup` returns them as `floats`, see `docs/scripting.md`. It
        /// is closed if each edge belongs to two triangles.
        Mesh = "mesh" {
            /// Places of the vertices, three numbers each, meters: 3 to 2000000 vertices.
            positions: Arc<[f32]> as Numbers,
            /// Triangles, three numbers of vertices each, from 0 or more, counter-clockwise seen from outside: 1 to
            /// 2000000 triangles.
            indices: Arc<[f32]> as Numbers [FROM_0],
            /// Directions out of the surface, three numbers for each vertex. Default: smooth over the triangles that
            /// share a vertex.
            #[by(|t| read::numbers(t, "normals", ANY))]
            normals: Arc<[f32]>,
            /// Texture coordinates, two numbers for each vertex, v down. Default: 0.
            #[by(|t| read::numbers(t, "uv", ANY))]
            uv: Arc<[f32]>,
            /// Linear colors that multiply the base color, three numbers 0 to 1 for each vertex. Default: none.
            #[by(|t| read::numbers(t, "colors", UNIT))]
            colors: Arc<[f32]>,
            /// Whether `frame` of a script may deform it, by `ctx.mesh`. Then it is traced apart from static
            /// instances, in a tree with the branches of `positions`. Default false.
            dynamic: bool = false,
        },
        /// `"heightfield"`: a surface whose height is the brightness of an image, black at y = 0, facing +Y.
        Heightfield = "heightfield" {
            /// The image, of 2 to 2048 pixels on each side, 8 or 16 bits; its top row is towards -Z.
            /// Searched beside the scene, then in each `--assets` folder.
            file: At<String>,
            /// Lengths along X, Y and Z, meters, above 0; Y is the height of white. Default [1, 0.25, 1].
            size: Vec3 [ABOVE_0] = Vec3::new(1.0, 0.25, 1.0),
        },
    }
}

/// Figure that a lathe turns.
#[derive(Clone, Debug, PartialEq)]
pub enum LatheSource {
    /// Points from below upwards, each the distance from the axis and the height, meters.
    Points(Vec<[f32; 2]>),
    /// A figure whose x is the distance from the axis.
    Outline(OutlineDesc),
}

declared! {
    /// How a curve goes through its points.
    #[words]
    pub enum SweepCurve = Centripetal {
        /// straight from point to point.
        Linear = "linear",
        /// smoothly, as `[motion]` does, without loops and cusps of its own.
        Centripetal = "centripetal",
        /// every third point is on it, points between are handles: 4, 7, 10 … points, or 3, 6, 9 … if `closed`.
        Bezier = "bezier",
    }
}

declared! {
    /// Noise that displaces a surface.
    #[derive(Clone, Copy, Debug, PartialEq)]
    #[keys]
    pub struct NoiseDesc {
        /// Largest distance, meters.
        pub height: f32 [FROM_0] = 0.0,
        /// Size of the largest bumps, meters.
        pub size: f32 [ABOVE_0] = 0.2,
        /// Number of sizes of bumps.
        pub octaves: u32 [range(1.0, 8.0)] = 4,
        /// Number that other bumps follow from.
        pub seed: u32 [range(0.0, 1e6)] = 0,
    }
}

declared! {
    /// Where x = 0 is in a line of text.
    #[words]
    pub enum TextAlign = Center {
        /// at its left end.
        Left = "left",
        /// in its middle.
        Center = "center",
        /// at its right end.
        Right = "right",
    }

    /// `parts = [{ shape = { … }, … }]`: a shape with its place among the others.
    #[derive(Clone, Debug, PartialEq)]
    #[table("parts = [{ shape = { … }, … }]", also(PlacementDesc))]
    pub struct PartDesc {
        /// The shape, with the keys of any other; shapes of shapes may be nested.
        #[by(read::part)]
        pub shape: ShapeDesc,
        /// Its place.
        #[by(placed)]
        pub placement: PlacementDesc,
        /// Place where the part is written.
        #[by(|t| Some(t.written("shape")))]
        pub at: Written,
    }
}

impl ShapeDesc {
    /// Parts of a shape of shapes; none for any other.
    pub fn parts(&self) -> &[PartDesc] {
        match self {
            Self::Union { parts } | Self::Difference { parts } | Self::Intersection { parts } => {
                parts
            }
            _ => &[],
        }
    }

    /// Number of vertices of a mesh that scripts may deform; `None` for any other shape.
    pub fn deforming_vertices(&self) -> Option<usize> {
        match self {
            Self::Mesh {
                positions, dynamic, ..
            } if *dynamic => Some(positions.len() / 3),
            _ => None,
        }
    }

    /// Lines of a text; `None` for any other shape.
    pub fn lines(&self) -> Option<Lines<'_>> {
        let Self::Text {
            text,
            size,
            align,
            line_height,
            letter_spacing,
            ..
        } = self
        else {
            return None;
        };
        Some(Lines {
            text,
            size: *size,
            line_height: *line_height,
            letter_spacing: *letter_spacing,
            align: match align {
                TextAlign::Left => 0.0,
                TextAlign::Center => 0.5,
                TextAlign::Right => 1.0,
            },
        })
    }

    /// Font and SVG files of the shape and of its parts.
    pub fn files(&self) -> Vec<&FileDesc> {
        let own = match self {
            Self::Displaced { shape, .. } => return shape.files(),
            Self::Text { font, .. } => font.as_ref(),
            Self::Extrude { outline, .. }
            | Self::Sweep { outline, .. }
            | Self::Lathe {
                source: LatheSource::Outline(outline),
                ..
            } => match &outline.figure {
                FigureDesc::Svg(file) => Some(file),
                _ => None,
            },
            _ => None,
        };
        let parts = self.parts().iter().flat_map(|part| part.shape.files());
        own.into_iter().chain(parts).collect()
    }
}
