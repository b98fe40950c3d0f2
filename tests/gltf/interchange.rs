//! OBJ, STL and PLY models: the shown parts of each file of the folder, or its error, stand beside it.

use reflet::scene::diagnostic::Diagnostic;

use crate::kit::*;

/// A line for each instance with its geometry and its material, then the messages.
fn told(folder: &Path, file: &str) -> String {
    let messages = |all: &[Diagnostic]| -> String {
        let line = |d: &Diagnostic| format!("{}: {}\n", d.name, d.message);
        let lines: String = all.iter().map(line).collect();
        lines.replace(&folder.display().to_string(), "FOLDER")
    };
    let world = match load_scene(&scene(folder, file)) {
        Ok(world) => world,
        Err(errors) => return messages(&errors),
    };
    let mut lines = String::new();
    for instance in &world.instances {
        let (mesh, m) = (
            &world.meshes[instance.mesh],
            &world.materials[instance.material],
        );
        let (name, bounds) = (&instance.name, world.bounds_of(instance));
        let shapes = (mesh.triangles.len(), mesh.capsule_radius_m.is_some());
        let uv = mesh.uv0.iter().map(|uv| uv.to_string()).max();
        let color = mesh.colors.first();
        let map = m.base_color_texture.is_some();
        lines += &format!(
            "{name}: {shapes:?} to {} uv {uv:?} color {color:?}\n",
            bounds.max
        );
        let (color, metallic, roughness) = (m.base_color, m.numbers.metallic, m.numbers.roughness);
        lines += &format!(
            "  {}: {color} map {map} {metallic} {roughness} {}\n",
            m.name, m.emission
        );
    }
    lines + messages(&world.warnings).as_str()
}

#[test]
fn models_of_other_formats_are_read_or_refused_with_their_place() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/gltf/interchange");
    for entry in fs::read_dir(&folder).expect("the folder") {
        let path = entry.expect("a file").path();
        let file = path.file_name().expect("a name").to_string_lossy();
        if ![".obj", ".stl", ".ply"].iter().any(|e| file.ends_with(e)) {
            continue;
        }
        let (found, beside) = (told(&folder, &file), folder.join(format!("{file}.txt")));
        if std::env::var_os("UPDATE_EXPECTED").is_some() {
            fs::write(&beside, &found).expect("written");
        }
        assert_eq!(
            found,
            fs::read_to_string(&beside).unwrap_or_default(),
            "{file}"
        );
        // A part of the file is shown or refused too.
        let bytes = fs::read(&path).expect("the model");
        let cut = Folder::new();
        for part in 0..20 {
            cut.write(&file, &bytes[..bytes.len() * part / 20]);
            drop(told(&cut.0, &file));
        }
    }
}
