//! Animations of a file: validates and decodes their channels.

mod pointer;
mod shared;

use std::{
    collections::{HashMap, HashSet},
    sync::Arc,
};

use glam::DVec4;
use serde::{Deserialize, de::DeserializeOwned};
use serde_json::Value;

pub use self::pointer::moved_material_keys;
use self::{
    pointer::{is_unused, pointed_at, weights_pointed_at},
    shared::{Kind, SamplerKey, check_count},
};
use super::{
    Fault, Notes,
    accessor::{self, Component, Data},
    container, finite, label, schema,
    schema::Root,
    uri::shorten,
};
use reflet_base::unique_names::UniqueNames;

use crate::animation::{
    Animation, Channel, Interpolation, PointerTrack, Property, Sampler, WeightTrack,
};

/// A named animation; a broken one is an error only where it is played.
#[derive(Clone, Debug)]
pub struct Clip {
    /// Unique name; `animation 0` for an animation without one.
    pub name: String,
    /// The decoded animation, or its error.
    pub animation: Result<Arc<Animation>, Fault>,
    /// Warnings about ignored parts.
    pub notes: Notes,
}

fn fault(text: impl Into<String>) -> Fault {
    Fault::new("gltf-animation", text)
}

/// Animations of a file, with the kinds of its light and the metadata of its USD stage.
#[derive(Clone, Debug, Default)]
pub struct Playable {
    /// The animations.
    pub clips: Vec<Clip>,
    /// Metadata of the USD stage that the file was converted from.
    pub stage: Option<StageTime>,
    /// Whether all placed materials are unlit.
    pub is_unlit: bool,
    /// Whether the file has light from all directions.
    pub has_image_light: bool,
}

/// Mapping from seconds of the converted file to time codes of its stage.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct StageTime {
    /// Time codes per second.
    #[serde(rename = "timeCodesPerSecond")]
    pub rate: f64,
    /// The time code at 0 s.
    #[serde(rename = "timeOrigin")]
    pub origin: f64,
    /// First time code that the stage states.
    pub start_time_code: Option<f64>,
    /// Last time code that the stage states.
    pub end_time_code: Option<f64>,
}

impl StageTime {
    /// Time mapping from the extras of a file's scene; `None` for files that the converter did not write.
    pub fn from_root(root: &Root) -> Option<Self> {
        let scene = root.scenes.get(root.scene.unwrap_or(0))?;
        Self::deserialize(scene.extras.get("usd")?).ok()
    }
}

/// Reads all animations of a file; a broken one keeps its error.
pub fn read(root: &Root, data: &Data<'_>) -> Vec<Clip> {
    let mut names = UniqueNames::default();
    let mut reader = Reader {
        root,
        data,
        times: HashMap::new(),
        samplers: HashMap::new(),
    };
    let clip = |(i, value): (usize, &Value)| {
        let parts = Parts {
            channels: parse(value, "channels"),
            samplers: parse(value, "samplers"),
        };
        let own = value.get("name").and_then(Value::as_str);
        let own = own.filter(|name| !name.trim().is_empty());
        let base = own.map_or_else(|| format!("animation {i}"), shorten);
        let mut notes = Notes::default();
        let place = label("animation", i, own);
        let read = reader.animation(&parts, &place, &mut notes);
        Clip {
            name: names.take(&base),
            animation: read.map(Arc::new).map_err(|fault| fault.placed(&place)),
            notes,
        }
    };
    root.animations.iter().enumerate().map(clip).collect()
}

/// Channels and samplers of an animation; a broken channel or sampler is its error.
struct Parts {
    channels: Vec<Result<schema::Channel, Fault>>,
    samplers: Vec<Result<schema::AnimationSampler, Fault>>,
}

impl Parts {
    fn sampler(&self, channel: &schema::Channel) -> Result<&schema::AnimationSampler, Fault> {
        let index = channel.sampler;
        let missing = || fault(format!("sampler {index} does not exist"));
        let sampler = self.samplers.get(index).ok_or_else(missing)?;
        let broken = |fault: &Fault| fault.clone().placed(&format!("sampler {index}"));
        sampler.as_ref().map_err(broken)
    }
}

/// The parts in a list of an animation.
fn parse<T: DeserializeOwned>(animation: &Value, list: &str) -> Vec<Result<T, Fault>> {
    let parts = animation.get(list).and_then(Value::as_array);
    let part = |part: &Value| {
        serde_json::from_value(part.clone()).or_else(|first| {
            let mut part = part.clone();
            container::integers_from_floats(&mut part);
            serde_json::from_value(part).map_err(|_| fault(first.to_string()))
        })
    };
    parts.into_iter().flatten().map(part).collect()
}

/// Maximum number of broken channels that are left out of an animation; one with more of them is not played.
const MOST_BROKEN: usize = 100;

/// Tracks of the channels of an animation.
#[derive(Default)]
struct Tracks {
    channels: Vec<Channel>,
    weights: Vec<WeightTrack>,
    pointers: Vec<PointerTrack>,
    /// Nodes and properties that the channels move.
    targets: HashSet<(usize, Property)>,
}

impl Tracks {
    fn is_empty(&self) -> bool {
        self.channels.is_empty() && self.weights.is_empty() && self.pointers.is_empty()
    }
}

struct Reader<'a> {
    root: &'a Root,
    data: &'a Data<'a>,
    /// Decoded key times by accessor, as many samplers share them.
    times: HashMap<usize, Arc<[f32]>>,
    /// Decoded samplers, as many channels share them: by their accessors, interpolation and kind of value.
    samplers: HashMap<SamplerKey, Arc<[Sampler]>>,
}

impl Reader<'_> {
    fn animation(
        &mut self,
        animation: &Parts,
        place: &str,
        notes: &mut Notes,
    ) -> Result<Animation, Fault> {
        if animation.channels.is_empty() {
            return Err(fault("it has no channels"));
        }
        let mut read = Tracks::default();
        let mut broken = Vec::new();
        for (c, channel) in animation.channels.iter().enumerate() {
            let channel = channel.as_ref().map_err(Fault::clone);
            let added = channel.and_then(|c| self.channel(animation, c, place, &mut read, notes));
            if let Err(fault) = added {
                broken.push(fault.placed(&format!("channel {c}")));
            }
            if broken.len() > MOST_BROKEN {
                break;
            }
        }
        if let Some(first) = broken.first() {
            if read.is_empty() || broken.len() > MOST_BROKEN {
                return Err(broken.swap_remove(0));
            }
            let what = "channels are broken and left out";
            let place = format!("{place}: {}", first.message);
            notes.add("animation-channel", broken.len() as u64, what, &place);
        }
        self.add_companions(&mut read.pointers);
        Ok(Animation::new(read.channels, read.weights, read.pointers))
    }

    /// Reads a channel, if its target is supported.
    fn channel(
        &mut self,
        animation: &Parts,
        channel: &schema::Channel,
        place: &str,
        read: &mut Tracks,
        notes: &mut Notes,
    ) -> Result<(), Fault> {
        if let Some(track) = self.weights(animation, channel)? {
            read.weights.push(track);
            return Ok(());
        }
        if let Some(track) = self.pointed(animation, channel)? {
            read.pointers.push(track);
            return Ok(());
        }
        let Some((node, property)) = self.target(&channel.target, place, notes)? else {
            return Ok(());
        };
        if read.targets.contains(&(node, property)) {
            let text = format!("an earlier channel moves the {property:?} of node {node} too");
            return Err(fault(text.to_lowercase()));
        }
        let sampler = self.sampler(animation.sampler(channel)?, property)?;
        if self.root.nodes[node].matrix.is_some() && property != Property::Visible {
            let what = "animated nodes have a matrix, which is split into translation, \
                        rotation and scale; a shear is lost";
            let place = format!("{place}, node {node}");
            notes.add("animation-matrix", 1, what, &place);
        }
        read.targets.insert((node, property));
        read.channels.push(Channel {
            node,
            property,
            sampler,
        });
        Ok(())
    }

    /// The morph weights that a channel moves; `None` for other channels, and for nodes without morph targets.
    fn weights(
        &mut self,
        animation: &Parts,
        channel: &schema::Channel,
    ) -> Result<Option<WeightTrack>, Fault> {
        let target = &channel.target;
        let node = match &target.extensions.pointer {
            Some(pointer) => weights_pointed_at(&pointer.pointer),
            None => target.node.filter(|_| target.path == "weights"),
        };
        let mesh = node.and_then(|i| self.root.nodes.get(i)?.mesh);
        let primitive = mesh.and_then(|i| self.root.meshes.get(i)?.primitives.first());
        let count = primitive.map_or(0, |p| p.targets.len());
        let Some(node) = node.filter(|_| count > 0) else {
            return Ok(None);
        };
        let sampler = animation.sampler(channel)?;
        let samplers = self.once(sampler, Kind::Weights(count), |reader, times_s, interpolation| {
            let accept = accessor::float_or_normalized;
            let values = reader.data.floats::<1>(sampler.output, accept);
            let values = values.map_err(|f| f.placed("output"))?;
            let per_key = interpolation.values_per_key();
            let expected = times_s.len().saturating_mul(per_key).saturating_mul(count);
            if values.len() != expected || !finite(values.as_flattened()) {
                return Err(fault(format!(
                    "{} keys of {count} weights need {expected} finite output values, there are {}",
                    times_s.len(),
                    values.len()
                )));
            }
            let of_target = |target: usize| {
                let own = values[target..].iter().step_by(count);
                let weights = own.map(|[weight]| DVec4::new(f64::from(*weight), 0.0, 0.0, 0.0));
                (weights.collect(), interpolation)
            };
            Ok((0..count).map(of_target).collect())
        })?;
        Ok(Some(WeightTrack { node, samplers }))
    }

    /// Target node and property; `None`, with a warning, where the target is not supported.
    fn target(
        &self,
        target: &schema::ChannelTarget,
        place: &str,
        notes: &mut Notes,
    ) -> Result<Option<(usize, Property)>, Fault> {
        let mut left_out = |name, what| {
            notes.add(name, 1, what, place);
            Ok(None)
        };
        let found = if let Some(pointer) = &target.extensions.pointer {
            if is_unused(&pointer.pointer) {
                return Ok(None);
            }
            let Some(found) = pointed_at(&pointer.pointer) else {
                let what = "channels of KHR_animation_pointer target values that Reflet cannot animate and are \
                            left out";
                return left_out("animation-pointer", what);
            };
            found
        } else {
            let property = match target.path.as_str() {
                "translation" => Property::Translation,
                "rotation" => Property::Rotation,
                "scale" => Property::Scale,
                "weights" => {
                    let what = "channels move weights of nodes without morph targets and are left \
                                out";
                    return left_out("animation-weights", what);
                }
                _ => {
                    let what = "channels have an unknown path and are left out";
                    return left_out("animation-path", what);
                }
            };
            let Some(node) = target.node else {
                let what = "channels name no node and are left out, as the specification says";
                return left_out("animation-target", what);
            };
            (node, property)
        };
        if found.0 >= self.root.nodes.len() {
            return Err(fault(format!("node {} does not exist", found.0)));
        }
        Ok(Some(found))
    }

    fn sampler(
        &mut self,
        sampler: &schema::AnimationSampler,
        property: Property,
    ) -> Result<Sampler, Fault> {
        let samplers = self.once(
            sampler,
            Kind::Node(property),
            |reader, times_s, interpolation| {
                let mut values = reader.values(sampler.output, property)?;
                check_count(&values, times_s, interpolation)?;
                let per_key = interpolation.values_per_key();
                if property == Property::Rotation {
                    for (i, value) in values.iter_mut().enumerate() {
                        let is_key = per_key == 1 || i % 3 == 1;
                        if is_key && value.length_squared() == 0.0 {
                            return Err(fault(format!("rotation {i} is zero")));
                        }
                        if per_key == 1 {
                            *value = value.normalize();
                        }
                    }
                }
                // Visibility is not interpolated.
                let interpolation = match property {
                    Property::Visible => Interpolation::Step,
                    _ => interpolation,
                };
                Ok(vec![(values, interpolation)])
            },
        )?;
        Ok(samplers[0].clone())
    }

    fn values(&self, output: usize, property: Property) -> Result<Vec<DVec4>, Fault> {
        let values: Vec<[f32; 4]> = match property {
            Property::Rotation => self.data.floats::<4>(output, accessor::float_or_normalized),
            Property::Visible => (self.data.floats::<1>(output, accessor::unsigned_byte))
                .map(|values| values.into_iter().map(|[v]| [v, 0.0, 0.0, 0.0]).collect()),
            Property::Translation | Property::Scale => {
                let accept: fn(Component, bool) -> bool = accessor::float_only;
                (self.data.floats::<3>(output, accept))
                    .map(|values| values.into_iter().map(|[x, y, z]| [x, y, z, 0.0]).collect())
            }
        }
        .map_err(|f| f.placed("output"))?;
        if let Some(i) = values.iter().position(|v| !finite(v)) {
            return Err(fault(format!("output value {i} is not finite")));
        }
        let wide = |v: [f32; 4]| DVec4::from_array(v.map(f64::from));
        Ok(values.into_iter().map(wide).collect())
    }
}
