//! Warnings about invalid materials: the location of the fault, and the substitute that is used.

use reflet::world::emitters::MAX_EMITTERS;

use crate::kit::*;

const EMISSIVE: &str = "KHR_materials_emissive_strength";

/// The three words of a line.
fn words(line: &str) -> [&str; 3] {
    let words: Vec<_> = line.split(' ').collect();
    words.try_into().expect("three words")
}

#[test]
fn a_broken_image_names_the_texture_that_uses_it() {
    for line in include_str!("material_faults/textures.txt").lines() {
        let [extension, factor, key] = words(line);
        let mut doc = stone();
        let broken = doc.texture(b"no image");
        let name = format!("KHR_materials_{extension}");
        let mut layer = json!({"sheenColorFactor": [1, 1, 1]});
        layer[factor] = json!(0.5);
        layer[key] = json!({"index": broken});
        doc.json["materials"][0]["extensions"] = json!({ &name: layer });
        let place = format!("{key} (/materials/0/extensions/{name}/{key}) of material 0 \"stone\"");
        let (_, found) = doc.error();
        assert!(found.contains(&place), "{found}");
        // An image whose file is missing.
        doc.json["images"][1] = json!({"uri": "lost.png"});
        let (error, found) = doc.error();
        assert_eq!(error, "file-not-found");
        let is_whole = found.contains(&place) && found.contains("2), in /");
        assert!(is_whole, "{found}");
    }
}

#[test]
fn factors_outside_their_range_are_named() {
    let mut doc = stone();
    let world = doc.world();
    assert!(warnings(&world).is_empty());
    let material = &mut doc.json["materials"][0];
    material["pbrMetallicRoughness"]["metallicFactor"] = json!(1.5);
    let named = |doc: &Doc| {
        let world = doc.world();
        let messages = world.warnings.iter().map(|w| (w.name, w.message.clone()));
        messages.collect::<Vec<_>>()
    };
    let [(name, message)] = &named(&doc)[..] else {
        panic!("one warning")
    };
    assert_eq!(*name, "factor-clamped");
    let expected = "material 0 \"stone\": metallicFactor is 1.5, expected 0 to 1";
    assert!(
        message.starts_with('1') && message.ends_with(expected),
        "{message}"
    );
    for line in include_str!("material_faults/factors.txt").lines() {
        let [extension, key, value] = words(line);
        let value: Value = serde_json::from_str(value).expect("a value");
        let mut doc = stone();
        let name = format!("KHR_materials_{extension}");
        doc.json["materials"][0]["extensions"] = json!({ name: { key: value } });
        let [(name, message)] = &named(&doc)[..] else {
            panic!("one warning of {key}")
        };
        assert_eq!(*name, "factor-clamped");
        assert_says(message, &[&format!("\"stone\": {key} is ")]);
    }
}

fn put_triangles(doc: &mut Doc, number: usize) {
    let number = 3 * number;
    let indices: Vec<u8> = (0..number as u32)
        .flat_map(|i| (i % 3).to_le_bytes())
        .collect();
    let indices = doc.accessor("SCALAR", 5125, number, &indices);
    doc.primitive("indices", indices.into());
}

/// Lights of the scene itself take precedence over mesh lights of a file.
#[test]
fn mesh_lights_of_a_file_make_room_for_lights_of_the_scene() {
    let mut doc = stone();
    doc.json["materials"][0]["extras"] = json!({"mesh_light": {}});
    put_triangles(&mut doc, MAX_EMITTERS - 5);
    let folder = Folder::new();
    folder.write("m.glb", doc.glb());
    let text = "version = 1\n[model.m]\nfile = \"m.glb\"\n[material.own]\nemission = [9, 9, 9]\n\
                light = true\n[model.lamp]\nshape.kind = \"box\"\nmaterial = \"own\"\n";
    let scene = Scene::from_text(text, &folder.0.join("scene.toml"), &[]);
    let scene = scene.expect("it is right").0;
    let world = load(&scene, &LoadOptions::default()).expect("it loads");
    let light = |name: &str| {
        let material = world.materials.iter().find(|m| m.name.contains(name));
        material.expect("it is used").light
    };
    assert_eq!((light("own"), light("stone")), (true, false));
    let (files, own) = (
        format!("{} triangles", MAX_EMITTERS - 5),
        "the 12 of the scene",
    );
    let warning = &world.warnings[0].message;
    assert!(
        warning.starts_with(&files) && warning.contains(own),
        "{warning}"
    );
}

#[test]
fn mesh_lights_of_a_file_light_up_to_their_number() {
    let mut doc = stone();
    doc.json["materials"][0]["extras"] = json!({"mesh_light": {}});
    let lights = |doc: &Doc| {
        let world = doc.world();
        (world.materials[0].light, warnings(&world))
    };
    assert_eq!(lights(&doc), (true, vec![]));
    put_triangles(&mut doc, MAX_EMITTERS + 1);
    assert_eq!(lights(&doc), (false, vec!["emitters-too-many"]));
    // Other values of `mesh_light` make no light, nor does a material that emits nothing.
    let mut doc = stone();
    for not in [json!(false), json!(null), json!(1)] {
        doc.json["materials"][0]["extras"] = json!({ "mesh_light": not });
        assert_eq!(lights(&doc), (false, vec![]));
    }
    doc.json["materials"][0]["extras"] = json!({"mesh_light": {}});
    doc.json["materials"][0]["emissiveFactor"] = json!([0, 0, 0]);
    assert_eq!(lights(&doc), (false, vec![]));
}

/// Lamps of exporters, which have no other sign than their emission, light what is around; the scene's word decides.
#[test]
fn emission_brighter_than_white_lights() {
    let mut doc = stone();
    let material = &mut doc.json["materials"][0];
    material["emissiveFactor"] = json!([0, 0.5, 0.25]);
    for (strength, lights) in [(2.0, false), (2.01, true)] {
        let material = &mut doc.json["materials"][0];
        material["extensions"] = json!({EMISSIVE: {"emissiveStrength": strength}});
        assert_eq!(doc.world().materials[0].light, lights, "{strength}");
    }
    let folder = Folder::new();
    folder.write("m.glb", doc.glb());
    let text =
        "version = 1\n[model.m]\nfile = \"m.glb\"\n[model.m.material.stone]\nlight = false\n";
    let scene = Scene::from_text(text, &folder.0.join("scene.toml"), &[]);
    let world = load(&scene.expect("it is right").0, &LoadOptions::default());
    assert!(!world.expect("it loads").materials[0].light);
}
