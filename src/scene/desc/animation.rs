//! What of a file's animations is played, as people write it.

use super::At;

/// `animation = { name = "walk", … }`: what of a file's animations is played, and when. It moves the
/// nodes that the file says and what hangs on them, meshes, lights and cameras, deforms skins by their
/// joints and meshes by the weights of their morph targets; the rest stays in the static tree. A scale
/// of 0 along all axes hides. A file rendered without a scene plays all of its animations once where
/// they move different things, else the first.
#[derive(Clone, Debug, PartialEq)]
pub struct AnimationDesc {
    /// Name of one of the file's animations as `reflet info` lists them, or an array of several;
    /// `"*"` is all of them, an empty array none. Where two move the same, the later wins.
    pub name: Vec<At<String>>,
    /// Factor on its speed. Less than 0 plays it backwards, from its end. Default 1.
    pub speed: f32,
    /// Time of the scene at which it begins, seconds; until then it waits in its first pose. Less
    /// than 0 is a start before the scene's. Default 0.
    pub start_s: f32,
    /// What follows its end. Default `"loop"`.
    pub repeat: Playback,
}

/// What follows the end of an animation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Playback {
    /// `"once"`: keeps its last pose.
    Once,
    /// `"loop"`: starts over, each animation after its own length.
    #[default]
    Loop,
    /// `"ping_pong"`: runs back, and forth again.
    PingPong,
}

impl AnimationDesc {
    /// Whether an animation of that name is played.
    pub fn plays(&self, name: &str) -> bool {
        self.name.iter().any(|n| n.value == "*" || n.value == name)
    }

    /// All of these, from time 0 on and for ever.
    pub fn of(name: Vec<At<String>>) -> Self {
        Self {
            name,
            speed: 1.0,
            start_s: 0.0,
            repeat: Playback::default(),
        }
    }
}
