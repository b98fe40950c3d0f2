//! Runs of elements in a buffer view: their range is checked, and their alignment found.

use super::{Fault, schema::BufferView};

/// Elements one after another in a buffer view; sizes in bytes.
pub struct Run {
    pub offset: u64,
    pub count: u64,
    pub stride: usize,
    pub bytes: usize,
    pub component: usize,
}

impl Run {
    /// Bytes from the view's start to the end of the last element.
    fn end(&self) -> Option<u64> {
        (self.count.checked_sub(1)?)
            .checked_mul(self.stride as u64)?
            .checked_add(self.offset)?
            .checked_add(self.bytes as u64)
    }

    /// Same as `end`, for elements that lie in `view`.
    ///
    /// # Errors
    /// Elements beyond the end of the view.
    pub fn end_in(&self, view: &BufferView) -> Result<u64, Fault> {
        let end = self.end().filter(|end| *end <= view.byte_length);
        end.ok_or_else(|| {
            let text = format!(
                "{} elements of {} bytes from offset {} at stride {} do not fit the bufferView of \
                 {} bytes",
                self.count, self.bytes, self.offset, self.stride, view.byte_length
            );
            Fault::new("gltf-accessor", text)
        })
    }

    /// Whether every component starts at a multiple of its size (glTF 2.0 §3.6.2.4), for elements that lie in `view`.
    pub fn is_aligned(&self, view: &BufferView) -> bool {
        let starts = [self.offset, view.byte_offset, self.stride as u64];
        starts
            .iter()
            .all(|at| at.is_multiple_of(self.component as u64))
    }
}
