//! File formats that Reflet does not read, with advice how to convert them.

use std::path::Path;

/// File name extensions of models in other formats.
const MODELS: [&str; 13] = [
    "3ds", "3mf", "abc", "blend", "c4d", "dae", "fbx", "hip", "ma", "max", "mb", "skp", "step",
];

/// File name extensions of images in other formats.
const IMAGES: [&str; 14] = [
    "avif", "bmp", "dds", "exr", "gif", "hdr", "heic", "jxl", "psd", "svg", "tga", "tif", "tiff",
    "tx",
];

fn ending<'p>(path: &'p Path, of: &[&str]) -> Option<&'p str> {
    let ending = path.extension()?.to_str()?;
    let is_one = of.iter().any(|known| ending.eq_ignore_ascii_case(known));
    is_one.then_some(ending)
}

/// Error message and help for a model in another format; `None` for all other files.
pub fn model(path: &Path) -> Option<(String, &'static str)> {
    let ending = ending(path, &MODELS)?;
    let message = format!(
        "models are glTF (`.glb`, `.gltf`, `.vrm`), USD, OBJ, STL or PLY files, and this is a `.{ending}` file"
    );
    let help = match ending.eq_ignore_ascii_case("fbx") {
        true => {
            "make a `.glb` of it by Blender (File, Import, FBX, then Export, glTF 2.0) or FBX2glTF"
        }
        false => "export it as `.glb`, in Blender by File, Export, glTF 2.0",
    };
    Some((message, help))
}

/// Error message and help for the text of a scene that a model names; `None` for all other files.
pub fn scene(path: &Path) -> Option<(String, &'static str)> {
    let help = "place it: write `model = { scene = \"….toml\" }` in an `[[instance]]`";
    ending(path, &["toml"]).map(|_| ("a scene is no model".to_owned(), help))
}

/// Error message and help for an image in another format; `None` for all other files.
pub fn image(path: &Path) -> Option<(String, &'static str)> {
    let ending = ending(path, &IMAGES)?;
    let message =
        format!("textures are PNG, JPEG, WebP or KTX2 files, and this is a `.{ending}` file");
    Some((message, "save it as `.png`"))
}
