//! Parses the container of a `.gltf` or `.glb` file into JSON and binary chunk; all lengths are
//! validated.

use std::{ops::Range, sync::Arc};

use serde_json::Value;

use super::{
    Fault, Notes, ReadOptions, extension,
    json_memory::{Head, value_bytes},
    schema::Root,
    uri::shorten,
    wrong_types,
};
use reflet_base::memory::Reservation;

/// Part of a shared block of bytes; keeps the block alive.
#[derive(Clone, Debug)]
pub struct Bytes {
    owner: Arc<Vec<u8>>,
    range: Range<usize>,
}

impl Bytes {
    /// A block of all `bytes`.
    pub fn new(bytes: Vec<u8>) -> Self {
        Self::shared(Arc::new(bytes))
    }

    fn shared(owner: Arc<Vec<u8>>) -> Self {
        let range = 0..owner.len();
        Self { owner, range }
    }

    /// A part, if `range` lies inside.
    pub fn slice(&self, range: Range<usize>) -> Option<Self> {
        let start = self.range.start.checked_add(range.start)?;
        let end = self.range.start.checked_add(range.end)?;
        (start <= end && end <= self.range.end).then(|| Self {
            owner: self.owner.clone(),
            range: start..end,
        })
    }
}

impl std::ops::Deref for Bytes {
    type Target = [u8];
    fn deref(&self) -> &[u8] {
        // The range was checked when the value was made.
        &self.owner[self.range.clone()]
    }
}

const GLB_HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;
const CHUNK_JSON: u32 = 0x4E4F_534A;
const CHUNK_BIN: u32 = 0x004E_4942;

/// A parsed file.
pub struct Container {
    pub root: Root,
    /// GLB's binary chunk.
    pub binary: Option<Bytes>,
    /// Memory of the parsed JSON.
    pub held: Reservation,
}

/// Parses a file's bytes. But with `strict`, what is wrong or not supported and only changes the look is left out.
pub fn open(bytes: Vec<u8>, options: &ReadOptions, notes: &mut Notes) -> Result<Container, Fault> {
    let bytes = Bytes::new(bytes);
    let (json, binary) = if bytes.starts_with(b"glTF") {
        split_glb(&bytes)?
    } else {
        (bytes.clone(), None)
    };
    let (root, held) = parse(&json, options, notes)?;
    Ok(Container { root, binary, held })
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let word = bytes.get(at..at.checked_add(4)?)?;
    word.try_into().ok().map(u32::from_le_bytes)
}

fn split_glb(bytes: &Bytes) -> Result<(Bytes, Option<Bytes>), Fault> {
    let broken = |text: String| Fault::new("glb-broken", text);
    let (Some(version), Some(length)) = (word(bytes, 4), word(bytes, 8)) else {
        return Err(broken(format!(
            "the GLB header needs {GLB_HEADER} bytes, the file has {}",
            bytes.len()
        )));
    };
    if version != 2 {
        return Err(Fault::new(
            "gltf-version",
            format!("GLB version {version}, only version 2 is supported"),
        ));
    }
    // Bytes past the stated length are not part of the asset.
    let bytes = &bytes.slice(0..length as usize).ok_or_else(|| {
        broken(format!(
            "the GLB header declares {length} bytes, the file has {}; was it cut off?",
            bytes.len()
        ))
    })?;
    let (mut json, mut binary) = (None, None);
    let (mut at, mut number) = (GLB_HEADER, 0);
    while at < bytes.len() {
        let (Some(size), Some(kind)) = (word(bytes, at), word(bytes, at + 4)) else {
            return Err(broken(format!(
                "the header of GLB chunk {number} is cut off"
            )));
        };
        let start = at + CHUNK_HEADER;
        let chunk = (start.checked_add(size as usize))
            .and_then(|end| bytes.slice(start..end))
            .ok_or_else(|| {
                broken(format!(
                    "GLB chunk {number} says {size} bytes, {} are left",
                    bytes.len() - start
                ))
            })?;
        match (kind, number) {
            (CHUNK_JSON, 0) => json = Some(chunk),
            (_, 0) => return Err(broken("the first GLB chunk must be JSON".into())),
            (CHUNK_BIN, 1) => binary = Some(chunk),
            _ => {} // later and unknown chunks are skipped, as the specification says
        }
        at = start + size as usize;
        number += 1;
    }
    let json = json.ok_or_else(|| broken("the GLB file has no JSON chunk".into()))?;
    Ok((json, binary))
}

fn parse(
    json: &[u8],
    options: &ReadOptions,
    notes: &mut Notes,
) -> Result<(Root, Reservation), Fault> {
    let memory = &options.memory;
    let unreadable = |e: serde_json::Error| Fault::new("gltf-json", format!("not glTF JSON: {e}"));
    let hold = |bytes: u64| {
        memory.hold(bytes).ok_or_else(|| {
            let text = format!(
                "its JSON takes up to {bytes} bytes of memory, {} are left",
                memory.left()
            );
            Fault::new("geometry-too-large", text).help("simplify the file, or leave out models")
        })
    };
    // A byte-order mark is against the specification, but harmless.
    let mut json = json.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(json);
    let (mended, _mended_held);
    // The version is checked first, so that glTF 1.0 gets its own error message.
    let mut head = serde_json::from_slice(json);
    if head.is_err() && !options.strict {
        _mended_held = hold(4 * json.len() as u64)?;
        mended = without_other_numbers(json);
        json = &mended;
        head = serde_json::from_slice(json);
    }
    let head = head.or_else(|first: serde_json::Error| match options.strict {
        true => Err(first),
        false => Head::without_lists(json).map_err(|_| first),
    });
    let head: Head = head.map_err(unreadable)?;
    check_version(&head.asset, options.strict)?;
    extension::check_required(&head.extensions_required, options.strict)?;
    let held = hold(head.bytes(json))?;
    let root = serde_json::from_slice(json).or_else(|first| {
        // The specification allows integers written as 1.0; rare, so a second try.
        let _held = hold(value_bytes(json) + 4 * json.len() as u64)?;
        let mended = match options.strict {
            true => json.into(),
            false => without_other_numbers(json),
        };
        let mut value = serde_json::from_slice(&mended).map_err(unreadable)?;
        integers_from_floats(&mut value);
        if !options.strict {
            wrong_types::leave_out(&mut value, notes)?;
        }
        serde_json::from_value(value).map_err(|_| unreadable(first))
    });
    Ok((root?, held))
}

/// The text with numbers that JSON lacks (NaN, infinities, 1e999) as strings, which are of a wrong type wherever they
/// stand.
fn without_other_numbers(json: &[u8]) -> Vec<u8> {
    let is_end = |byte: &u8| b"\"{}[]:, \t\r\n".contains(byte);
    let is_other = |word: &[u8]| {
        let number = str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        number.is_some_and(|number: f64| !number.is_finite())
    };
    let (mut text, mut is_string) = (Vec::with_capacity(json.len()), false);
    for part in json.split_inclusive(|byte| *byte == b'"') {
        if is_string {
            text.extend(part);
            // A quote behind an odd number of backslashes is part of the string.
            let slashes = part.iter().rev().skip(1).take_while(|byte| **byte == b'\\');
            is_string = slashes.count() % 2 == 1;
            continue;
        }
        for word in part.split_inclusive(is_end) {
            let end = word.len() - usize::from(word.last().is_some_and(is_end));
            let (number, end) = word.split_at(end);
            let quote: &[u8] = if is_other(number) { b"\"" } else { b"" };
            text.extend([quote, number, quote, end].concat());
        }
        is_string = part.ends_with(b"\"");
    }
    text
}

/// Rewrites every number without a fraction as an integer. Recursion is bounded by the JSON
/// reader's own limit on depth.
pub(super) fn integers_from_floats(value: &mut Value) {
    match value {
        Value::Array(values) => values.iter_mut().for_each(integers_from_floats),
        Value::Object(map) => map.values_mut().for_each(integers_from_floats),
        Value::Number(number) => {
            let exact = number
                .as_f64()
                .filter(|f| f.fract() == 0.0 && f.abs() < 9e15);
            if let (false, Some(float)) = (number.is_i64() || number.is_u64(), exact) {
                *number = (float as i64).into();
            }
        }
        _ => {}
    }
}

fn check_version(asset: &super::schema::Asset, is_strict: bool) -> Result<(), Fault> {
    let fault = |text: String| {
        Fault::new("gltf-version", text)
            .help("convert the file to glTF 2.0 with its authoring tool")
    };
    let parse = |version: &Value| -> Option<(u32, u32)> {
        let number = version.as_f64().filter(|_| !is_strict);
        let text = version.as_str().map(str::to_owned);
        // A file that says 2.0 without quotes means the same.
        let text = text.or_else(|| number.map(|number| format!("{number:?}")))?;
        let (major, minor) = text.split_once('.')?;
        Some((major.parse().ok()?, minor.parse().ok()?))
    };
    let shown = |version: &Value| shorten(&version.to_string());
    let Some(version) = &asset.version else {
        return Err(fault("asset.version is missing, expected \"2.0\"".into()));
    };
    if !matches!(parse(version), Some((2, _))) {
        let text = format!("asset.version is {}, expected \"2.0\"", shown(version));
        return Err(fault(text));
    }
    match asset
        .min_version
        .as_ref()
        .map(|version| (version, parse(version)))
    {
        None | Some((_, Some((0..=1, _) | (2, 0)))) => Ok(()),
        Some((version, _)) => Err(fault(format!(
            "asset.minVersion is {}, this reader supports 2.0",
            shown(version)
        ))),
    }
}
