//! Text output of `info`, without `--json`.

use std::fmt::Write as _;

use super::{Info, first, skipped};
use crate::{
    output::stats::mebibytes,
    render::{decide::Decision, query::answer::Timeline},
    scene::desc::LightKind,
};

/// Project of the scene, and the folders that its files may be in.
fn files(info: &Info) -> Vec<(&'static str, String)> {
    let project = info.project.iter().map(|file| ("project", file.clone()));
    let border = info.border.iter().map(|folder| ("border", folder.clone()));
    project.chain(border).collect()
}

/// Table with a line for each fact.
pub fn table(info: &Info) -> String {
    let mut out = String::new();
    let mut line = |label: &str, value: String| {
        // Writing to a string cannot fail.
        let _ = writeln!(out, "{label:<12}{value}");
    };
    line("scene", info.scene.clone());
    for (label, value) in files(info) {
        line(label, value);
    }
    line("cameras", first(&info.cameras));
    let ([width, height], samples) = (info.size_px, info.samples);
    line(
        "picture",
        format!("{width} x {height} pixels, {samples} samples"),
    );
    if let Some(time) = info.time {
        line("time", time.words());
    }
    line(
        "triangles",
        format!(
            "{} placed, {} stored in {} meshes",
            info.triangles_placed, info.triangles_stored, info.meshes
        ),
    );
    line(
        "instances",
        format!("{}, {} dynamic", info.instances, info.instances_dynamic),
    );
    line(
        "materials",
        format!(
            "{}, {} reflective, {} cut out",
            info.materials, info.materials_reflective, info.materials_cut_out
        ),
    );
    line("textures", info.textures.to_string());
    line("lights", lights(info));
    for (label, value) in choices(info) {
        line(label, value);
    }
    if let Some(Timeline { start, end, fps }) = info.choices.timeline {
        line("timeline", format!("frames {start} to {end} at {fps} fps"));
    }
    for cut in &info.choices.cuts {
        line("cut", format!("frame {}: {}", cut.frame, cut.camera));
    }
    if !info.moves.is_empty() {
        line("moves", first(&info.moves));
    }
    for param in &info.params {
        line("param", param.clone());
    }
    for (group, params) in &info.placed_params {
        line("param", format!("of \"{group}\": {}", params.join(", ")));
    }
    let corner = |[x, y, z]: [f32; 3]| format!("({x:.3}, {y:.3}, {z:.3})");
    let corners = |[min, max]: [_; 2]| format!("{} to {} m", corner(min), corner(max));
    line(
        "bounds",
        info.bounds_m.map_or("nothing".to_owned(), corners),
    );
    if let Some(bounds) = info
        .static_bounds_m
        .filter(|_| info.static_bounds_m != info.bounds_m)
    {
        line("static", corners(bounds));
    }
    line("U", format!("{:.4} m", info.unit_m));
    line("ray length", format!("{:.3} m", info.ray_length_m));
    line("threshold", format!("{:.4} m", info.threshold_m));
    line(
        "memory",
        format!(
            "geometry {}, trees {}, textures {}, shadow maps {}",
            mebibytes(info.geometry_bytes),
            mebibytes(info.tree_bytes),
            mebibytes(info.texture_bytes),
            mebibytes(info.shadow_map_bytes)
        ),
    );
    line("bounces", info.bounces.to_string());
    for (label, value) in frame(info) {
        line(label, value);
    }
    line("warnings", info.warnings.to_string());
    for file in &info.files {
        line("file", file.clone());
    }
    out
}

/// Numbers of lights by kind, of lights in the light tree, and of emitting triangles.
fn lights(info: &Info) -> String {
    let kinds = info.lights.iter().zip(LightKind::NAMES);
    let mut lights: Vec<_> = kinds.map(|(n, name)| format!("{n} {name}")).collect();
    if info.tree_lamps > 0 {
        let lamps = info.tree_lamps;
        lights.push(format!(
            "{lamps} of them in the light tree, with shadows by rays"
        ));
    }
    if info.light_triangles > 0 {
        lights.push(format!("{} triangles that light", info.light_triangles));
    }
    lights.join(", ")
}

/// Lines about animations and material variants of the files, from which scene text chooses.
fn choices(info: &Info) -> Vec<(&'static str, String)> {
    let mut lines = Vec::new();
    for animation in &info.animations {
        let state = match (animation.channels, animation.played) {
            (0, _) => "cannot be played".to_owned(),
            (n, played) => format!(
                "{:.3} s, {n} channels, {}",
                animation.duration_s,
                if played { "played" } else { "not played" }
            ),
        };
        let (model, name) = (&animation.model, &animation.name);
        lines.push(("animation", format!("\"{name}\" of model {model}: {state}")));
    }
    for file in &info.choices.models {
        let kinds = [
            ("materials", &file.materials),
            ("nodes", &file.nodes),
            ("variants", &file.variants),
        ];
        for (label, names) in kinds.into_iter().filter(|(_, names)| !names.is_empty()) {
            let shown = file.shown_variant.as_deref().unwrap_or("none of them");
            let shown = match label {
                "variants" => format!("; shown: {shown}"),
                _ => String::new(),
            };
            let (model, names) = (&file.name, first(names));
            lines.push(("model", format!("{model}: {label} {names}{shown}")));
        }
    }
    let own = info.choices.scene_variants.join(", ");
    lines.extend((!own.is_empty()).then_some(("variants", format!("{own} of the scene"))));
    lines
}

/// Lines about this machine's adapter, and about what is decided and left out.
fn frame(info: &Info) -> Vec<(&'static str, String)> {
    let adapter = info.adapter.as_deref().unwrap_or("none");
    let mut lines = vec![("adapter", adapter.to_owned())];
    for (verb, abilities) in [("has", &info.adapter_has), ("lacks", &info.adapter_lacks)] {
        if !abilities.is_empty() {
            lines.push(("", format!("{verb} {}", abilities.join(", "))));
        }
    }
    if let Some(maps) = &info.maps {
        let (text, bytes) = (&maps.texts[1], mebibytes(maps.bytes));
        lines.push((maps.label, format!("{text}, {bytes}")));
    }
    lines.extend(info.skipped.iter().flat_map(skipped::lines));
    lines.extend(decisions(info).into_iter().map(|text| ("decided", text)));
    let left_out = info.left_out.iter();
    lines.extend(left_out.map(|d| ("left out", format!("{}: {}", d.what, d.why))));
    lines
}

/// Lines about the values decided for settings left to `auto`, with the adapters that they apply to.
fn decisions(info: &Info) -> Vec<String> {
    let of = |kind: &str, list: &[Decision]| {
        let text = |d: &Decision| format!("{} = {} on {kind}: {}", d.what, d.chosen, d.why);
        list.iter().map(text).collect::<Vec<_>>()
    };
    [
        of("software", &info.decided_software),
        of("GPUs", &info.decided_gpu),
    ]
    .concat()
}
