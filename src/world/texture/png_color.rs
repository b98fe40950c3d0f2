//! Color spaces that PNG files say they have, where it is another one than sRGB.

/// BT.709 chromaticities of white, red, green and blue, x and y each, as `cHRM` counts them: in 1/100,000.
const BT709: [u32; 8] = [31270, 32900, 64000, 33000, 30000, 60000, 15000, 6000];
/// Gamma of `gAMA` that stands for sRGB, in 1/100,000.
const GAMMA: u32 = 45455;

/// Color space that the chunks before the pixels of a PNG say, in words; `None` for sRGB and for files that say
/// nothing. Of several chunks the first of this list counts: `cICP`, `iCCP`, `sRGB`,
/// then `gAMA` and `cHRM` (PNG 3, §4.3). Color profiles are taken as sRGB.
pub fn other_than_srgb(start: &[u8]) -> Option<String> {
    let mut chunks = chunks(start);
    if let Some((_, data)) = chunks.clone().find(|(name, _)| *name == b"cICP") {
        let [primaries, transfer, ..] = data else {
            return None;
        };
        // ITU-T H.273, tables 2 and 3: BT.709 with the transfer of sRGB.
        return ((*primaries, *transfer) != (1, 13))
            .then(|| format!("of primaries {primaries} and transfer {transfer} by its `cICP`"));
    }
    if chunks
        .clone()
        .any(|(name, _)| matches!(name, b"iCCP" | b"sRGB"))
    {
        return None;
    }
    chunks.find_map(|(name, data)| {
        let numbers = data
            .chunks_exact(4)
            .map(|n| u32::from_be_bytes([n[0], n[1], n[2], n[3]]));
        match name {
            b"gAMA" => {
                let gamma = numbers
                    .into_iter()
                    .next()
                    .filter(|g| g.abs_diff(GAMMA) > 1000)?;
                let exponent = (1e7 / f64::from(gamma.max(1))).round() / 100.0;
                Some(format!("of gamma {exponent} by its `gAMA`"))
            }
            b"cHRM" => {
                let is_other = numbers
                    .zip(BT709)
                    .any(|(own, usual)| own.abs_diff(usual) > 100);
                is_other.then(|| "of other primaries by its `cHRM`".to_owned())
            }
            _ => None,
        }
    })
}

/// Names and data of the chunks before the pixels.
fn chunks(png: &[u8]) -> impl Iterator<Item = (&[u8; 4], &[u8])> + Clone {
    let mut rest = png.strip_prefix(b"\x89PNG\r\n\x1a\n").unwrap_or_default();
    std::iter::from_fn(move || {
        let (length, after) = rest.split_first_chunk()?;
        let (name, after) = after.split_first_chunk()?;
        let (data, after) = after.split_at_checked(u32::from_be_bytes(*length) as usize)?;
        rest = after.get(4..).unwrap_or_default(); // past the checksum
        (name != b"IDAT").then_some((name, data))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn color_spaces_that_are_not_srgb_are_told() {
        let chunk = |name: &[u8; 4], data: &[u8]| {
            [&(data.len() as u32).to_be_bytes(), &name[..], data, &[0; 4]].concat()
        };
        let numbers = |all: &[u32]| all.iter().flat_map(|n| n.to_be_bytes()).collect::<Vec<_>>();
        let linear = chunk(b"gAMA", &numbers(&[100_000]));
        let usual = [
            chunk(b"gAMA", &numbers(&[GAMMA])),
            chunk(b"cHRM", &numbers(&BT709)),
        ]
        .concat();
        let wide = chunk(
            b"cHRM",
            &numbers(&[31270, 32900, 68000, 32000, 26500, 69000, 15000, 6000]),
        );
        let end = chunk(b"IDAT", &[]);
        for (chunks, said) in [
            (&[][..], None),
            (&[&usual], None),
            (&[&linear], Some("gamma 1 ")),
            (&[&usual, &wide], Some("`cHRM`")),
            (&[&linear, &chunk(b"sRGB", &[0])], None),
            (
                &[&chunk(b"sRGB", &[0]), &chunk(b"cICP", &[9, 16, 0, 1])],
                Some("transfer 16"),
            ),
            (&[&chunk(b"cICP", &[1, 13, 0, 1]), &linear], None),
            (&[&end, &linear], None),
            (&[&vec![0xFF; 9]], None),
        ] {
            let chunks: Vec<u8> = chunks.iter().flat_map(|c| c.iter().copied()).collect();
            let png = [b"\x89PNG\r\n\x1a\n", chunks.as_slice()].concat();
            let found = other_than_srgb(&png);
            let is_said = |found: &String| said.is_some_and(|said| found.contains(said));
            assert_eq!(found.is_some(), said.is_some(), "{found:?}");
            assert!(found.as_ref().is_none_or(is_said), "{found:?}");
        }
        assert_eq!(other_than_srgb(b"\xFF\xD8\xFF"), None);
    }
}
