//! Words and keys that other programs have and scene text has not, with what to write instead.

use super::{Advice, advice};

/// Unsupported words, a word by which the list that lacks them is recognized, and what to write instead.
const ABSENT: &[Advice] = advice! {
    "filmic" | "hable" | "uncharted" | "reinhard" in "agx" =>
        "\"aces\" and \"agx\" roll bright light off as film does, \"agx\" more softly";
    "area" | "quad" | "sphere" | "tube" | "mesh" in "directional" =>
        "flat lights are \"rect\" and \"disk\", a ball is \"point\" with `radius_m`, and any other shape lights where \
         its material has `emission` and `light = true`";
    "ambient" | "dome" | "env" | "environment" | "hdri" | "sky" | "skylight" in "directional" =>
        "light from all around is `[environment]`, such as `color = [0.5, 0.6, 0.8]`";
    "mesh" | "obj" | "gltf" | "file" | "model" in "cylinder" =>
        "a model from a file is `file = \"….glb\"`, without `shape`";
    "raytraced" | "raytracing" in "hybrid" =>
        "write \"rt\", which traces a ray for every reflective pixel";
    "pathtraced" | "pathtracing" | "pt" | "reference" in "hybrid" =>
        "write \"path\", which follows all light by rays";
    "pyramid" | "tetrahedron" in "lathe" =>
        "a pyramid is a \"cone\" with `segments = 4`";
    "ellipsoid" | "egg" in "lathe" =>
        "write \"sphere\", and in its instance `scale = [1, 2, 1]`";
    "tube" | "pipe" | "curve" | "cable" in "sweep" =>
        "write \"sweep\", which moves an outline along a curve";
    "rounded_box" | "roundedbox" | "round_box" in "lathe" =>
        "write \"box\", with `bevel = 0.05`";
    "boolean" | "csg" | "bool" in "lathe" =>
        "write \"union\", \"difference\" or \"intersection\"";
    "revolution" | "surface_of_revolution" | "turned" in "lathe" =>
        "write \"lathe\", which turns an outline about Y";
    "hemisphere" | "dome" in "lathe" =>
        "write \"intersection\" of a \"sphere\" and a \"box\", or \"lathe\"";
    "soft" | "hard" | "pcf" | "vsm" in "map" =>
        "\"ray\" traces shadows, and a light with a size, such as `radius_m = 0.1`, makes them soft; \"map\" looks \
         them up";
};

/// Unsupported keys, keys by which the table that lacks them is recognized, and what to write instead.
const ABSENT_KEYS: &[Advice] = advice! {
    "frame" | "frames" | "time" | "t" in "at_s" | "value" =>
        "write `at_s`, in seconds: the number of the frame divided by `fps` of `[timeline]`";
    // keys of a light, and of its motion
    "shown" | "visible" | "hidden" in "shadow_px" | "intensity_lux" =>
        "give the light a group as its parent, and hide that group: `parent = \"GROUP\"` in `[light.NAME]`, and `shown \
         = { keys = [{ at_s = 0, value = false }, { at_s = 2, value = true }] }` in `[motion.group.GROUP]`";
    // a key of a decal
    "shown" | "visible" | "hidden" in "max_angle_deg" =>
        "write `opacity = 0`; to show it for some time only, write in `[motion.decal.NAME]` `shown = { keys = [{ at_s \
         = 0, value = false }, { at_s = 2, value = true }] }`";
    "shown" | "hidden" in "casts_shadow" =>
        "write `visible = false`; to show it for some time only, write in `[motion.instance.NAME]` `shown = { keys = \
         [{ at_s = 0, value = false }, { at_s = 2, value = true }] }`";
    "specular_texture" | "specular_color_texture" | "sheen_color_texture" | "sheen_roughness_texture"
        | "transmission_texture" | "clearcoat_texture" | "clearcoat_roughness_texture"
        | "clearcoat_normal_texture" | "iridescence_texture" | "iridescence_thickness_texture"
        | "anisotropy_texture" in "clearcoat" =>
        "this texture comes from glTF files only: name one by `file = \"….glb\"` in `[model.NAME]`; the key without \
         `_texture` holds everywhere on the surface";
    "width" | "height" in "tone_map" =>
        "write `size = [1280, 720]`, width and height in pixels";
    "fps" | "framerate" | "frame_rate" in "tone_map" =>
        "write it below `[timeline]`, as in `fps = 24`";
    "gamma" | "contrast" | "saturation" | "srgb" in "tone_map" =>
        "pictures are sRGB: `exposure_ev` makes them brighter or darker, and `tone_map` rolls bright light off";
    "background" | "background_color" in "tone_map" =>
        "write it below `[environment]`, as in `color = [0.5, 0.6, 0.8]`; `visible = false` there hides it from the \
         camera";
    "method" | "bounces" | "max_bounces" in "tone_map" =>
        "write it below `[reflection]`, as in `method = \"rt\"`";
    "denoise" | "denoiser" in "tone_map" =>
        "it is an argument: `reflet render --denoise`";
    "focal_length" | "focal_length_mm" | "focal_mm" | "lens" | "lens_mm" in "orthographic_height_m" =>
        "write `fov_deg`, the vertical angle of view: 38 is a lens of 35 mm on full frame, 27 one of 50 mm";
    "rotation_deg" | "rotation" | "rotation_quat" | "yaw" | "pitch" | "roll" in "orthographic_height_m" =>
        "write `target`, the point that the camera looks at, and `up` for a roll";
    "orbit" | "rate" | "oscillate" | "follow" | "keys" in "orthographic_height_m" =>
        "it stands in the track of what it moves, as in `eye = { orbit = { center = [0, 1, 0], period_s = 8 } }`";
    "opacity" | "transparency" | "transparent" | "alpha_mode" in "clearcoat" =>
        "write `alpha = 0.5` for what shows through, or `transmission = 1` for glass";
    "glass" in "clearcoat" =>
        "write `transmission = 1`, with `roughness = 0` and `ior = 1.5`";
    "preset" | "kind" | "type" | "bsdf" | "shader" in "clearcoat" =>
        "materials have no kinds: gold is `metallic = 1` with `base_color = [1, 0.77, 0.34]`, glass `transmission = \
         1`, a lamp `emission`";
    "mirror" | "reflective" | "specularity" in "clearcoat" =>
        "write `metallic = 1` and `roughness = 0` for a mirror, or `reflectivity = 0.5` for a floor that reflects half";
    "width" | "length" | "depth" in "bevel_segments" =>
        "write `size = [1, 2, 1]`, the lengths along X, Y and Z";
    "diameter" in "radius" | "segments" =>
        "write `radius`, half of the diameter";
    "top_radius" | "radius_top" | "radius1" | "radius2" in "height" | "segments" =>
        "a cut cone is a lathe: `kind = \"lathe\"`, `points = [[0.5, 0], [0.2, 1]]`";
    "kind" | "type" | "radius" | "size" | "height" in "animation" | "usd" =>
        "write it into `shape`, as in `shape = { kind = \"sphere\", radius = 0.5 }`";
    "color" | "base_color" | "colour" in "casts_shadow" =>
        "write `material`, as in `material = { base_color = \"#b01010\" }`, for this one alone";
    "image" | "texture" | "file" | "picture" in "max_angle_deg" =>
        "write `material`, the name of one with `base_color_texture = \"a.png\"`";
    "scale" | "frequency" | "period" in "offset_m" =>
        "write `size_m`, the size of its cells in meters";
    "kind" | "type" | "name" in "offset_m" =>
        "write `pattern`, as in `pattern = \"noise\"`";
    "colors" | "color" | "values" in "offset_m" =>
        "write `from` and `to`, as in `from = \"#202020\", to = \"#e0e0e0\"`";
    "from" | "to" | "start" | "end" | "values" in "loop_s" =>
        "write `keys`, as in `keys = [{ at_s = 0, value = … }, { at_s = 2, value = … }]`";
    "at" | "look" in "orthographic_height_m" =>
        "write `target`, the point that the camera looks at";
    "count" | "copies" | "number" | "array" in "casts_shadow" =>
        "write `repeat = { count = [5, 1, 1], step = [1, 0, 0] }`";
    "scatter" | "distribute" in "casts_shadow" =>
        "write `over = { model = \"ground\", count = 500 }`";
    "power_w" | "power" | "watt" | "watts" | "energy" | "strength" in "shadow_px" =>
        "write `intensity_cd`, in candela: a bulb of 60 W shines with about 60";
    "intensity_lm" | "lumen" | "lumens" in "shadow_px" =>
        "write `intensity_cd`: lumens divided by 12.57 for a light that shines all around";
    "temperature" | "temperature_k" | "kelvin" in "shadow_px" =>
        "write `color`: \"#ffb46b\" is about 3000 K, \"#ffe4ce\" 5000 K";
    "f_stop" | "fstop" | "f_number" | "aperture" | "dof" | "depth_of_field" in "orthographic_height_m" =>
        "write `aperture_f = 2.8`, the f-number, and `focus_m`, the distance in focus; `samples` of `[image]` makes it \
         smooth";
    "focus" | "focus_distance" | "focus_distance_m" | "focal_distance" in "orthographic_height_m" =>
        "write `focus_m`, the distance in focus in meters, with `aperture_f`";
    "hfov_deg" | "hfov" | "horizontal_fov" | "fov_x" | "fovx" in "orthographic_height_m" =>
        "write `fov_deg`, the vertical angle: in a picture of 16 : 9, 59 for 90 across, 36 for 60";
    "near" | "znear" | "near_clip" | "clip_start" in "orthographic_height_m" =>
        "write `near_m`, in meters";
    "far" | "far_m" | "zfar" | "far_clip" | "clip_end" in "orthographic_height_m" =>
        "remove it: there is no far plane";
    "children" | "child" | "nodes" in "casts_shadow" =>
        "write in each of them `parent = \"NAME\"`, the name of this one";
    "rotate" | "axis" | "angle" | "angle_deg" | "axis_angle" in "casts_shadow" =>
        "write `rotation_deg = [x, y, z]`, degrees about X, then Y, then Z";
    "map" | "texture" | "diffuse_map" | "albedo_map" | "color_map" | "diffuse_texture" | "albedo_texture" in "clearcoat" =>
        "write `base_color_texture = \"wood.png\"`";
    "bump" | "bump_texture" | "bump_map" | "displacement" | "displacement_map" | "height_map" in "clearcoat" =>
        "write `normal_texture`, with a normal map that an image program makes of the heights";
    "interpolation" | "interp" | "easing" in "constant_speed" =>
        "write `ease`, the change of speed, and `curve`, the shape of the path";
    "transparent" | "transparent_background" | "film_transparent" in "tone_map" =>
        "write `alpha = true`";
    "start" | "end" | "near" | "far" | "start_m" | "end_m" | "distance" | "visibility" | "visibility_m" in "falloff_m" =>
        "write `density`, 3 divided by the distance in meters at which things vanish in it: 0.15 for 20 m";
    "fog" | "mist" | "haze" in "version" =>
        "write it below `[environment]`, as in `fog = { density = 0.02 }`";
    "weight" | "font_weight" | "bold" | "italic" | "style" in "letter_spacing" =>
        "name in `font` the file of the font's bold or italic style";
    "svg" | "file" | "d" in "fill_rule" =>
        "write `path`, the `d` of a path in the SVG file";
    // keys of a camera
    "distance" | "dolly" | "radius" in "orthographic_height_m" =>
        "write `eye`, where the camera stands, and `target`";
    "zoom" | "magnification" in "orthographic_height_m" =>
        "write `fov_deg`, the vertical angle of view, 40 by default: less shows less, and that larger";
    "projection" | "type" | "kind" | "perspective" | "orthographic" | "ortho" | "ortho_scale" | "orthographic_scale"
        | "orthographic_size" | "ortho_size" | "ortho_height" in "orthographic_height_m" =>
        "write `orthographic_height_m = 4`, the height of a picture of parallel rays, in meters";
    "resolution" | "width" | "height" | "size" | "aspect" | "aspect_ratio" in "orthographic_height_m" =>
        "write it below `[image]`, as in `size = [1280, 720]`";
    "exposure" | "ev" | "iso" | "exposure_time" | "shutter_speed" in "orthographic_height_m" =>
        "write it below `[image]`, as in `exposure_ev = 1`, in stops";
    // keys of a light
    "falloff" | "decay" | "attenuation" | "range" | "range_m" | "distance" | "quadratic" in "shadow_px" =>
        "remove it: light falls off with the square of the distance, `intensity_cd` says how bright it is at 1 m";
    "cast_shadows" | "casts_shadow" | "casts_shadows" | "cast_shadow" | "shadows" in "shadow_px" =>
        "write `shadow = \"none\"` for a light without shadows";
    "cone_angle" | "cone" | "spot_angle" | "beam_angle" | "beam" | "cutoff" | "spot_size" | "angle" in "outer_deg" =>
        "write `outer_deg`, half of the angle across the cone";
    "penumbra" | "blend" | "spot_blend" | "softness" | "feather" in "outer_deg" =>
        "write `inner_deg`, the angle up to which the cone has full brightness";
    // keys of a material
    "subsurface" | "sss" | "subsurface_color" | "subsurface_radius" | "scattering" in "clearcoat" =>
        "light does not scatter below surfaces: `transmission = 0.5` with `thickness_m` and `attenuation_color` is near it";
    "glossiness" | "gloss" | "glossy" | "smoothness" | "shininess" | "specular_exponent" in "clearcoat" =>
        "write `roughness`, 1 minus the gloss";
    "ao_map" | "ao" | "ambient_occlusion" | "occlusion_texture" | "occlusion_map" | "ao_texture" in "clearcoat" =>
        "occlusion maps come from glTF files only; `[environment]` darkens corners by `shadow = \"ray\"`";
    "roughness_map" | "metallic_map" | "metalness_map" | "roughness_texture" | "metallic_texture" | "orm_map" | "orm_texture"
        in "clearcoat" =>
        "write `metallic_roughness_texture`, one image with roughness in green and metallic in blue";
    "tiling" | "uv_repeat" | "texture_scale" | "uv_tiling" | "repeat" | "tile" | "scale" in "clearcoat" =>
        "write `uv_scale = [2, 2]`, how often images repeat";
    "two_sided" | "doublesided" | "backface_culling" | "culling" | "cull" | "side" | "backfaces" in "clearcoat" =>
        "write `double_sided = true`, or false for a surface that is seen from its front alone";
    "wireframe" | "wire" | "outline" in "clearcoat" =>
        "pictures show surfaces: a frame of rods is a \"sweep\" or a model of its own";
    "casts_shadow" | "cast_shadows" | "shadow" | "visible" in "clearcoat" =>
        "write it in the `[[instance]]`, as in `casts_shadow = false`";
    // keys of a model
    "position" | "translation" | "location" | "rotation_deg" | "rotation" | "scale" | "parent" | "visible" | "name" in "usd" =>
        "write it in an `[[instance]]` of this model, as in `translation = [0, 1, 0]`";
    "color" | "base_color" | "roughness" | "metallic" | "emission" in "usd" =>
        "write `material = \"red\"`, and the color in `[material.red]`";
    // keys of a track
    "speed" | "velocity" | "spin" | "per_second" in "loop_s" =>
        "write `rate = [1, 0, 0]`, the change for each second";
    "amplitude" | "period_s" | "frequency" | "sine" | "wave" | "phase" in "loop_s" =>
        "write `oscillate = { amplitude = [1, 0, 0], period_s = 2 }`";
    "loop" | "repeat" | "cycle" | "cyclic" in "loop_s" =>
        "write `loop_s = 2`, the seconds from the first key back to it";
    // tables of the scene
    "render" | "renderer" | "settings" | "film" | "output" | "picture" | "quality" | "engine" in "version" =>
        "write `[image]` with `size`, `samples`, `exposure_ev`; the file is named by `reflet render SCENE -o picture.png`";
    "ground" | "floor" in "version" =>
        "write `[model.floor]` with `shape = { kind = \"plane\", size = [20, 20] }`, and an `[[instance]]` of it";
    "animation" | "animations" | "keyframes" in "version" =>
        "write `[timeline]` with `end = 47`, and `[motion.instance.NAME]`";
    "shape" | "shapes" | "sphere" | "box" | "cube" | "plane" | "geometry" | "primitive" in "version" =>
        "write `[model.NAME]` with `shape = { kind = \"sphere\" }`, and an `[[instance]]` of it";
    "frames" | "duration" | "duration_s" | "length" | "length_s" | "count" in "cuts" =>
        "write `end`, the number of the last frame: 47 for 2 s at `fps = 24`";
};

/// Advice for an unsupported key in a table with the keys `known`.
pub fn absent_key(typed: &str, known: &[&str]) -> Option<&'static str> {
    advice(ABSENT_KEYS, typed, |key| known.contains(&key))
}

/// Advice for an unsupported word where one of `words` is allowed.
pub fn absent(typed: &str, words: &[&str]) -> Option<&'static str> {
    advice(ABSENT, typed, |word| words.contains(&word))
}
