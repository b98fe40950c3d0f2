//! Draw calls of a pass in parts: software adapters keep what is drawn, about 300 bytes for each capsule, until their
//! threads have drawn it.

use std::ops::Range;

use super::{
    draw::{Draw, merged},
    draw_shape::DrawShape,
};

/// Maximum number of capsules that a software adapter draws in one submission.
const MAX_PART: u64 = 1 << 18;

/// Several instances of one mesh, or a part of it, drawn by one pipeline.
#[derive(Debug)]
struct DrawCall<'a> {
    first: &'a Draw,
    pipeline: &'a wgpu::RenderPipeline,
    is_indexed: bool,
    /// Range of vertices, or of indices where it is indexed.
    vertices: Range<u32>,
    instances: Range<u32>,
}

/// Draw calls of a pass in their order.
#[derive(Debug)]
pub struct DrawCalls<'a> {
    parts: Vec<Vec<DrawCall<'a>>>,
    /// Number of capsules in the last part.
    num_capsules: u64,
    max_part: u64,
}

impl<'a> DrawCalls<'a> {
    /// No draw calls, which become one part, or on software adapters as many as their capsules need.
    pub fn new(is_software: bool) -> Self {
        Self {
            parts: vec![Vec::new()],
            num_capsules: 0,
            max_part: if is_software { MAX_PART } else { u64::MAX },
        }
    }

    /// Adds draw calls of one pipeline: indexed with the bound buffers, or with vertices that the shader pulls.
    /// Successive instances of one mesh become one call.
    pub fn add(
        &mut self,
        draws: impl Iterator<Item = &'a Draw>,
        pipeline: &'a wgpu::RenderPipeline,
        is_indexed: bool,
    ) {
        for (first, instances) in merged(draws) {
            let count = first.indices.len() as u32 / 3;
            let is_capsules = first.class.shape != DrawShape::Triangles;
            let max_piece = if is_capsules { self.max_part } else { u64::MAX };
            for (shapes, instances) in pieces(count, instances, max_piece) {
                if is_capsules {
                    self.make_room(shapes.len() as u64 * instances.len() as u64);
                }
                let (vertices, first_vertex) = match is_indexed {
                    true => (3, first.indices.start),
                    false => (first.class.shape.num_vertices(), 0),
                };
                let call = DrawCall {
                    first,
                    pipeline,
                    is_indexed,
                    vertices: first_vertex + vertices * shapes.start
                        ..first_vertex + vertices * shapes.end,
                    instances,
                };
                self.parts.last_mut().expect("a part").push(call);
            }
        }
    }

    /// Begins another part if the last one cannot take so many more capsules.
    fn make_room(&mut self, num_capsules: u64) {
        if self.num_capsules + num_capsules > self.max_part {
            self.parts.push(Vec::new());
            self.num_capsules = 0;
        }
        self.num_capsules += num_capsules;
    }

    /// Number of parts, at least one.
    pub fn num_parts(&self) -> usize {
        self.parts.len()
    }

    /// Records the draw calls of a part.
    pub fn record(&self, part: usize, pass: &mut wgpu::RenderPass<'_>) {
        let mut bound = None;
        for call in &self.parts[part] {
            if bound != Some(call.pipeline) {
                pass.set_pipeline(call.pipeline);
                bound = Some(call.pipeline);
            }
            let (vertices, instances) = (call.vertices.clone(), call.instances.clone());
            match call.is_indexed {
                true => pass.draw_indexed(vertices, call.first.vertex_base, instances),
                false => pass.draw(vertices, instances),
            }
        }
    }
}

/// Cuts instances of a mesh into ranges of its shapes and of whole instances, in the order of drawing, with at most
/// `max_piece` shapes each.
fn pieces(
    num_shapes: u32,
    instances: Range<u32>,
    max_piece: u64,
) -> impl Iterator<Item = (Range<u32>, Range<u32>)> {
    let at_most = |limit: u64, count: u32| limit.clamp(1, u64::from(count.max(1))) as u32;
    let shapes_step = at_most(max_piece, num_shapes);
    let whole = max_piece / u64::from(num_shapes.max(1));
    let instances_step = at_most(whole, instances.len() as u32);
    ranges(instances, instances_step).flat_map(move |instances| {
        ranges(0..num_shapes, shapes_step).map(move |shapes| (shapes, instances.clone()))
    })
}

/// Successive ranges of at most `step`.
fn ranges(all: Range<u32>, step: u32) -> impl Iterator<Item = Range<u32>> {
    let end = all.end;
    all.step_by(step as usize)
        .map(move |start| start..end.min(start.saturating_add(step)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shape_of_every_instance_is_drawn_once_in_pieces_that_fit() {
        for (num_shapes, instances, max_piece) in [
            (10, 3..4, 4),
            (10, 2..7, 4),
            (10, 2..7, 25),
            (10, 2..7, 10),
            (1, 0..100, 7),
            (5, 0..3, u64::MAX),
        ] {
            let mut drawn = Vec::new();
            for (shapes, of) in pieces(num_shapes, instances.clone(), max_piece) {
                assert!(shapes.len() as u64 * of.len() as u64 <= max_piece);
                drawn.extend(of.flat_map(|i| shapes.clone().map(move |shape| (i, shape))));
            }
            let all: Vec<_> = instances
                .flat_map(|i| (0..num_shapes).map(move |shape| (i, shape)))
                .collect();
            assert_eq!(drawn, all, "pieces of {max_piece}");
        }
    }

    #[test]
    fn what_fits_is_one_piece() {
        assert_eq!(pieces(10, 2..7, 50).collect::<Vec<_>>(), [(0..10, 2..7)]);
    }
}
