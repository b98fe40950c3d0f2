//! Upper bounds of a compressed stream by the accessors of its primitive: more is not decoded.

use draco_core::DecodeLimits;

use super::{super::accessor::shape, fault, header::Header};
use crate::gltf::{
    Fault,
    schema::{Primitive, Root},
};

/// Bytes per face and vertex of the connectivity while it is decoded: corners with their opposites and vertices.
const BYTES_PER_FACE: u64 = 128;
/// Bytes per face of the seams of each set of attributes, which has corners of its own.
const SEAM_BYTES_PER_FACE: u64 = 64;
/// Bytes per vertex of attributes in the stream that the primitive does not use.
const UNUSED_BYTES_PER_POINT: u64 = 64;
/// Copies of an attribute while it is decoded: as integers, as numbers, and as the accessor has them.
const COPIES: u64 = 3;

/// Upper bounds of the content of a stream.
#[derive(Clone, Copy, Debug)]
pub struct StreamBounds {
    /// Number of vertices. Seams of attributes split vertices, at most into one for each corner.
    pub points: u64,
    /// Number of triangles.
    pub faces: u64,
    /// Bytes of a vertex in all attributes of the primitive.
    point_bytes: u64,
}

impl StreamBounds {
    /// The claim of a primitive's accessors.
    ///
    /// # Errors
    /// Primitives that are not triangles.
    pub fn from_accessors(root: &Root, primitive: &Primitive) -> Result<Self, Fault> {
        let accessor = |index: &usize| root.accessors.get(*index);
        let count = |index: &usize| accessor(index).map_or(0, |a| a.count);
        let vertices = primitive.attributes.values().map(count).max().unwrap_or(0);
        let corners = primitive.indices.as_ref().map_or(vertices, count);
        let faces = match primitive.mode.unwrap_or(4) {
            4 => corners / 3,
            5 => corners,
            _ => return Err(fault("only triangles can be compressed")),
        };
        let lanes = |index: &usize| {
            let shape = accessor(index).and_then(|a| shape(&a.kind, 1));
            shape.map_or(0, |shape| shape.lanes as u64)
        };
        Ok(Self {
            points: vertices.max(corners),
            faces,
            point_bytes: 4 * primitive.attributes.values().map(lanes).sum::<u64>(),
        })
    }

    /// The larger bounds of two primitives with the same stream.
    pub fn or(self, other: Self) -> Self {
        Self {
            points: self.points.max(other.points),
            faces: self.faces.max(other.faces),
            point_bytes: self.point_bytes.max(other.point_bytes),
        }
    }

    /// Limits of the decoder.
    pub fn limits(&self) -> DecodeLimits {
        let bytes = (self.points).saturating_mul(self.point_bytes + UNUSED_BYTES_PER_POINT);
        DecodeLimits::default()
            .with_max_points(self.points)
            .with_max_faces(self.faces)
            .with_max_decoded_bytes(bytes)
    }

    /// Most bytes that decoding the stream takes beside the decoded values.
    ///
    /// # Errors
    /// Streams whose header cannot be read.
    pub fn working_bytes(&self, stream: &[u8]) -> Result<u64, Fault> {
        let header = Header::read(stream)?;
        let per_point = COPIES * (self.point_bytes + UNUSED_BYTES_PER_POINT);
        let per_face = BYTES_PER_FACE + SEAM_BYTES_PER_FACE * header.num_attribute_sets;
        let points = self.points.saturating_mul(per_point);
        let faces = self.faces.saturating_mul(per_face);
        Ok(points
            .saturating_add(faces)
            .saturating_add(header.metadata_bytes))
    }

    /// Refuses a decoded stream that holds more.
    ///
    /// # Errors
    /// More vertices or triangles.
    pub fn check(&self, points: usize, faces: usize) -> Result<(), Fault> {
        for (what, found, most) in [
            ("vertices", points as u64, self.points),
            ("triangles", faces as u64, self.faces),
        ] {
            if found > most {
                let text = format!("its stream has {found} {what}, its accessors say {most}");
                return Err(fault(text));
            }
        }
        Ok(())
    }
}
