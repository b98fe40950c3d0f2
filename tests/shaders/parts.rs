//! Shaders contain neither code nor bindings for features that a scene does not use.

use std::collections::BTreeSet;

use reflet::{
    gpu::{ShaderLibrary, check_part, parse, reflect::capabilities},
    render::{passes, plan::Features},
};

use super::{OPTIONAL, variant};

/// Names of the functions and of the bindings of a shader in a frame with these features.
fn part(features: Features, name: &str) -> BTreeSet<String> {
    let variant = variant(features);
    let library = variant.library(&ShaderLibrary::embedded(), &passes::ALL);
    let source = or_panic!(library.and_then(|library| library.source(name)));
    let module = or_panic!(parse(&source));
    let constants: Vec<_> = variant.features.constants().collect();
    let info = or_panic!(check_part(
        &source,
        &module,
        capabilities(OPTIONAL),
        &constants
    ));
    let bindings = info.bindings.into_iter().map(|b| b.name);
    info.functions.into_iter().chain(bindings).collect()
}

#[test]
fn closed_forms_need_no_samples() {
    let light = |environment_rays, panorama| {
        let features = Features {
            environment_rays,
            panorama,
            ..Features::default()
        };
        part(features, "light")
    };
    let variants = [(false, false), (true, false), (true, true)];
    let [closed, sampled, panorama] = variants.map(|(s, p)| light(s, p));
    let has = |names: &BTreeSet<String>, wanted: [&str; 2]| wanted.map(|name| names.contains(name));
    let samples = ["sample_square", "sampling"];
    assert_eq!(has(&closed, samples), [false; 2]);
    assert_eq!(has(&sampled, samples), [true; 2]);
    let density = ["square_weights", "panorama_squares"];
    assert_eq!(has(&sampled, density), [false; 2]);
    assert_eq!(has(&panorama, density), [true; 2]);
    let details = |sheen: bool| {
        let features = Features {
            tints: true,
            hard_lights: true,
            sheen,
            ..Features::default()
        };
        part(features, "light")
    };
    let sheen = ["sheen_lambda", "sheen_table"];
    assert_eq!(has(&details(false), sheen), [false; 2]);
    assert_eq!(has(&details(true), sheen), [true; 2]);
}

#[test]
fn shaders_without_fog_have_nothing_of_it() {
    for fog in [false, true] {
        let features = Features {
            fog,
            hard_lights: true,
            reflections: true,
            transmission: true,
            indirect: true,
            ..Features::default()
        };
        for name in ["light", "paths", "compose"] {
            let names = part(features, name);
            let has = |wanted: &[&str]| wanted.iter().any(|name| names.contains(*name));
            let has_code = has(&["fog_length", "place_towards"]);
            let is_bound = has(&["fog", "fog_light"]);
            let blends = name == "compose";
            assert_eq!((has_code, is_bound), (fog && !blends, fog), "{name}");
        }
    }
}
