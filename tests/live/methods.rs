//! Every method and setting of reflections in the preview: its picture equals `render`'s, also beside another one.

use reflet::scene::desc::Method;
use reflet_preview::{
    viewer::protocol::{Side, Visualization},
    write_back::presses::{FIRST_METHODS, rivals},
    write_back::view_channel::ViewChannel,
};

use crate::kit::*;

/// Maps of few pixels, and light by rays.
const MAPS: &str = "[probes]\nface_px = 8\nsamples = 1\n[near_far]\nface_px = 8\nhalf_size_m = 1\n\
                    [box_faces]\nface_px = 8\n";

/// Picture of a scene by `render` with these values.
fn rendered(folder: &Folder, set: &[&str]) -> Vec<u8> {
    let options = with_set(set);
    let session = Session::open(folder.path("scene.toml"), &options);
    or_panic!(session.and_then(|mut session| session.render(&[]))).display
}

/// Shows pairs of methods beside each other, and compares each side with `render`.
fn check_pairs(methods: &[Method]) {
    let (gpu, folder) = (or_skip!(gpu()), Folder::new());
    let path = folder.write("scene.toml", format!("{SCENE}{MAPS}"));
    let live = open(&gpu, &path, None);
    let wanted: Vec<_> = (methods.iter())
        .map(|method| {
            let method = format!("reflection.method=\"{}\"", method.name());
            rendered(&folder, &["image.size=[24, 16]", &method])
        })
        .collect();
    let mut preview = Watched::start(Arc::clone(&gpu), folder, live, false);
    for (pair, wanted) in methods.windows(2).zip(wanted.windows(2)) {
        let sides = [pair[0], pair[1]].map(|method| Side {
            method,
            channel: ViewChannel::Picture,
        });
        preview.show(|view| (view.a, view.b) = (sides[0], Some(sides[1])));
        let shown = preview.until("both sides", |report| match report {
            Report::Frame(shown) if shown.sides.len() == 2 => {
                let is_of =
                    |(side, method): (&Visualization, &Method)| side.stats.method == *method;
                let is_pair = shown.sides.iter().zip(pair).all(is_of);
                is_pair.then(|| shown.sides.clone())
            }
            _ => None,
        });
        for ((side, wanted), method) in shown.iter().zip(wanted).zip(pair) {
            let found = or_panic!(side.texture.read(&gpu));
            assert!(found == *wanted, "{} of {pair:?}", method.name());
        }
    }
}

#[test]
fn probes_are_shown_beside_another_method() {
    check_pairs(&[Method::Hybrid, Method::Probe]);
}

#[test]
#[ignore = "long: builds the passes of all methods"]
fn all_methods_are_shown_beside_each_other() {
    let all: Vec<_> = FIRST_METHODS.into_iter().chain(rivals()).collect();
    check_pairs(&all);
}

/// Settings of systems that are no methods of their own, saved one after another.
#[test]
#[ignore = "long: builds the passes of many settings"]
fn settings_of_reflections_are_shown_after_a_save() {
    let (gpu, folder) = (or_skip!(gpu()), Folder::new());
    let text = format!("{SCENE}{MAPS}");
    let path = folder.write("scene.toml", &text);
    let mut live = open(&gpu, &path, None);
    for settings in [
        "method = \"hybrid\"\nlayers = 2",
        "method = \"near-far\"\nlayers = 2",
        "method = \"rt\"\nrate = 2",
        "method = \"hybrid\"\nrate = 4",
        "method = \"rt\"\nskip_px = 1",
        "method = \"rt\"\ntrace = \"auto\"",
        "method = \"probe\"",
    ] {
        folder.write("scene.toml", format!("{text}[reflection]\n{settings}\n"));
        let reload = live.reload(&[Change::Scene].into());
        assert!(reload.ok, "{settings}: {:?}", live.problems);
        assert!(
            picture(&gpu, &mut live) == rendered(&folder, &[]),
            "{settings}"
        );
    }
}
