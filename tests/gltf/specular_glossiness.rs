//! KHR_materials_pbrSpecularGlossiness converted to metallic-roughness.

use reflet::world::Material;

use crate::kit::*;

/// A triangle with this extension and these images as textures 0 and 1.
fn material(extension: Value, images: &[Vec<u8>]) -> World {
    let mut doc = Doc::triangle();
    images.iter().for_each(|image| {
        doc.texture(image);
    });
    let extensions = json!({"KHR_materials_pbrSpecularGlossiness": extension});
    doc.material(json!({"extensions": extensions}));
    doc.primitive("material", 0.into());
    doc.world()
}

/// First texel of the base color and of the metallic-roughness map.
fn texels(world: &World, material: &Material) -> [[u8; 4]; 2] {
    [
        material.base_color_texture,
        material.metallic_roughness_texture,
    ]
    .map(|slot| {
        let rgba = &world.textures[slot.expect("a map").texture].rgba;
        [rgba[0], rgba[1], rgba[2], rgba[3]]
    })
}

#[test]
fn gray_specular_factors_are_exact() {
    let world = material(
        json!({"diffuseFactor": [0.5, 0.25, 0.125, 1], "specularFactor": [0.2, 0.2, 0.2], "glossinessFactor": 0.75}),
        &[],
    );
    let m = &world.materials[0];
    assert_eq!((m.metallic, m.reflectivity, m.roughness), (0.0, 0.2, 0.25));
    assert_eq!(m.base_color.to_array(), [0.5, 0.25, 0.125, 1.0]);
    assert!(warnings(&world).is_empty());
}

#[test]
fn a_specular_map_with_default_factors_is_no_mirror() {
    // Plastic: gray diffuse, 4 % specular (sRGB 56), glossiness 64 of 255.
    let maps = [png(2, 2, [188, 188, 188, 200]), png(4, 2, [56, 56, 56, 64])];
    let extension =
        json!({"diffuseTexture": {"index": 0}, "specularGlossinessTexture": {"index": 1}});
    let world = material(extension.clone(), &maps);
    let m = &world.materials[0];
    let [base, metallic_roughness] = texels(&world, m);
    assert!(base[..3].iter().all(|c| c.abs_diff(188) <= 3), "{base:?}");
    assert_eq!(base[3], 200, "opacity");
    assert_eq!(metallic_roughness[1], 191, "1 - glossiness");
    assert!(
        metallic_roughness[2] <= 8,
        "metallic {metallic_roughness:?}"
    );
    assert_eq!((m.metallic, m.roughness), (1.0, 1.0), "factors of the maps");
    let sizes: Vec<_> = world.textures.iter().map(|t| (t.width, t.height)).collect();
    assert_eq!(sizes, [(4, 2), (4, 2)], "only what the material samples");
    assert_eq!(warnings(&world), ["specular-glossiness-approximated"]);

    // Gold: no diffuse, tinted specular.
    let maps = [png(1, 1, [0, 0, 0, 255]), png(1, 1, [255, 195, 86, 255])];
    let world = material(extension, &maps);
    let [base, metallic_roughness] = texels(&world, &world.materials[0]);
    let near = [255, 195, 86]
        .iter()
        .zip(base)
        .all(|(a, b)| b.abs_diff(*a) <= 2);
    assert!(near, "{base:?}");
    assert_eq!(metallic_roughness[1..3], [0, 255]);
}

#[test]
fn maps_that_are_sampled_differently_keep_color_and_gloss() {
    let transform = json!({"KHR_texture_transform": {"scale": [2, 2]}});
    let extension = json!({
        "diffuseTexture": {"index": 0, "extensions": transform},
        "specularGlossinessTexture": {"index": 1}
    });
    let maps = [
        png(1, 1, [10, 20, 30, 255]),
        png(1, 1, [255, 255, 255, 255]),
    ];
    let world = material(extension, &maps);
    let m = &world.materials[0];
    let [base, metallic_roughness] = texels(&world, m);
    assert_eq!(base, [10, 20, 30, 255]);
    assert_eq!((m.metallic, metallic_roughness[1]), (0.0, 0));
    assert_eq!(
        warnings(&world),
        [
            "specular-glossiness-approximated",
            "specular-glossiness-layout"
        ]
    );
}

#[test]
fn a_tint_without_maps_becomes_a_metal() {
    let world = material(
        json!({"diffuseFactor": [0, 0, 0, 1], "specularFactor": [1, 0.76, 0.33]}),
        &[],
    );
    let m = &world.materials[0];
    assert!(m.metallic > 0.99 && m.roughness == 0.0, "{m:?}");
    assert!((m.base_color.y - 0.76).abs() < 0.01, "{m:?}");
}

#[test]
fn a_missing_map_is_an_error() {
    let mut doc = Doc::triangle();
    let extension = json!({"specularGlossinessTexture": {"index": 0}});
    let extensions = json!({"KHR_materials_pbrSpecularGlossiness": extension});
    doc.material(json!({"extensions": extensions}));
    doc.primitive("material", 0.into());
    assert_eq!(doc.error().0, "gltf-index");
    doc.texture(b"no image");
    let (name, message) = doc.error();
    assert_eq!(name, "image-unsupported");
    assert!(message.contains("specular-glossiness"), "{message}");
}
