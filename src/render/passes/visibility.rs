//! Visibility: rasterizes depth and ids, nothing else.

use std::sync::Arc;

use crate::{
    decide::cull::is_outside,
    pipeline::{
        pass::declared_overrides,
        prelude::*,
        raster::{self, Pipelines, RasterState, record},
    },
    plan::has_primary_rays,
    upload::{
        draw::{Draw, DrawClass},
        draw_calls::DrawCalls,
        draw_shape::DrawShape,
    },
};
use reflet_gpu::Shader;

/// See `shaders/visibility.wgsl`.
pub const PASS: Pass = Pass {
    name: "visibility",
    group: PassGroup::Surfaces,
    color: [61, 155, 204],
    attachments: &[Target::RasterDepth, Target::Ids],
    needed: |_, options| !has_primary_rays(options),
    ..Pass::DEFAULT
};

/// The visibility pass on the device: a pipeline for each class of draw calls in use.
#[derive(Debug)]
pub struct Visibility {
    /// Whether opaque triangles are drawn with indices.
    is_indexed: bool,
    pipelines: Pipelines<DrawClass>,
    /// Pipelines for culled back faces, where the march needs their depth.
    culled: Pipelines<DrawClass>,
    /// Pipelines for instances that only reflections show, or show more of, where the march needs their depth.
    unseen: Pipelines<DrawClass>,
}

impl FramePass for Visibility {
    /// Creates the pipelines that the draw calls need.
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        let draws = &builder.resources.scene.draws;
        let has_culled = builder.plan.features.culled_surfaces;
        let culled = draws.iter().filter(|d| has_culled && is_culled(d));
        let unseen = draws.iter().filter(|d| has_culled && is_unseen(d));
        Ok(Self {
            is_indexed: is_indexed(builder.shader(&PASS)?),
            pipelines: pipelines(builder, draws, Faces::Shown)?,
            unseen: pipelines(builder, unseen, Faces::Unseen)?,
            culled: pipelines(builder, culled, Faces::Culled)?,
        })
    }

    fn record(&self, frame: &mut SubFrame<'_>) {
        let (scene, targets) = (frame.resources.scene, frame.resources.targets);
        let views = (targets.view(Target::Ids), targets.view(Target::RasterDepth));
        let (Some(ids), Some(depth)) = views else {
            return;
        };
        let calls = self.draw_calls(frame);
        let recorder = &mut frame.recorder;
        record(recorder, PASS.name, scene, &calls, Some(ids), depth, None);
    }
}

impl Visibility {
    /// Draw calls of instances that the camera may see.
    fn draw_calls<'a>(&'a self, frame: &SubFrame<'a>) -> DrawCalls<'a> {
        let mut calls = DrawCalls::new(frame.recorder.gpu.is_software());
        let scene = frame.resources.scene;
        let mut add_all = |pipelines: &'a [(DrawClass, Arc<wgpu::RenderPipeline>)],
                           is_drawn: fn(&Draw) -> bool| {
            // In the order of instances: of coplanar surfaces the first that is drawn stays.
            for draws in scene.draws.chunk_by(|a, b| a.class == b.class) {
                let class = draws[0].class;
                let found = pipelines.iter().find(|(known, _)| *known == class);
                let Some((_, pipeline)) = found else {
                    continue;
                };
                let is_seen =
                    |d: &&Draw| is_drawn(d) && !is_outside(&frame.clip_from_world, &d.bounds);
                let in_view = draws.iter().filter(is_seen);
                calls.add(in_view, pipeline, self.is_indexed && class.is_indexed());
            }
        };
        add_all(&self.pipelines, |draw| draw.shown.visible);
        // Drawn last: most culled surfaces lie behind visible ones, and only their depth is kept.
        add_all(&self.culled, is_culled);
        add_all(&self.unseen, is_unseen);
        calls
    }
}

/// Whether the device supports primitive indices, so that triangles can be drawn with indices.
fn is_indexed(shader: &Shader) -> bool {
    shader.info.entry_point(VERTEX_INDEXED).is_some()
}

/// Entry point in `shaders/lib/triangles_indexed.wgsl`.
const VERTEX_INDEXED: &str = "vertex_indexed";

/// Whether the camera culls back faces of the instance that reflections may show.
fn is_culled(draw: &Draw) -> bool {
    draw.shown.visible && draw.hides_backs
}

/// Whether only reflections show the instance, or more of it than a pixel's center does: a cut-out may be solid where a ray
/// passes over a pixel in whose center it has a hole.
fn is_unseen(draw: &Draw) -> bool {
    draw.shown.in_reflections && (!draw.shown.visible || draw.class.cutout)
}

/// Faces of single-sided triangles that a pipeline draws, and targets that it writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Faces {
    /// Front faces, with ids and depth.
    Shown,
    /// Back faces, into the depth only.
    Culled,
    /// All faces, those cut away included, into the depth only.
    Unseen,
}

/// A pipeline for each class of these draw calls.
fn pipelines<'a>(
    builder: &PassBuilder<'_>,
    draws: impl IntoIterator<Item = &'a Draw>,
    faces: Faces,
) -> Result<Pipelines<DrawClass>, GpuError> {
    let classes = draws.into_iter().flat_map(|draw| {
        let mirrored = draw.dynamic.then_some(DrawClass {
            mirrored: !draw.class.mirrored,
            ..draw.class
        });
        [draw.class].into_iter().chain(mirrored)
    });
    raster::pipelines(classes, |class| pipeline(builder, class, faces))
}

fn pipeline(
    builder: &PassBuilder<'_>,
    class: DrawClass,
    faces: Faces,
) -> Result<Arc<wgpu::RenderPipeline>, GpuError> {
    let (gpu, shared, shader) = (builder.gpu, builder.shared, builder.shader(&PASS)?);
    let groups = [&shared.layouts[0], &shared.layouts[1]];
    let mut constants = declared_overrides(shader, &builder.overrides(&PASS));
    let is_cut_out = class.cutout && faces != Faces::Unseen;
    constants.push(("CUTOUT", f64::from(u8::from(is_cut_out))));
    let cull_mode = match faces {
        _ if class.shape != DrawShape::Triangles => {
            constants.push(class.shape.constant());
            None
        }
        _ if class.double_sided => None,
        Faces::Shown => Some(wgpu::Face::Back),
        Faces::Culled => Some(wgpu::Face::Front),
        Faces::Unseen => None,
    };
    let ids = wgpu::ColorTargetState {
        write_mask: match faces {
            Faces::Shown => wgpu::ColorWrites::ALL,
            Faces::Culled | Faces::Unseen => wgpu::ColorWrites::empty(),
        },
        ..Target::Ids.format(false).into()
    };
    let is_indexed = is_indexed(shader) && class.is_indexed();
    let (vertex, fragment) = match class.shape {
        DrawShape::Triangles if is_indexed => (VERTEX_INDEXED, "fragment_indexed"),
        DrawShape::Triangles => ("vertex", "fragment"),
        DrawShape::Spheres | DrawShape::Capsules => ("vertex_capsule", "fragment_capsule"),
    };
    let front_face = match class.mirrored {
        true => wgpu::FrontFace::Cw,
        false => wgpu::FrontFace::Ccw,
    };
    let state = RasterState {
        vertex,
        fragment: Some(fragment),
        is_indexed,
        primitive: wgpu::PrimitiveState {
            front_face,
            cull_mode,
            ..Default::default()
        },
        ids: Some(ids),
        depth: Target::RasterDepth.format(false),
    };
    let key = format!("{class:?} {faces:?}");
    state.pipeline(gpu, shader, PASS.name, &key, &groups, &constants)
}
