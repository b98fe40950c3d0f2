//! Buffer views decoded by the library, which is C++.

use super::{Decoding, Fault, Filter, Mode, fault};

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
