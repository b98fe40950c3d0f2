//! Buffer views and accessors: every count, range and stride is validated before bytes are read (by `gather`).

use std::sync::OnceLock;

use super::{
    Fault, Notes,
    budget::GeometryBudget,
    buffer::Buffer,
    container::Bytes,
    lenient::{LeftOut, forgiven},
    meshopt,
    run::Run,
    schema::{Accessor, BufferView, Root},
};

/// Maximum number of elements of an accessor without data, which nothing else bounds.
const MAX_VIRTUAL_ELEMENTS: u64 = 1 << 22;

/// The document's buffers, with a decode budget.
pub struct Data<'a> {
    root: &'a Root,
    buffers: Vec<Buffer>,
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
    /// Bytes from the view's start to the end of the last element; 0 without a view.
    pub end: u64,
    /// Whether all components, sparse ones too, start at multiples of their size.
    pub is_aligned: bool,
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

/// Refuses an accessor, view or buffer that stands for one with a value of another JSON type.
///
/// # Errors
/// The value, with its place.
pub(super) fn is_well_typed(wrong: &Option<Box<str>>) -> Result<(), Fault> {
    wrong
        .as_ref()
        .map_or(Ok(()), |text| Err(fault(text.to_string())))
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
    /// Checks all buffer views and accessors against the stated lengths of the buffers; buffers that are shorter are
    /// errors where they are read. Bytes that the result decodes are taken from `budget`.
    ///
    /// # Errors
    /// The first accessor or view that is out of range or of unknown type, where the load forgives nothing: else wrong
    /// ones are warned about here, and errors where they are read.
    pub fn new(
        root: &'a Root,
        buffers: Vec<Buffer>,
        budget: GeometryBudget,
        notes: &mut Notes,
    ) -> Result<Self, Fault> {
        let data = Self {
            root,
            buffers,
            decompressed: root.buffer_views.iter().map(|_| OnceLock::new()).collect(),
            budget,
        };
        let left_out = |place| LeftOut {
            name: "accessor-left-out",
            what: "accessors and bufferViews are wrong, and left out with what they hold",
            place,
        };
        for i in 0..root.buffer_views.len() {
            forgiven(
                root,
                data.view(i).map(|_| ()),
                (),
                &left_out("the file"),
                notes,
            )?;
        }
        for (i, accessor) in root.accessors.iter().enumerate() {
            // Unknown types are an error only where they are used.
            if shape(&accessor.kind, 1).is_none() && accessor.wrong.is_none() {
                continue;
            }
            let is_aligned = data.layout(i).map(|layout| layout.is_aligned);
            if !forgiven(root, is_aligned, true, &left_out("the file"), notes)? {
                let what =
                    "accessors have components that do not start at a multiple of their size";
                notes.add("accessor-unaligned", 1, what, &format!("accessor {i}"));
            }
        }
        Ok(data)
    }

    fn check_view(&self, view: &BufferView) -> Result<(), Fault> {
        is_well_typed(&view.wrong)?;
        self.check_range(view.buffer, view.byte_offset, view.byte_length)?;
        if let Some(stream) = view.extensions.meshopt() {
            self.check_range(stream.buffer, stream.byte_offset, stream.byte_length)
                .and_then(|()| meshopt::check(view, stream).map(|_| ()))
                .map_err(|f| f.placed("meshopt compression"))?;
        }
        Ok(())
    }

    /// Checks bytes of a buffer against its stated length.
    fn check_range(&self, buffer: usize, offset: u64, length: u64) -> Result<(), Fault> {
        let fault = |text: String| Err(Fault::new("gltf-buffer-view", text));
        let Some(found) = self.root.buffers.get(buffer) else {
            return fault(format!("buffer {buffer} does not exist"));
        };
        is_well_typed(&found.wrong).map_err(|f| f.placed(&format!("buffer {buffer}")))?;
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
        let found = self.root.accessors.get(index);
        found.ok_or_else(|| Fault::missing("accessor", index))
    }

    fn view(&self, index: usize) -> Result<&'a BufferView, Fault> {
        let view = self.root.buffer_views.get(index);
        let view = view.ok_or_else(|| fault(format!("bufferView {index} does not exist")))?;
        let checked = self.check_view(view);
        checked.map_err(|f| f.placed(&format!("bufferView {index}")))?;
        Ok(view)
    }

    /// The bytes of a buffer view, decompressed.
    pub fn view_bytes(&self, index: usize) -> Result<Bytes, Fault> {
        let view = self.view(index)?;
        let place = || format!("bufferView {index}");
        let Some(stream) = view.extensions.meshopt() else {
            let bytes = self.buffer_bytes(view.buffer, view.byte_offset, view.byte_length);
            return bytes.map_err(|f| f.placed(&place()));
        };
        let decompress = || {
            let decoding = meshopt::check(view, stream)?;
            let encoded =
                self.buffer_bytes(stream.buffer, stream.byte_offset, stream.byte_length)?;
            self.spend(decoding.bytes)?;
            meshopt::decode(&decoding, &encoded).map(Bytes::new)
        };
        self.decompressed[index]
            .get_or_init(|| decompress().map_err(|f| f.placed(&place())))
            .clone()
    }

    /// The bytes of a buffer view up to `end`, which lies in the view; the buffer may end there.
    pub fn view_start(&self, index: usize, end: u64) -> Result<Bytes, Fault> {
        let view = self.view(index)?;
        if view.extensions.meshopt().is_some() {
            return self.view_bytes(index);
        }
        let bytes = self.buffer_bytes(view.buffer, view.byte_offset, end);
        bytes.map_err(|f| f.placed(&format!("bufferView {index}")))
    }

    fn buffer_bytes(&self, buffer: usize, offset: u64, length: u64) -> Result<Bytes, Fault> {
        let missing = || {
            let text = format!("buffer {buffer} has no uri and no GLB chunk");
            Err(Fault::new("buffer-missing", text))
        };
        let found = self.buffers.get(buffer).and_then(Option::as_ref);
        let bytes = found.cloned().unwrap_or_else(missing)?;
        let start = usize::try_from(offset).ok();
        let end = (offset.checked_add(length)).and_then(|end| usize::try_from(end).ok());
        let range = start.and_then(|start| Some(start..end?));
        (range.and_then(|range| bytes.slice(range))).ok_or_else(|| {
            let text = format!(
                "buffer {buffer} has {} bytes, {length} from {offset} are read; is it cut off?",
                bytes.len()
            );
            Fault::new("buffer-short", text).help("copy or export the file again")
        })
    }

    pub(super) fn layout(&self, index: usize) -> Result<Layout, Fault> {
        let accessor = self.accessor(index)?;
        self.check_accessor(accessor)
            .map_err(|f| f.placed(&format!("accessor {index}")))
    }

    fn check_accessor(&self, accessor: &Accessor) -> Result<Layout, Fault> {
        is_well_typed(&accessor.wrong)?;
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
        let (mut stride, mut end, mut is_aligned) = (shape.pitch, 0, true);
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
            (end, is_aligned) = (run.end_in(view)?, run.is_aligned(view));
        } else if accessor.count > MAX_VIRTUAL_ELEMENTS {
            let text = format!(
                "{} elements without a bufferView, at most {MAX_VIRTUAL_ELEMENTS}",
                accessor.count
            );
            return Err(Fault::new("geometry-too-large", text));
        }
        is_aligned &= self.check_sparse(accessor, shape, size)?;
        let out_of_memory = |_| fault("does not fit this machine's memory".into());
        Ok(Layout {
            component,
            lanes: shape.lanes,
            count: usize::try_from(accessor.count).map_err(out_of_memory)?,
            offset: usize::try_from(accessor.byte_offset).map_err(out_of_memory)?,
            stride,
            end,
            is_aligned,
        })
    }

    /// Whether sparse elements are aligned.
    fn check_sparse(&self, accessor: &Accessor, shape: Shape, size: usize) -> Result<bool, Fault> {
        let Some(sparse) = &accessor.sparse else {
            return Ok(true);
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
        let is_aligned = |run: Run, view: usize| {
            let view = self.view(view)?;
            run.end_in(view)?;
            Ok::<_, Fault>(run.is_aligned(view))
        };
        let indices = is_aligned(indices, sparse.indices.buffer_view);
        let values = is_aligned(values, sparse.values.buffer_view);
        Ok(indices.map_err(|f| f.placed("sparse.indices"))?
            & values.map_err(|f| f.placed("sparse.values"))?)
    }

    /// Number of elements of an accessor.
    pub fn count(&self, index: usize) -> Result<usize, Fault> {
        self.layout(index).map(|l| l.count)
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
