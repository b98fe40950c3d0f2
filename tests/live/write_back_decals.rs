//! Numbers and keys of decals, written into the scene text.

use reflet_preview::write_back::{KeyChange, KeyEdit, SceneItem};

use crate::{
    kit::*,
    write_back_values::{numbers, read},
};

/// A decal's place, size and opacity are shown during a drag and written into its table; what a track moves is not.
#[test]
fn numbers_of_decals_are_written_into_their_tables() {
    let (gpu, folder) = (or_skip!(gpu()), Folder::new());
    let text = format!(
        "{SCENE}[decal.sticker]\nmaterial = \"red\" # glossy\ntranslation = [0, 0.5, 0.5]\nopacity = 0.5\n\
         [decal.moved]\nmaterial = \"red\"\n[timeline]\nend = 3\n[motion.decal.moved]\n\
         translation = {{ keys = [{{ at_s = 0, value = [0, 0, 0] }}, {{ at_s = 1, value = [1, 0, 0] }}] }}\n"
    );
    let path = folder.write("scene.toml", &text);
    let mut live = open(&gpu, &path, None);
    let sticker = SceneItem::Decal(0);
    let keys = |live: &Live| {
        let found = live.inspect(sticker).expect("it is there");
        let keys = found.numbers.iter().map(|n| n.key);
        (found.label.clone(), keys.collect::<Vec<_>>())
    };
    let expected = ["translation", "rotation_deg", "scale", "size", "opacity"];
    assert_eq!(keys(&live), ("decal sticker".to_owned(), expected.to_vec()));
    let place = numbers("translation", &[0.25, 0.5, 0.5]);
    assert!(live.drag(sticker, &place).ok);
    let shown = &live.world().decals.list[0];
    assert_eq!(shown.world_from_decal.translation.x, 0.25);
    assert_eq!(read(&path), text, "a drag writes nothing");
    for number in [
        place,
        numbers("opacity", &[2.0]),
        numbers("size", &[1.0, 2.0, 0.5]),
    ] {
        or_panic!(live.write(sticker, &number));
        assert!(live.reload(&[Change::Scene].into()).ok);
    }
    let shown = &live.world().decals.list[0];
    assert_eq!((shown.opacity, shown.size), (1.0, Vec3::new(1.0, 2.0, 0.5)));
    let written = text.replacen(
        "[0, 0.5, 0.5]\nopacity = 0.5",
        "[0.25, 0.5, 0.5]\nsize = [1, 2, 0.5]\nopacity = 1",
        1,
    );
    assert_eq!(read(&path), written);
    let held = live.write(SceneItem::Decal(1), &numbers("translation", &[0.0; 3]));
    let held = held.expect_err("a track moves it");
    assert!(held.contains("[motion.decal.moved]"), "{held}");
    // Its keys are the keys below the timeline.
    let tracks = live.key_tracks();
    let [track] = tracks.as_slice() else {
        panic!("{tracks:?}")
    };
    assert_eq!(
        (track.track.kind, track.track.key),
        ("decal", "translation")
    );
    let edit = KeyEdit {
        track: track.track.clone(),
        change: KeyChange::Move(1, 2.0),
    };
    or_panic!(live.edit_key(&edit));
    assert_eq!(read(&path), written.replace("at_s = 1,", "at_s = 2,"));
}
