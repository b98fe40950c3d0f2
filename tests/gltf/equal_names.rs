//! Files in which many things have one name.

use crate::{kit::*, work::counted};

/// A triangle with cameras and animations that all have one name.
fn same_names(count: usize) -> Doc {
    let mut doc = Doc::triangle();
    let cameras = (0..count).map(|_| json!({"camera": 0, "name": "eye"}));
    let nodes = doc.json["nodes"].as_array_mut().expect("a list");
    let first = nodes.len();
    nodes.extend(cameras);
    let roots = doc.json["scenes"][0]["nodes"].as_array_mut();
    roots
        .expect("a list")
        .extend((first..first + count).map(|i| json!(i)));
    doc.json["cameras"] =
        json!([{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}]);
    let (times, moves) = (
        doc.floats("SCALAR", &[0.0, 1.0]),
        doc.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0]),
    );
    let animation = json!({
        "name": "turn",
        "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
        "samplers": [{"input": times, "output": moves}]
    });
    doc.json["animations"] = vec![animation; count].into();
    doc
}

#[test]
fn twice_as_many_equal_names_take_twice_the_work() {
    let [few, many] = [1_000, 2_000].map(|count| {
        let doc = same_names(count);
        let (world, work) = counted(|| doc.world());
        let last = &world.cameras[count - 1].name;
        assert!(last.ends_with(&format!("#{count}")), "{last}");
        work
    });
    assert!(
        many.count_total < few.count_total * 9 / 4,
        "{few:?}, {many:?}"
    );
}
