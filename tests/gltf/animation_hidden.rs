//! Visibility in animations: a scale of 0, and KHR_animation_pointer switches.

use reflet::scene::desc::{Playback, TimelineDesc};

use crate::{
    animation::{cart, channel, playing, posed},
    kit::*,
};

#[test]
fn what_is_scaled_to_nothing_is_hidden() {
    let mut doc = cart();
    doc.json["nodes"][3]["scale"] = json!([0, 0, 0]); // at rest too
    let (sampler, channel) = channel(
        &mut doc,
        3,
        "scale",
        &[
            (0.0, &[0.0; 3]),
            (1.0, &[1.0; 3]),
            (2.0, &[-1.0; 3]),
            (3.0, &[1.0, 0.0, 1.0]),
        ],
    );
    doc.json["animations"] =
        json!([{"name": "grow", "samplers": [sampler], "channels": [channel]}]);
    let (_folder, mut desc) = doc.scene();
    desc.models[0].value.animation = Some(AnimationDesc {
        repeat: Playback::Once,
        ..playing(&["grow"])
    });
    desc.timeline = Some(TimelineDesc {
        fps: 24.0,
        start: 0,
        end: 96,
    });
    let loaded = load_scene(&desc).expect("it loads");
    assert!(warnings(&loaded).is_empty(), "{:?}", loaded.warnings);
    let rest = loaded.instances.iter().find(|i| i.name == "m/cart/box");
    assert!(rest.is_some_and(|i| i.is_hidden()));
    let shown = |frame: u32| {
        let world = posed(&desc, frame);
        let found = world
            .instances
            .iter()
            .find(|i| i.name == "m/cart/box")
            .expect("there");
        let bounds = world.bounds_of(found);
        assert_eq!(found.is_hidden(), bounds.is_empty());
        (!found.is_hidden()).then(|| found.world_from_object.matrix3.determinant())
    };
    assert_eq!(shown(0), None);
    assert_eq!(shown(24), Some(1.0));
    assert_eq!(shown(48), Some(-1.0), "turned over");
    assert_eq!(shown(36), None, "through nothing");
    let thin = shown(72).expect("flat things are thin, not gone");
    assert!(thin > 0.0 && thin < 1e-4, "{thin}");
    // Without a selected animation the hidden instance is dropped by name.
    desc.models[0].value.animation = None;
    assert_eq!(
        warnings(&load_scene(&desc).expect("it loads")),
        ["instance-singular"]
    );
}

#[test]
fn pointers_switch_nodes_on_and_off() {
    let mut doc = cart();
    doc.json["nodes"][4]["extensions"] = json!({"KHR_node_visibility": {"visible": false}});
    let times = doc.floats("SCALAR", &[0.0, 1.0, 2.0]);
    let switch = doc.accessor("SCALAR", 5121, 3, &[0, 1, 0]);
    let pointer = |text: &str| {
        json!({"sampler": 0, "target": {"path": "pointer",
               "extensions": {"KHR_animation_pointer": {"pointer": text}}}})
    };
    doc.json["animations"] = json!([{
        "name": "blink", "samplers": [{"input": times, "output": switch, "interpolation": "STEP"}],
        "channels": [pointer("/nodes/4/extensions/KHR_node_visibility/visible"),
                     pointer("/materials/0/extensions/KHR_materials_sss/scatterDistance")]
    }]);
    let (_folder, mut desc) = doc.scene();
    let still = load_scene(&desc).expect("it loads");
    assert_eq!(still.instances.len(), 1, "hidden unless something shows it");
    assert!(still.lights.is_empty() && warnings(&still).is_empty());
    desc.models[0].value.animation = Some(playing(&["blink"]));
    let hidden = |frame: u32| {
        let world = posed(&desc, frame);
        assert_eq!(warnings(&world), ["no-timeline", "animation-pointer"][1..]);
        let lit = world.lights[0].desc.color != Vec3::ZERO;
        let parts = world.instances.iter().filter(|i| i.name.contains("cart"));
        let hidden: Vec<_> = parts.map(|i| i.is_hidden()).collect();
        assert_eq!(hidden, [!lit; 2]);
        !lit
    };
    assert!(hidden(0) && hidden(23) && !hidden(24) && !hidden(47) && hidden(48));
}
