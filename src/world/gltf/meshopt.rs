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
/// A stream that is cut off or not of its mode. Other garbage may decode to any bytes; an element that no encoder writes
/// before a filter is zero, or no rotation.
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
    let filter = match decoding.filter {
        Filter::None => return Ok(bytes),
        Filter::Octahedral => codec::decode_filter_oct,
        Filter::Quaternion => codec::decode_filter_quat,
        Filter::Exponential => codec::decode_filter_exp,
        Filter::Color => codec::decode_filter_color,
    };
    let is_rotation = matches!(decoding.filter, Filter::Quaternion);
    for element in bytes.chunks_mut(stride) {
        if filter(element, 1, stride, workspace).is_err() {
            element.fill(0);
            if is_rotation {
                element[6..].copy_from_slice(&i16::MAX.to_le_bytes());
            }
        }
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use bytemuck::{Pod, pod_collect_to_vec};
    use meshopt::{
        FilterComponent, decode_filter_color, decode_filter_oct, decode_filter_quat,
        encode_filter_color, encode_filter_oct, encode_filter_quat, encode_vertex_buffer_level,
    };

    use super::*;

    /// Decodes filtered elements after both ways through a stream.
    fn decoded<T: Pod + Default>(filtered: &[[T; 4]], filter: Filter) -> Vec<u8> {
        let stream = encode_vertex_buffer_level(filtered, 2, Some(0)).expect("encoded");
        let (count, stride) = (filtered.len(), size_of::<[T; 4]>());
        let decoding = Decoding {
            mode: Mode::Attributes,
            filter,
            count,
            stride,
            bytes: (count * stride) as u64,
        };
        decode(&decoding, &stream).expect("decoded")
    }

    /// Vectors of length 1, and colors.
    fn vectors() -> Vec<[f32; 4]> {
        let vector = |i: u32| {
            let [a, b] = [0.1, 0.7].map(|step| i as f32 * step);
            [a.cos() * b.sin(), a.sin() * b.sin(), b.cos(), 0.0]
        };
        (0..600).map(vector).collect()
    }

    /// Whether numbers are equal but for rounding, which depends on the processor in the library of C++.
    fn is_near<T: Pod + Into<i32>>(found: &[u8], expected: &[[T; 4]]) -> bool {
        let found = pod_collect_to_vec::<u8, T>(found);
        let is_near = |(a, b): (&T, &T)| ((*a).into() - (*b).into()).abs() <= 1;
        found.iter().zip(expected.as_flattened()).all(is_near)
    }

    fn decodes_normals<C: FilterComponent + Pod + Into<i32>>(bits: i32) -> bool {
        let mut normals: Vec<[C; 4]> = encode_filter_oct(&vectors(), bits);
        let found = decoded(&normals, Filter::Octahedral);
        decode_filter_oct(&mut normals);
        is_near(&found, &normals)
    }

    fn decodes_colors<C: FilterComponent + Pod + Into<i32>>(bits: i32) -> bool {
        let colors: Vec<_> = vectors().iter().map(|v| v.map(|x| 0.5 + x / 2.0)).collect();
        let mut colors: Vec<[C; 4]> = encode_filter_color(&colors, bits);
        let found = decoded(&colors, Filter::Color);
        decode_filter_color(&mut colors);
        is_near(&found, &colors)
    }

    #[test]
    fn filters_decode_as_meshoptimizer_does() {
        assert!(decodes_normals::<i8>(8) && decodes_normals::<i16>(12));
        assert!(decodes_colors::<u8>(8) && decodes_colors::<u16>(12));
        let mut turns = encode_filter_quat(&vectors(), 16);
        let found = decoded(&turns, Filter::Quaternion);
        decode_filter_quat(&mut turns);
        assert!(is_near(&found, &turns));
    }

    #[test]
    fn a_refused_element_is_zero_and_takes_no_other() {
        let mut normals: Vec<[i8; 4]> = encode_filter_oct(&vectors(), 8);
        normals[300] = [0; 4];
        let found = decoded(&normals, Filter::Octahedral);
        normals.remove(300);
        decode_filter_oct(&mut normals);
        normals.insert(300, [0; 4]);
        assert!(is_near(&found, &normals));
    }
}
