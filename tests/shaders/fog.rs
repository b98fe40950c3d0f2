//! Scenes without fog have no line and no binding of it in any shader.

use reflet::{
    gpu::{ShaderLibrary, check, reflect::capabilities},
    render::plan::Features,
};

use super::variant;

#[test]
fn shaders_without_fog_have_nothing_of_it() {
    let embedded = ShaderLibrary::embedded();
    for fog in [false, true] {
        let features = Features {
            fog,
            reflections: true,
            transmission: true,
            indirect: true,
            ..Features::default()
        };
        let library = variant(features)
            .library(&embedded)
            .unwrap_or_else(|e| panic!("{e}"));
        for name in ["light", "hits", "trace", "transmit", "indirect", "compose"] {
            let source = library.source(name).unwrap_or_else(|e| panic!("{e}"));
            let has_line =
                ["fog_length", "place_towards", "fog_light"].map(|word| source.text.contains(word));
            let info = check(&source, capabilities(wgpu::Features::empty()));
            let info = info.unwrap_or_else(|e| panic!("{e}"));
            let is_bound = info
                .bindings
                .iter()
                .any(|b| ["fog", "fog_light"].contains(&b.name.as_str()));
            assert_eq!((has_line.contains(&true), is_bound), (fog, fog), "{name}");
        }
    }
}
