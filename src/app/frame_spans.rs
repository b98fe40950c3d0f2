//! Frame numbers as text.

/// Ascending frame numbers in the syntax of `--frames`, such as `1,3,5-9`.
pub fn spans(frames: &[u32]) -> String {
    let follows = |a: &u32, b: &u32| a + 1 == *b;
    let part = |run: &[u32]| match run {
        [] => String::new(),
        [only] => only.to_string(),
        [first, .., last] => format!("{first}-{last}"),
    };
    let parts: Vec<_> = frames.chunk_by(follows).map(part).collect();
    parts.join(",")
}
