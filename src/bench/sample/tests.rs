//! Tests of the table of samples.

use super::*;

#[test]
fn samples_survive_the_table() {
    let sample = Sample {
        method: "rt".to_owned(),
        width: 1,
        height: 1,
        scale: 1.0,
        scene: "a, \"b\"".to_owned(),
        threshold_u: 0.025,
        value: Some(0.1 + 0.2),
        psnr_db: Some(f64::INFINITY),
        frame_ms: None,
        software: true,
        detail: (0..detail_columns().len())
            .map(|i| i as f64 / 3.0)
            .collect(),
        ..Sample::default()
    };
    let text = header() + sample.line().as_str();
    let (read, bytes) = read_samples(&text).expect("samples");
    assert_eq!(read, [sample]);
    assert_eq!(bytes, text.len());
    let passes = read[0].details("pass_", "_ms");
    assert_eq!(passes[0], ("shadow".to_owned(), 0.0));
    assert_eq!(passes.len(), passes::ALL.len());
}

#[test]
fn measurements_that_a_table_lacks_are_none() {
    let sample = Sample {
        method: "rt".to_owned(),
        width: 1,
        height: 1,
        scale: 1.0,
        flip: Some(0.5),
        detail: vec![0.0; detail_columns().len()],
        ..Sample::default()
    };
    let without = |name: &str| {
        let names = FIXED.iter().zip(sample.fixed_cells());
        let (names, cells): (Vec<&str>, Vec<String>) =
            names.filter(|(own, _)| **own != name).unzip();
        read_samples(&(csv::line(names) + csv::line(cells).as_str()))
    };
    let (read, _) = without("flip").expect("a table without scores");
    assert_eq!(read[0].flip, None);
    let (older, _) = without("accept").expect("an older table");
    assert!(older[0] == sample && older[0].flip.is_some());
    let error = without("steps").expect_err("settings are needed");
    assert_eq!(error.to_string(), "line 2: there is no column steps");
}

#[test]
fn faults_are_named_with_their_line() {
    let says = |text: &str| read_samples(text).expect_err("no samples").to_string();
    assert_eq!(says("a,b\n1,2\n"), "line 2: there is no column fingerprint");
    let sample = Sample {
        method: "rt".to_owned(),
        width: 7,
        height: 1,
        scale: 1.0,
        detail: vec![0.0; detail_columns().len()],
        ..Sample::default()
    };
    let text = header() + sample.line().replacen(",7,", ",wide,", 1).as_str();
    assert_eq!(says(&text), "line 2: column width cannot be \"wide\"");
}
