//! Counts and names in the output of `info`.

use super::*;

/// More lights than shadow maps are for are in the light tree, which is said.
#[test]
fn info_tells_of_the_light_tree() {
    let folder = folder("info-counts");
    let lamp = |n: u32| {
        format!(
            "[light.l{n}]\nkind = \"point\"\nposition = [0, 3, {n}]\nintensity_cd = 1\nshadow = \"ray\"\n"
        )
    };
    for (count, says) in [(64, false), (65, true)] {
        let lamps: String = (0..count).map(lamp).collect();
        let floor = "version = 1\n[model.floor]\nshape = { kind = \"plane\" }\n";
        fs::write(folder.join("lamps.toml"), floor.to_owned() + lamps.as_str()).expect("a scene");
        let [text, _] = exits(&folder, "info lamps.toml", 0);
        let told = "65 of them in the light tree, with shadows by rays\n";
        assert_eq!(text.contains(told), says, "{text}");
        assert_eq!(text.contains("light tree"), says, "{text}");
    }
}

#[test]
fn info_names_the_adapter_and_what_it_has_and_lacks() {
    let folder = folder("info-adapter");
    let [json, _] = exits(&folder, "info scene.toml --json", 0);
    let info: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    let [text, _] = exits(&folder, "info scene.toml", 0);
    let Some(gpu) = gpu_or_skip() else {
        assert!(
            info["adapter"].is_null() && text.contains("\nadapter     none\n"),
            "{text}"
        );
        return;
    };
    let name = info["adapter"].as_str().expect("a name");
    assert!(name.contains(&gpu.adapter_info.driver_info), "{name}");
    assert!(text.contains(&format!("\nadapter     {name}\n")), "{text}");
    let [has, lacks] = ["has", "lacks"].map(|verb| {
        let list = info[format!("adapter_{verb}")].as_array().expect("a list");
        if let Some(first) = list.first().and_then(|what| what.as_str()) {
            let line = format!("{verb} {first}");
            assert!(text.contains(&line), "{line} in {text}");
        }
        list.iter().any(|what| what == "ray queries")
    });
    let has_rays = gpu
        .adapter
        .features()
        .contains(wgpu::Features::EXPERIMENTAL_RAY_QUERY);
    assert_eq!([has, lacks], [has_rays, !has_rays]);
}
