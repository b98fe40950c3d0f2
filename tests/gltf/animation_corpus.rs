//! Animated files of an external corpus, if present: poses equal an independent evaluation written
//! from the specification.

use std::{collections::HashMap, path::PathBuf};

use glam::{DAffine3, DMat3, DQuat, DVec3, DVec4, Mat4};
use reflet::scene::desc::{Playback, TimelineDesc};

use crate::{
    common::{sampled, shared_folder},
    kit::*,
};

/// JSON and buffers of a file.
struct File {
    json: Value,
    buffers: Vec<Vec<u8>>,
}

impl File {
    /// Opens a file; `None` if its bytes lie in `data:` URIs, which this reader does not decode.
    fn open(path: &Path) -> Option<Self> {
        let bytes = fs::read(path).ok()?;
        let number = |at: usize| {
            let bytes: [u8; 4] = bytes[at..at + 4].try_into().expect("four bytes");
            u32::from_le_bytes(bytes) as usize
        };
        let is_binary = bytes.starts_with(b"glTF");
        let text = if is_binary {
            &bytes[20..20 + number(12)]
        } else {
            &bytes[..]
        };
        let json: Value = serde_json::from_slice(text).ok()?;
        let mut buffers = Vec::new();
        for buffer in json["buffers"].as_array()? {
            buffers.push(match buffer["uri"].as_str() {
                Some(uri) => fs::read(path.parent()?.join(uri)).ok()?,
                None => bytes[20 + number(12) + 8..].to_vec(),
            });
        }
        Some(Self { json, buffers })
    }

    fn list<'a>(&'a self, key: &str) -> &'a [Value] {
        self.json[key].as_array().map_or(&[], Vec::as_slice)
    }

    /// Values of an accessor, floats or normalized integers, element by element.
    fn values(&self, accessor: &Value) -> Vec<DVec4> {
        let accessor = &self.list("accessors")[index(accessor)];
        let view = &self.list("bufferViews")[index(&accessor["bufferView"])];
        let bytes = &self.buffers[index(&view["buffer"])];
        let lanes = match accessor["type"].as_str() {
            Some("SCALAR") => 1,
            Some("VEC3") => 3,
            _ => 4,
        };
        let (size, scale) = match index(&accessor["componentType"]) {
            5120 => (1, 127.0),
            5121 => (1, 255.0),
            5122 => (2, 32767.0),
            5123 => (2, 65535.0),
            _ => (4, 1.0),
        };
        let stride = view["byteStride"]
            .as_u64()
            .map_or(lanes * size, |s| s as usize);
        let start = index(&view["byteOffset"]) + index(&accessor["byteOffset"]);
        let component = |at: usize| {
            let bytes = &bytes[at..at + size];
            let value = match index(&accessor["componentType"]) {
                5120 => f64::from(bytes[0] as i8),
                5121 => f64::from(bytes[0]),
                5122 => f64::from(i16::from_le_bytes([bytes[0], bytes[1]])),
                5123 => f64::from(u16::from_le_bytes([bytes[0], bytes[1]])),
                _ => f64::from(f32::from_le_bytes(bytes.try_into().expect("four bytes"))),
            };
            (value / scale).max(if scale == 1.0 { f64::MIN } else { -1.0 })
        };
        let element = |i: usize| {
            let lane = |l: usize| {
                if l < lanes {
                    component(start + i * stride + l * size)
                } else {
                    0.0
                }
            };
            DVec4::from_array([0, 1, 2, 3].map(lane))
        };
        (0..index(&accessor["count"])).map(element).collect()
    }

    /// Animated values at a time, by node and path.
    fn sampled(&self, animation: &Value, time_s: f64) -> HashMap<(usize, String), DVec4> {
        let mut set = HashMap::new();
        for channel in animation["channels"].as_array().expect("channels") {
            let (target, path) = (&channel["target"], channel["target"]["path"].as_str());
            let Some(path @ ("translation" | "rotation" | "scale")) = path else {
                continue;
            };
            let sampler = &animation["samplers"][index(&channel["sampler"])];
            let times: Vec<f64> = self.values(&sampler["input"]).iter().map(|v| v.x).collect();
            let values = self.values(&sampler["output"]);
            let kind = sampler["interpolation"].as_str().unwrap_or("LINEAR");
            let value = curve(&times, &values, kind, path == "rotation", time_s);
            set.insert((index(&target["node"]), path.to_owned()), value);
        }
        set
    }

    /// World matrices by the path of their node, of nodes with a mesh and no skin.
    fn pose(&self, animation: &Value, time_s: f64) -> HashMap<String, DAffine3> {
        let set = self.sampled(animation, time_s);
        let scene = &self.list("scenes")[index(&self.json["scene"])];
        let mut placed = HashMap::new();
        let roots = scene["nodes"].as_array().expect("roots");
        let mut stack: Vec<_> = roots
            .iter()
            .map(|n| (index(n), DAffine3::IDENTITY, "m".to_owned()))
            .collect();
        while let Some((i, parent, path)) = stack.pop() {
            let node = &self.list("nodes")[i];
            let world = parent * local(node, |path| set.get(&(i, path.to_owned())).copied());
            let name = node["name"].as_str().filter(|n| !n.is_empty());
            let path = format!("{path}/{}", name.map_or(format!("node {i}"), str::to_owned));
            if node["mesh"].is_u64() && node["skin"].is_null() {
                placed.insert(path.clone(), world);
            }
            for child in node["children"].as_array().into_iter().flatten() {
                stack.push((index(child), world, path.clone()));
            }
        }
        placed
    }
}

fn index(value: &Value) -> usize {
    value.as_u64().unwrap_or(0) as usize
}

/// Transform from the node to its parent, with the values of an animation.
fn local(node: &Value, set: impl Fn(&str) -> Option<DVec4>) -> DAffine3 {
    if let Some(matrix) = node["matrix"].as_array() {
        let numbers: Vec<f32> = matrix
            .iter()
            .map(|x| x.as_f64().expect("a number") as f32)
            .collect();
        let matrix = Mat4::from_cols_slice(&numbers).as_dmat4();
        return DAffine3::from_mat4(matrix);
    }
    let own = |key: &str, rest: DVec4| {
        let written = node[key].as_array().map(|list| {
            let lane = |i: usize| list.get(i).and_then(Value::as_f64).unwrap_or(0.0);
            DVec4::from_array([0, 1, 2, 3].map(lane))
        });
        set(key).or(written).unwrap_or(rest)
    };
    let q = own("rotation", DVec4::W).normalize();
    // The rotation matrix of a quaternion, from its definition.
    let turned = |v: DVec3| {
        let axis = q.truncate();
        v + 2.0 * axis.cross(axis.cross(v) + q.w * v)
    };
    let size = own("scale", DVec4::ONE).truncate();
    DAffine3 {
        matrix3: DMat3::from_cols(
            turned(DVec3::X) * size.x,
            turned(DVec3::Y) * size.y,
            turned(DVec3::Z) * size.z,
        ),
        translation: own("translation", DVec4::ZERO).truncate(),
    }
}

fn curve(times: &[f64], values: &[DVec4], kind: &str, is_rotation: bool, time_s: f64) -> DVec4 {
    let cubic = kind == "CUBICSPLINE";
    // Steps come early by as much as single precision may be off at the time of a frame.
    let time_s = time_s + if kind == "STEP" { 1e-4 } else { 0.0 };
    let key = |i: usize| if cubic { values[3 * i + 1] } else { values[i] };
    let last = times.len() - 1;
    if time_s <= times[0] {
        return key(0);
    }
    if time_s >= times[last] {
        return key(last);
    }
    let a = times
        .iter()
        .rposition(|t| *t <= time_s)
        .expect("after the first");
    let (span, u) = (
        times[a + 1] - times[a],
        (time_s - times[a]) / (times[a + 1] - times[a]),
    );
    match kind {
        "STEP" => key(a),
        // De Casteljau's construction over the Bézier points of the same curve.
        "CUBICSPLINE" => {
            let (out, into) = (values[3 * a + 2], values[3 * a + 3]);
            let mut p = [
                key(a),
                key(a) + out * (span / 3.0),
                key(a + 1) - into * (span / 3.0),
                key(a + 1),
            ];
            for round in (1..4).rev() {
                for i in 0..round {
                    p[i] = p[i] + (p[i + 1] - p[i]) * u;
                }
            }
            p[0]
        }
        _ if is_rotation => {
            let [a, b] = [key(a), key(a + 1)].map(|v| DQuat::from_vec4(v.normalize()));
            let between = a.inverse() * b;
            let between = if between.w < 0.0 { -between } else { between };
            let (axis, angle) = between.to_axis_angle();
            DVec4::from(a * DQuat::from_axis_angle(axis, angle * u))
        }
        _ => key(a) + (key(a + 1) - key(a)) * u,
    }
}

/// All valid files of the corpus.
fn valid_files() -> Option<(PathBuf, Vec<String>)> {
    let folder = shared_folder("REFLET_CORPUS", "corpus")?.join("gltf");
    let index = fs::read_to_string(folder.join("INDEX.tsv")).expect("readable INDEX.tsv");
    let files = index.lines().filter_map(|line| {
        let mut columns = line.split('\t');
        let file = columns.next()?.to_owned();
        (columns.next()? == "0").then_some(file)
    });
    Some((folder.clone(), files.collect()))
}

#[test]
fn poses_of_the_corpus_equal_a_second_evaluation() {
    let (folder, files) = or_skip!(valid_files());
    let (mut played, mut compared, mut worst) = (0, 0, 0.0_f64);
    let all = files.len();
    let files = sampled(files, 3);
    let share = files.len() as f64 / all as f64;
    for file in &files {
        let path = folder.join(file);
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let mut desc = scene(path.parent().unwrap_or(Path::new(".")), &name);
        let Ok(world) = load_scene(&desc) else {
            continue;
        };
        // The validator's own cases have accessors without data, so that all keys are at 0 s.
        if file.starts_with("KhronosGroup-glTF-Validator/") {
            continue;
        }
        let broken = world.warnings.iter().find(|w| w.name == "animation-broken");
        assert!(broken.is_none(), "{file}: {broken:?}");
        for (i, animation) in world.animations.iter().enumerate() {
            desc.models[0].value.animation = Some(AnimationDesc {
                repeat: Playback::Once,
                ..AnimationDesc::endless(vec![unplaced(&animation.name)])
            });
            desc.timeline = Some(TimelineDesc {
                fps: 12.0 / animation.duration_s.max(0.1),
                start: 0,
                end: 12,
            });
            let scene = Scene::from(desc.clone());
            let motion = Animator::new(&scene);
            let mut world = load_scene(&desc).unwrap_or_else(|e| panic!("{file}: {e:?}"));
            played += 1;
            let second = File::open(&path);
            for frame in [0, 1, 3, 5, 8, 11, 12] {
                let state = motion.pose(frame).expect("it can be posed");
                world
                    .apply(&state)
                    .unwrap_or_else(|e| panic!("{file}: {e:?}"));
                let Some(second) = &second else { continue };
                let pose = second.pose(&second.list("animations")[i], state.time_s);
                for instance in world.instances.iter().filter(|i| !i.is_hidden()) {
                    let Some(expected) = pose.get(&instance.name) else {
                        continue; // skinned, or a copy
                    };
                    let got = instance.world_from_object;
                    let linear = glam::Mat3::from(got.matrix3).as_dmat3() - expected.matrix3;
                    let moved = got.translation.as_dvec3() - expected.translation;
                    let size = expected.translation.length().max(1.0);
                    let away = linear
                        .to_cols_array()
                        .into_iter()
                        .fold(0.0, |m, x| f64::max(m, x.abs()));
                    let scale = expected.matrix3.to_cols_array();
                    let scale = scale.into_iter().fold(1.0, |m, x| f64::max(m, x.abs()));
                    let away = f64::max(away / scale, moved.length() / size);
                    assert!(
                        away < 2e-6,
                        "{file} {} frame {frame}: {away}",
                        instance.name
                    );
                    (compared, worst) = (compared + 1, worst.max(away));
                }
            }
        }
    }
    println!("{played} animations played, {compared} poses compared, worst {worst:.1e}");
    let [played, compared] = [played, compared].map(|count| f64::from(count) / share);
    assert!(played >= 25.0 && compared >= 500.0, "{played} {compared}");
}
