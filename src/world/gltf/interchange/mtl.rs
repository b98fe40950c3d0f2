//! Materials of MTL files as materials of glTF. Numbers are linear, as Blender writes them; shininess becomes the
//! roughness with the same width of the highlight (Karis 2013, "Specular BRDF Reference").

use serde_json::json;

use super::{Glb, Notes};

/// Adds a material; `folder` is of its file, from the folder of the model.
pub fn add(glb: &mut Glb, material: &tobj::Material, folder: &str, notes: &mut Notes) {
    let place = format!("material \"{}\"", material.name);
    let unknown = |key: &str| material.unknown_param.get(key).map(String::as_str);
    let number = |key: &str| unknown(key).and_then(|text| text.trim().parse::<f32>().ok());
    let mut map = |statement: Option<&str>| {
        let name = format!("{folder}{}", file_name(statement?));
        Some(json!({"index": glb.texture(&name)}))
    };
    let color_map = map(material.diffuse_texture.as_deref());
    let normal_map = map(unknown("norm"));
    let emission_map = map(unknown("map_Ke"));
    let alpha = material.dissolve.unwrap_or(1.0);
    let [r, g, b] = match material.diffuse {
        // A color of 0 below a map is a place that was not filled in.
        None | Some([0.0, 0.0, 0.0]) if color_map.is_some() => [1.0; 3],
        color => color.unwrap_or([0.8; 3]),
    };
    let has_highlight = material.illumination_model.is_none_or(|model| model >= 2);
    let of_shininess = |n: f32| (2.0 / (n.max(0.0) + 2.0)).sqrt().sqrt();
    let roughness = number("Pr").or(material
        .shininess
        .filter(|_| has_highlight)
        .map(of_shininess));
    let mut pbr = json!({
        "baseColorFactor": [r, g, b, alpha],
        "metallicFactor": number("Pm").unwrap_or(0.0),
        "roughnessFactor": roughness.unwrap_or(1.0),
    });
    let emission = material
        .emissive
        .unwrap_or([if emission_map.is_some() { 1.0 } else { 0.0 }; 3]);
    let mut new = json!({"name": material.name, "doubleSided": true, "emissiveFactor": emission});
    if let Some(map) = color_map {
        pbr["baseColorTexture"] = map;
    }
    new["pbrMetallicRoughness"] = pbr;
    for (key, map) in [
        ("normalTexture", normal_map),
        ("emissiveTexture", emission_map),
    ] {
        if let Some(map) = map {
            new[key] = map;
        }
    }
    if alpha < 1.0 {
        new["alphaMode"] = "BLEND".into();
    }
    if let Some(ior) = material.optical_density.filter(|ior| *ior >= 1.0) {
        new["extensions"]["KHR_materials_ior"]["ior"] = ior.into();
    }
    let maps = [
        &material.ambient_texture,
        &material.specular_texture,
        &material.normal_texture,
        &material.shininess_texture,
        &material.dissolve_texture,
    ];
    let left_out = maps.into_iter().flatten().count();
    let what = "maps of bumps, alpha, highlights and ambient light in MTL files are left out";
    notes.add("mtl-left-out", left_out as u64, what, &place);
    glb.push("materials", new);
}

/// Name of the file in a statement such as `-bm 0.5 -clamp on wood.png`.
fn file_name(statement: &str) -> String {
    let mut rest = statement.trim();
    while let Some(option) = rest.strip_prefix('-') {
        let is_value = |word: &str| word.parse::<f32>().is_ok() || ["on", "off"].contains(&word);
        let after = |text: &'_ str| text.find(char::is_whitespace).unwrap_or(text.len());
        let word = &option[..after(option)];
        rest = option[word.len()..].trim_start();
        if word == "imfchan" || word == "type" {
            rest = rest[after(rest)..].trim_start();
        }
        while is_value(&rest[..after(rest)]) && after(rest) < rest.len() {
            rest = rest[after(rest)..].trim_start();
        }
    }
    rest.replace('\\', "/")
}

#[cfg(test)]
mod tests {
    use super::file_name;

    #[test]
    fn options_of_maps_are_skipped() {
        for (statement, name) in [
            ("wood.png", "wood.png"),
            ("-bm 0.5 -clamp on  my wood.png", "my wood.png"),
            ("-s 1 1 1 -o 0 0 tex\\2.png", "tex/2.png"),
            ("-imfchan r 7", "7"),
            ("-", ""),
        ] {
            assert_eq!(file_name(statement), name, "{statement}");
        }
    }
}
