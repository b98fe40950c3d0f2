//! Buffer views and accessors: every count, range, stride and alignment is validated before bytes
//! are read (by `gather`).

use std::sync::OnceLock;

use super::{
    Fault,
    budget::GeometryBudget,
    container::Bytes,
    meshopt,
    schema::{Accessor, BufferView, Root},
};

/// Maximum number of elements of an accessor without data, which nothing else bounds.
const MAX_VIRTUAL_ELEMENTS: u64 = 1 << 22;

/// The document's buffers, with a decode budget.
pub struct Data<'a> {
    root: &'a Root,
    buffers: Vec<Option<Bytes>>,
    /// Decompressed buffer views, each on first use.
    decompressed: Vec<OnceLock<Result<Bytes, Fault>>>,
    pub(super) budget: GeometryBudget,
}

/// Layout of an accessor's elements; all offsets are inside the view.
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

/// The layout of one element.
#[derive(Clone, Copy)]
pub struct Shape {
    /// Number of components.
    pub lanes: usize,
    /// Bytes from one element to the next when tightly packed; matrix columns start at multiples of 4.
    pub pitch: usize,
    /// Bytes up to the end of the last component; less than `pitch` for some matrices.
    pub bytes: usize,
}

/// The layout of an element of a `type` whose components have `size` bytes.
pub(super) fn shape(kind: &str, size: usize) -> Option<Shape> {
    let vector = |lanes: usize| Shape {
        lanes,
        pitch: lanes * size,
        bytes: lanes * size,
    };
    let matrix = |side: usize| {
        let column = (side * size).next_multiple_of(4);
        Shape {
            lanes: side * side,
            pitch: side * column,
            bytes: (side - 1) * column + side * size,
        }
    };
    Some(match kind {
        "SCALAR" => vector(1),
        "VEC2" => vector(2),
        "VEC3" => vector(3),
        "VEC4" => vector(4),
        "MAT2" => matrix(2),
        "MAT3" => matrix(3),
        "MAT4" => matrix(4),
        _ => return None,
    })
}

impl<'a> Data<'a> {
    /// Checks all buffer views and accessors against the buffers. Bytes that the result decodes are taken from
    /// `budget`.
    ///
    /// # Errors
    /// The first accessor or view that is out of range, misaligned or of unknown type.
    pub fn new(
        root: &'a Root,
        buffers: Vec<Option<Bytes>>,
        budget: GeometryBudget,
    ) -> Result<Self, Fault> {
        let data = Self {
            root,
            buffers,
            decompressed: root.buffer_views.iter().map(|_| OnceLock::new()).collect(),
            budget,
        };
        for (i, view) in root.buffer_views.iter().enumerate() {
            data.check_view(view)
                .map_err(|f| f.at(&format!("bufferView {i}")))?;
        }
        for (i, accessor) in root.accessors.iter().enumerate() {
            // Unknown types are an error only where they are used.
            if shape(&accessor.kind, 1).is_some() {
                data.layout(i)?;
            }
        }
        Ok(data)
    }

    fn check_view(&self, view: &BufferView) -> Result<(), Fault> {
        let fault = |text: String| Err(Fault::new("gltf-buffer-view", text));
        self.check_range(view.buffer, view.byte_offset, view.byte_length)?;
        if let Some(stream) = view.extensions.meshopt() {
            self.check_range(stream.buffer, stream.byte_offset, stream.byte_length)
                .and_then(|()| meshopt::check(view, stream).map(|_| ()))
                .map_err(|f| f.at("meshopt compression"))?;
        }
        match view.byte_stride {
            Some(s) if !(4..=252).contains(&s) || s % 4 != 0 => fault(format!(
                "byteStride is {s}, expected a multiple of 4 from 4 to 252"
            )),
            _ => Ok(()),
        }
    }

    /// Checks bytes of a buffer against its stated length.
    fn check_range(&self, buffer: usize, offset: u64, length: u64) -> Result<(), Fault> {
        let fault = |text: String| Err(Fault::new("gltf-buffer-view", text));
        let Some(found) = self.root.buffers.get(buffer) else {
            return fault(format!("buffer {buffer} does not exist"));
        };
        let end = offset.checked_add(length);
        if end.is_none_or(|end| end > found.byte_length) {
            return fault(format!(
                "byteOffset {offset} + byteLength {length} lies outside buffer {buffer} of {} bytes",
                found.byte_length
            ));
        }
        Ok(())
    }

    pub(super) fn accessor(&self, index: usize) -> Result<&'a Accessor, Fault> {
        (self.root.accessors.get(index))
            .ok_or_else(|| fault(format!("accessor {index} does not exist")))
    }

    fn view(&self, index: usize) -> Result<&'a BufferView, Fault> {
        (self.root.buffer_views.get(index))
            .ok_or_else(|| fault(format!("bufferView {index} does not exist")))
    }

    /// The bytes of a buffer view, decompressed.
    pub fn view_bytes(&self, index: usize) -> Result<Bytes, Fault> {
        let view = self.view(index)?;
        let place = || format!("bufferView {index}");
        let Some(stream) = view.extensions.meshopt() else {
            let bytes = self.buffer_bytes(view.buffer, view.byte_offset, view.byte_length);
            return bytes.map_err(|f| f.at(&place()));
        };
        let decompress = || {
            let decoding = meshopt::check(view, stream)?;
            let encoded =
                self.buffer_bytes(stream.buffer, stream.byte_offset, stream.byte_length)?;
            self.spend(decoding.bytes)?;
            // The decoder's own layout and that before a filter are copies.
            let _held = self.budget.hold(decoding.bytes.saturating_mul(2))?;
            meshopt::decode(&decoding, &encoded).map(Bytes::new)
        };
        self.decompressed[index]
            .get_or_init(|| decompress().map_err(|f| f.at(&place())))
            .clone()
    }

    fn buffer_bytes(&self, buffer: usize, offset: u64, length: u64) -> Result<Bytes, Fault> {
        let bytes = self.buffers.get(buffer).and_then(Option::as_ref);
        let bytes = bytes.ok_or_else(|| {
            let text = format!("buffer {buffer} has no uri and no GLB chunk");
            Fault::new("buffer-missing", text)
        })?;
        let start = usize::try_from(offset).ok();
        let length = usize::try_from(length).ok();
        let range = start.and_then(|start| Some(start..start.checked_add(length?)?));
        (range.and_then(|range| bytes.slice(range)))
            .ok_or_else(|| fault("it lies outside its buffer".into()))
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
        let shape = shape(&accessor.kind, size).ok_or_else(|| {
            fault(format!(
                "type \"{}\" is unknown",
                super::uri::shorten(&accessor.kind)
            ))
        })?;
        if accessor.count == 0 {
            return Err(fault("count is 0, expected 1 or more".into()));
        }
        let mut stride = shape.pitch;
        if let Some(view) = accessor.buffer_view {
            let view = self.view(view)?;
            stride = view.byte_stride.map_or(stride, |s| s as usize);
            if stride < shape.bytes {
                return Err(fault(format!(
                    "elements of {} bytes overlap at stride {stride}",
                    shape.bytes
                )));
            }
            let run = Run {
                offset: accessor.byte_offset,
                count: accessor.count,
                stride,
                bytes: shape.bytes,
                component: size,
            };
            run.check(view)?;
        } else if accessor.count > MAX_VIRTUAL_ELEMENTS {
            let text = format!(
                "{} elements without a bufferView, at most {MAX_VIRTUAL_ELEMENTS}",
                accessor.count
            );
            return Err(Fault::new("geometry-too-large", text));
        }
        self.check_sparse(accessor, shape, size)?;
        let out_of_memory = |_| fault("does not fit this machine's memory".into());
        Ok(Layout {
            component,
            lanes: shape.lanes,
            count: usize::try_from(accessor.count).map_err(out_of_memory)?,
            offset: usize::try_from(accessor.byte_offset).map_err(out_of_memory)?,
            stride,
        })
    }

    fn check_sparse(&self, accessor: &Accessor, shape: Shape, size: usize) -> Result<(), Fault> {
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
        let indices = Run {
            offset: sparse.indices.byte_offset,
            count: sparse.count,
            stride: index_size,
            bytes: index_size,
            component: index_size,
        };
        let values = Run {
            offset: sparse.values.byte_offset,
            count: sparse.count,
            stride: shape.pitch,
            bytes: shape.bytes,
            component: size,
        };
        (self
            .view(sparse.indices.buffer_view)
            .and_then(|view| indices.check(view)))
        .map_err(|f| f.at("sparse.indices"))?;
        (self
            .view(sparse.values.buffer_view)
            .and_then(|view| values.check(view)))
        .map_err(|f| f.at("sparse.values"))
    }

    /// Number of elements of an accessor.
    pub fn count(&self, index: usize) -> Result<usize, Fault> {
        self.layout(index).map(|l| l.count)
    }

    /// Number of components of one element; 0 where the accessor does not exist.
    pub fn lanes(&self, index: usize) -> usize {
        self.layout(index).map_or(0, |l| l.lanes)
    }
}

/// Elements one after another in a buffer view; sizes in bytes.
struct Run {
    offset: u64,
    count: u64,
    stride: usize,
    bytes: usize,
    component: usize,
}

impl Run {
    /// Bytes from the view's start to the end of the last element.
    fn end(&self) -> Option<u64> {
        (self.count.checked_sub(1)?)
            .checked_mul(self.stride as u64)?
            .checked_add(self.offset)?
            .checked_add(self.bytes as u64)
    }

    fn check(&self, view: &BufferView) -> Result<(), Fault> {
        if self.end().is_none_or(|end| end > view.byte_length) {
            return Err(fault(format!(
                "{} elements of {} bytes from offset {} at stride {} do not fit the bufferView of \
                 {} bytes",
                self.count, self.bytes, self.offset, self.stride, view.byte_length
            )));
        }
        let aligned = |at: u64| at.is_multiple_of(self.component as u64);
        // No overflow: the offset lies in the view, whose end was computed without one.
        if !aligned(self.offset) || !aligned(self.offset + view.byte_offset) {
            return Err(fault(format!(
                "offset {} in a bufferView at {} is not aligned to {} bytes",
                self.offset, view.byte_offset, self.component
            )));
        }
        Ok(())
    }
}

/// Accepts floats: positions, normals and tangents of core glTF.
pub fn float_only(component: Component, _normalized: bool) -> bool {
    component == Component::F32
}

/// Accepts floats and normalized unsigned integers: texture coordinates and colors.
pub fn float_or_unsigned(component: Component, normalized: bool) -> bool {
    component == Component::F32 || normalized && matches!(component, Component::U8 | Component::U16)
}

/// Accepts floats and normalized signed integers: directions of KHR_mesh_quantization, rotations of instancing.
pub fn float_or_signed(component: Component, normalized: bool) -> bool {
    component == Component::F32 || normalized && matches!(component, Component::I8 | Component::I16)
}

/// Accepts floats and normalized integers of 8 or 16 bits: rotations of animations (glTF 2.0 §3.11).
pub fn float_or_normalized(component: Component, normalized: bool) -> bool {
    component == Component::F32 || normalized && component != Component::U32
}

/// Accepts unsigned bytes: booleans of KHR_animation_pointer.
pub fn unsigned_byte(component: Component, normalized: bool) -> bool {
    component == Component::U8 && !normalized
}

/// Accepts all but 32-bit integers: positions and texture coordinates of KHR_mesh_quantization.
pub fn any_but_u32(component: Component, _normalized: bool) -> bool {
    component != Component::U32
}
