//! Scenes without fog have no code and no binding of it in any shader.

use reflet::render::plan::Features;

use super::part;

#[test]
fn shaders_without_fog_have_nothing_of_it() {
    for fog in [false, true] {
        let features = Features {
            fog,
            reflections: true,
            transmission: true,
            indirect: true,
            ..Features::default()
        };
        for name in ["light", "hits", "trace", "transmit", "indirect", "compose"] {
            let names = part(features, name);
            let has = |wanted: &[&str]| wanted.iter().any(|name| names.contains(*name));
            let has_code = has(&["fog_length", "place_towards"]);
            let is_bound = has(&["fog", "fog_light"]);
            let blends = name == "compose";
            assert_eq!((has_code, is_bound), (fog && !blends, fog), "{name}");
        }
    }
}
