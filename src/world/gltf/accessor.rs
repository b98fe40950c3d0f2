//! Buffer views and accessors: every count, range, stride and alignment is checked before a byte
//! is read (by `gather`).

use std::sync::atomic::AtomicU64;

use super::{
    Fault,
    container::Bytes,
    schema::{Accessor, BufferView, Root},
};

/// Most elements of an accessor that has no data behind it; nothing else bounds those.
const MAX_VIRTUAL_ELEMENTS: u64 = 1 << 24;

/// The document's buffers and what may still be decoded from them.
pub struct Data<'a> {
    root: &'a Root,
    buffers: Vec<Option<Bytes>>,
    /// What may still be decoded.
    pub(super) bytes_left: AtomicU64,
}

/// Where the elements of an accessor lie; all offsets are inside the view.
pub struct Layout {
    pub component: Component,
    pub lanes: usize,
    pub count: usize,
    pub offset: usize,
    pub stride: usize,
}

/// glTF's `componentType`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    pub fn new(code: u32) -> Option<Self> {
        Some(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }
}

pub(super) fn fault(text: String) -> Fault {
    Fault::new("gltf-accessor", text)
}

/// Components of one element, and its bytes with the padding of matrix columns.
pub(super) fn shape(kind: &str, size: usize) -> Option<(usize, usize)> {
    let column = |rows: usize| (rows * size).div_ceil(4) * 4;
    Some(match kind {
        "SCALAR" => (1, size),
        "VEC2" => (2, 2 * size),
        "VEC3" => (3, 3 * size),
        "VEC4" => (4, 4 * size),
        "MAT2" => (4, 2 * column(2)),
        "MAT3" => (9, 3 * column(3)),
        "MAT4" => (16, 4 * column(4)),
        _ => return None,
    })
}

/// Bytes from `offset` to the end of the last of `count` elements.
fn extent(offset: u64, stride: usize, count: u64, size: usize) -> Option<u64> {
    count
        .checked_sub(1)?
        .checked_mul(stride as u64)?
        .checked_add(offset)?
        .checked_add(size as u64)
}

impl<'a> Data<'a> {
    /// Checks all buffer views and accessors against the buffers. At most `budget_bytes` are
    /// decoded through the result.
    ///
    /// # Errors
    /// The first accessor or view that is out of range, misaligned or of unknown type.
    pub fn new(
        root: &'a Root,
        buffers: Vec<Option<Bytes>>,
        budget_bytes: u64,
    ) -> Result<Self, Fault> {
        let data = Self {
            root,
            buffers,
            bytes_left: AtomicU64::new(budget_bytes),
        };
        for (i, view) in root.buffer_views.iter().enumerate() {
            data.check_view(view)
                .map_err(|f| f.at(&format!("bufferView {i}")))?;
        }
        for i in 0..root.accessors.len() {
            data.layout(i)?;
        }
        Ok(data)
    }

    fn check_view(&self, view: &BufferView) -> Result<(), Fault> {
        let fault = |text: String| Err(Fault::new("gltf-buffer-view", text));
        let Some(buffer) = self.root.buffers.get(view.buffer) else {
            return fault(format!("buffer {} does not exist", view.buffer));
        };
        let end = view.byte_offset.checked_add(view.byte_length);
        if end.is_none_or(|end| end > buffer.byte_length) {
            return fault(format!(
                "byteOffset {} + byteLength {} lies outside buffer {} of {} bytes",
                view.byte_offset, view.byte_length, view.buffer, buffer.byte_length
            ));
        }
        match view.byte_stride {
            Some(s) if !(4..=252).contains(&s) || s % 4 != 0 => fault(format!(
                "byteStride is {s}, expected a multiple of 4 from 4 to 252"
            )),
            _ => Ok(()),
        }
    }

    pub(super) fn accessor(&self, index: usize) -> Result<&'a Accessor, Fault> {
        (self.root.accessors.get(index))
            .ok_or_else(|| fault(format!("accessor {index} does not exist")))
    }

    fn view(&self, index: usize) -> Result<&'a BufferView, Fault> {
        (self.root.buffer_views.get(index))
            .ok_or_else(|| fault(format!("bufferView {index} does not exist")))
    }

    /// The bytes of a buffer view.
    pub fn view_bytes(&self, index: usize) -> Result<Bytes, Fault> {
        let view = self.view(index)?;
        let buffer = self.buffers.get(view.buffer).and_then(Option::as_ref);
        let buffer = buffer.ok_or_else(|| {
            let text = format!("buffer {} has no uri and no GLB chunk", view.buffer);
            Fault::new("buffer-missing", text)
        })?;
        let start = usize::try_from(view.byte_offset).ok();
        let length = usize::try_from(view.byte_length).ok();
        let range = start.and_then(|start| Some(start..start.checked_add(length?)?));
        (range.and_then(|range| buffer.slice(range)))
            .ok_or_else(|| fault(format!("bufferView {index} lies outside its buffer")))
    }

    pub(super) fn layout(&self, index: usize) -> Result<Layout, Fault> {
        let accessor = self.accessor(index)?;
        self.check_accessor(accessor)
            .map_err(|f| f.at(&format!("accessor {index}")))
    }

    fn check_accessor(&self, accessor: &Accessor) -> Result<Layout, Fault> {
        let component = Component::new(accessor.component_type).ok_or_else(|| {
            fault(format!(
                "componentType {} is unknown",
                accessor.component_type
            ))
        })?;
        let size = component.size();
        let (lanes, bytes) = shape(&accessor.kind, size).ok_or_else(|| {
            fault(format!(
                "type \"{}\" is unknown",
                super::uri::shorten(&accessor.kind)
            ))
        })?;
        if accessor.count == 0 {
            return Err(fault("count is 0, expected 1 or more".into()));
        }
        let mut stride = bytes;
        if let Some(view) = accessor.buffer_view {
            let view = self.view(view)?;
            stride = view.byte_stride.map_or(bytes, |s| s as usize);
            if stride < bytes {
                return Err(fault(format!(
                    "elements of {bytes} bytes overlap at stride {stride}"
                )));
            }
            check_range(
                view,
                accessor.byte_offset,
                stride,
                accessor.count,
                bytes,
                size,
            )?;
        } else if accessor.count > MAX_VIRTUAL_ELEMENTS {
            let text = format!(
                "{} elements without a bufferView, at most {MAX_VIRTUAL_ELEMENTS}",
                accessor.count
            );
            return Err(Fault::new("geometry-too-large", text));
        }
        self.check_sparse(accessor, bytes, size)?;
        let out_of_memory = |_| fault("does not fit this machine's memory".into());
        Ok(Layout {
            component,
            lanes,
            count: usize::try_from(accessor.count).map_err(out_of_memory)?,
            offset: usize::try_from(accessor.byte_offset).map_err(out_of_memory)?,
            stride,
        })
    }

    fn check_sparse(&self, accessor: &Accessor, bytes: usize, size: usize) -> Result<(), Fault> {
        let Some(sparse) = &accessor.sparse else {
            return Ok(());
        };
        if sparse.count == 0 || sparse.count > accessor.count {
            return Err(fault(format!(
                "sparse.count is {}, expected 1 to {}",
                sparse.count, accessor.count
            )));
        }
        let index_size = match Component::new(sparse.indices.component_type) {
            Some(c @ (Component::U8 | Component::U16 | Component::U32)) => c.size(),
            _ => {
                return Err(fault(
                    "sparse.indices.componentType is not an unsigned integer".into(),
                ));
            }
        };
        let (indices, values) = (&sparse.indices, &sparse.values);
        let (index_view, value_view) = (
            self.view(indices.buffer_view)?,
            self.view(values.buffer_view)?,
        );
        check_range(
            index_view,
            indices.byte_offset,
            index_size,
            sparse.count,
            index_size,
            index_size,
        )
        .map_err(|f| f.at("sparse.indices"))?;
        check_range(
            value_view,
            values.byte_offset,
            bytes,
            sparse.count,
            bytes,
            size,
        )
        .map_err(|f| f.at("sparse.values"))
    }

    /// Number of elements of an accessor.
    pub fn count(&self, index: usize) -> Result<usize, Fault> {
        self.layout(index).map(|l| l.count)
    }

    /// Components of one element; 0 where the accessor does not exist.
    pub fn lanes(&self, index: usize) -> usize {
        self.layout(index).map_or(0, |l| l.lanes)
    }
}

fn check_range(
    view: &BufferView,
    offset: u64,
    stride: usize,
    count: u64,
    bytes: usize,
    size: usize,
) -> Result<(), Fault> {
    if extent(offset, stride, count, bytes).is_none_or(|end| end > view.byte_length) {
        return Err(fault(format!(
            "{count} elements of {bytes} bytes from offset {offset} at stride {stride} do not fit \
             the bufferView of {} bytes",
            view.byte_length
        )));
    }
    // No overflow: the offset lies in the view, whose end was computed without one.
    let aligned = |at: u64| at.is_multiple_of(size as u64);
    if !aligned(offset) || !aligned(offset + view.byte_offset) {
        return Err(fault(format!(
            "offset {offset} in a bufferView at {} is not aligned to {size} bytes",
            view.byte_offset
        )));
    }
    Ok(())
}

/// What core glTF allows for positions, and tangent frames.
pub fn float_only(component: Component, _normalized: bool) -> bool {
    component == Component::F32
}

/// Texture coordinates and colors: floats or normalized unsigned integers.
pub fn float_or_unsigned(component: Component, normalized: bool) -> bool {
    component == Component::F32 || normalized && matches!(component, Component::U8 | Component::U16)
}

/// KHR_mesh_quantization for normals and tangents, EXT_mesh_gpu_instancing for rotations.
pub fn float_or_signed(component: Component, normalized: bool) -> bool {
    component == Component::F32 || normalized && matches!(component, Component::I8 | Component::I16)
}

/// KHR_mesh_quantization for positions and texture coordinates.
pub fn any_but_u32(component: Component, _normalized: bool) -> bool {
    component != Component::U32
}
