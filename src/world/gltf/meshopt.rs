//! EXT_meshopt_compression and KHR_meshopt_compression: buffer views that meshoptimizer encoded.

use meshoptimizer_rs::{
    Limits, Workspace,
    codec::{self, Mode},
};

use super::{
    Fault,
    schema::{BufferView, MeshoptCompression},
    uri::shorten,
};

/// Largest ratio of decoded to encoded bytes, in all modes: in vertex streams one byte of control bits may stand
/// for four channels of 256 vertices.
const MOST_EXPANSION: u64 = 1024;

fn fault(text: impl Into<String>) -> Fault {
    Fault::new("gltf-meshopt", text)
}

/// Decoding parameters of a stream, checked against its buffer view.
#[derive(Clone, Copy, Debug)]
pub struct Decoding {
    mode: Mode,
    filter: Filter,
    count: usize,
    stride: usize,
    /// Size of the decoded stream, bytes.
    pub bytes: u64,
}

#[derive(Clone, Copy, Debug)]
enum Filter {
    None,
    Octahedral,
    Quaternion,
    Exponential,
    Color,
}

/// Checks the parameters of a stream.
///
/// # Errors
/// Unknown modes and filters, strides that they do not allow, sizes that do not fit each other.
pub fn check(view: &BufferView, stream: &MeshoptCompression) -> Result<Decoding, Fault> {
    let unknown = |_| fault(format!("mode \"{}\" is unknown", shorten(&stream.mode)));
    let mode = Mode::parse(&stream.mode).map_err(unknown)?;
    let filter = match stream.filter.as_deref() {
        None | Some("NONE") => Filter::None,
        Some("OCTAHEDRAL") => Filter::Octahedral,
        Some("QUATERNION") => Filter::Quaternion,
        Some("EXPONENTIAL") => Filter::Exponential,
        Some("COLOR") => Filter::Color,
        Some(other) => return Err(fault(format!("filter \"{}\" is unknown", shorten(other)))),
    };
    let stride = stream.byte_stride;
    let fits = match (mode, filter) {
        (Mode::Attributes, Filter::None | Filter::Exponential) => {
            (4..=256).contains(&stride) && stride.is_multiple_of(4)
        }
        (Mode::Attributes, Filter::Octahedral | Filter::Color) => stride == 4 || stride == 8,
        (Mode::Attributes, Filter::Quaternion) => stride == 8,
        (_, Filter::None) => stride == 2 || stride == 4,
        _ => return Err(fault("filters are for mode ATTRIBUTES only")),
    };
    if !fits {
        let text = format!("byteStride {stride} does not fit {mode:?} with filter {filter:?}");
        return Err(fault(text));
    }
    if matches!(mode, Mode::Triangles) && !stream.count.is_multiple_of(3) {
        let text = format!("{} indices are no whole number of triangles", stream.count);
        return Err(fault(text));
    }
    let bytes = stream.count.checked_mul(stride);
    let Some(bytes) = bytes.filter(|bytes| *bytes == view.byte_length) else {
        return Err(fault(format!(
            "{} elements of {stride} bytes are not the {} bytes of the bufferView",
            stream.count, view.byte_length
        )));
    };
    if bytes / MOST_EXPANSION > stream.byte_length {
        return Err(fault(format!(
            "{} bytes cannot hold {} elements of {stride} bytes",
            stream.byte_length, stream.count
        )));
    }
    let size = |value: u64| usize::try_from(value).map_err(|_| fault("it is too large"));
    Ok(Decoding {
        mode,
        filter,
        count: size(stream.count)?,
        stride: size(stride)?,
        bytes,
    })
}

/// Decodes a stream to the bytes of its buffer view, which are all that it allocates.
///
/// # Errors
/// A stream that is cut off or not of its mode, and values that no encoder writes before a filter. Other garbage
/// may decode to any bytes.
pub fn decode(decoding: &Decoding, encoded: &[u8]) -> Result<Vec<u8>, Fault> {
    let &Decoding {
        mode,
        count,
        stride,
        ..
    } = decoding;
    let broken = || fault(format!("its {mode:?} stream is cut off or broken"));
    let decode = match mode {
        Mode::Attributes => codec::decode_vertex_buffer,
        Mode::Triangles => codec::decode_index_buffer,
        Mode::Indices => codec::decode_index_sequence,
    };
    // The budget of the world has taken these bytes; the decoder's own default is a limit of 1 GiB.
    let workspace = &mut Workspace::new(Limits {
        max_bytes: usize::MAX,
        max_work: u64::MAX,
    });
    let mut bytes = decode(count, stride, encoded, workspace).map_err(|_| broken())?;
    let data = &mut bytes;
    let filtered = match decoding.filter {
        Filter::None => Ok(()),
        Filter::Octahedral => codec::decode_filter_oct(data, count, stride, workspace),
        Filter::Quaternion => codec::decode_filter_quat(data, count, stride, workspace),
        Filter::Exponential => codec::decode_filter_exp(data, count, stride, workspace),
        Filter::Color => codec::decode_filter_color(data, count, stride, workspace),
    };
    let unfiltered = || {
        fault(format!(
            "its {:?} filter meets a value that no encoder writes",
            decoding.filter
        ))
    };
    filtered.map_err(|_| unfiltered())?;
    Ok(bytes)
}
