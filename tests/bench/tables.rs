//! Invalid tables of samples are refused with line and column.

use reflet::bench::sample::detail_columns;

use super::*;

/// Error of a table with a changed second row.
#[track_caller]
fn says(change: impl FnOnce(&mut Sample)) -> String {
    let mut rows = synthetic_samples();
    change(&mut rows[1]);
    let text: String = rows.iter().map(Sample::line).collect();
    read_samples(&(header() + text.as_str()))
        .expect_err("refused")
        .to_string()
}

#[test]
fn values_that_cannot_be_are_refused_with_line_and_column() {
    let pass = detail_columns()
        .iter()
        .position(|name| name.ends_with("_ms"));
    let pass = pass.expect("a pass");
    let cases: [(&str, String); 12] = [
        (
            "frame_ms cannot be \"-1\"",
            says(|s| s.frame_ms = Some(-1.0)),
        ),
        (
            "passes_ms cannot be \"inf\"",
            says(|s| s.passes_ms = Some(f64::INFINITY)),
        ),
        ("tree_ms cannot be \"NaN\"", says(|s| s.tree_ms = f64::NAN)),
        ("ssim cannot be \"7\"", says(|s| s.ssim = Some(7.0))),
        ("flip cannot be \"-1\"", says(|s| s.flip = Some(-1.0))),
        (
            "mask_flip cannot be \"1.5\"",
            says(|s| s.mask_flip = Some(1.5)),
        ),
        (
            "screen_percent cannot be \"101\"",
            says(|s| s.screen_percent = 101.0),
        ),
        (
            "method cannot be \"magic\"",
            says(|s| s.method = "magic".to_owned()),
        ),
        (
            "parameter cannot be \"speed\"",
            says(|s| s.parameter = Some("speed".to_owned())),
        ),
        ("width cannot be \"0\"", says(|s| s.width = 0)),
        ("_ms cannot be \"-3\"", says(|s| s.detail[pass] = -3.0)),
        ("column mask_px is 5", says(|s| s.mask_px = 5)),
    ];
    for (expected, said) in cases {
        assert!(
            said.starts_with("line 3: ") && said.contains(expected),
            "{expected}: {said}"
        );
    }
    let twice = says(|s| *s = sample("ssr", 16.0, 5.0, 0.4));
    assert!(twice.contains("the same frame as line 2"), "{twice}");
}
