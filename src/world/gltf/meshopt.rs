//! EXT_meshopt_compression and KHR_meshopt_compression: buffer views decoded by meshoptimizer.

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
enum Mode {
    Attributes,
    Triangles,
    Indices,
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
    let mode = match stream.mode.as_str() {
        "ATTRIBUTES" => Mode::Attributes,
        "TRIANGLES" => Mode::Triangles,
        "INDICES" => Mode::Indices,
        other => return Err(fault(format!("mode \"{}\" is unknown", shorten(other)))),
    };
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

/// Decodes a stream to the bytes of its buffer view.
///
/// # Errors
/// A stream that is cut off or not of its mode. Garbage may decode to any bytes.
pub fn decode(decoding: &Decoding, encoded: &[u8]) -> Result<Vec<u8>, Fault> {
    let count = decoding.count;
    let bytes = match (decoding.mode, decoding.stride) {
        (Mode::Attributes, stride) => attributes(encoded, count, stride / 4),
        (Mode::Triangles, 2) => meshopt::decode_index_buffer::<u16>(encoded, count).map(to_bytes),
        (Mode::Triangles, _) => meshopt::decode_index_buffer::<u32>(encoded, count).map(to_bytes),
        (Mode::Indices, 2) => meshopt::decode_index_sequence::<u16>(encoded, count).map(to_bytes),
        (Mode::Indices, _) => meshopt::decode_index_sequence::<u32>(encoded, count).map(to_bytes),
    };
    let mode = decoding.mode;
    let broken = |_| fault(format!("its {mode:?} stream is cut off or broken"));
    Ok(filtered(decoding, bytes.map_err(broken)?))
}

fn to_bytes<T: bytemuck::NoUninit>(values: Vec<T>) -> Vec<u8> {
    bytemuck::cast_slice(&values).to_vec()
}

/// A vertex of `N` words; the wrapper is needed as arrays implement `Default` only up to length 32.
#[derive(Clone, Copy)]
struct Vertex<const N: usize>([u32; N]);

impl<const N: usize> Default for Vertex<N> {
    fn default() -> Self {
        Self([0; N])
    }
}

/// Decodes vertices of 1 to 64 words of 32 bits.
fn attributes(encoded: &[u8], count: usize, words: usize) -> meshopt::Result<Vec<u8>> {
    fn decode<const N: usize>(encoded: &[u8], count: usize) -> meshopt::Result<Vec<u8>> {
        let vertices: Vec<Vertex<N>> = meshopt::decode_vertex_buffer(encoded, count)?;
        let words = vertices.iter().flat_map(|vertex| vertex.0);
        Ok(words.flat_map(u32::to_ne_bytes).collect())
    }
    macro_rules! by_size {
        ($($n:literal)*) => {
            match words {
                $($n => decode::<$n>(encoded, count),)*
                _ => Err(meshopt::Error::Native(-1)),
            }
        };
    }
    by_size!(
        1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31 32
        33 34 35 36 37 38 39 40 41 42 43 44 45 46 47 48 49 50 51 52 53 54 55 56 57 58 59 60 61 62
        63 64
    )
}

/// Undoes the filter that was applied before the compression.
fn filtered(decoding: &Decoding, bytes: Vec<u8>) -> Vec<u8> {
    fn run<T: bytemuck::Pod>(bytes: &[u8], filter: impl FnOnce(&mut [T])) -> Vec<u8> {
        let mut values: Vec<T> = bytemuck::pod_collect_to_vec(bytes);
        filter(&mut values);
        to_bytes(values)
    }
    match (decoding.filter, decoding.stride) {
        (Filter::None, _) => bytes,
        (Filter::Octahedral, 4) => run(&bytes, meshopt::decode_filter_oct::<i8>),
        (Filter::Octahedral, _) => run(&bytes, meshopt::decode_filter_oct::<i16>),
        (Filter::Quaternion, _) => run(&bytes, meshopt::decode_filter_quat),
        (Filter::Exponential, _) => run(&bytes, meshopt::decode_filter_exp::<1>),
        (Filter::Color, 4) => run(&bytes, meshopt::decode_filter_color::<u8>),
        (Filter::Color, _) => run(&bytes, meshopt::decode_filter_color::<u16>),
    }
}
