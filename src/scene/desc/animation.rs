//! Playback of a model file's animations, in scene text.

use super::At;
use crate::{
    range::ANY,
    table::{Either, Table, value::Names},
};

declared! {
    /// `animation = { name = "walk", … }`: playback of animations of the model's file. They move nodes of the
    /// file with their children (meshes, lights and cameras), and deform meshes by skin joints and morph
    /// targets; everything else stays in the static BVH. A scale of 0 along all axes hides a node. A file
    /// rendered without a scene plays all of its animations once if they move different things, else the first.
    #[derive(Clone, Debug, PartialEq)]
    #[table("animation = { … }")]
    pub struct AnimationDesc {
        /// Name of an animation of the file, as `reflet info` lists them, or an array of several; `"*"` is all
        /// of them, an empty array none. Where two move the same thing, the later one wins.
        #[by(|t| t.need("name", ANY).map(|Names(names)| names))]
        pub name: Vec<At<String>>,
        /// Factor on the speed of playback: 2 is twice as fast, less than 0 plays backwards from the end.
        /// Default 1.
        pub speed: f32 = 1.0,
        /// Time of the scene at which playback begins, seconds; until then the animation holds its first pose.
        /// Less than 0 is a start before the scene's. Default 0.
        pub start_s: f32 = 0.0,
        /// How playback goes on after the end of the animation. Default `"loop"`.
        pub repeat: Playback = Playback::Loop,
    }

    /// How playback goes on after the end of an animation.
    #[words]
    pub enum Playback = Loop {
        /// holds the last pose.
        Once = "once",
        /// starts over, each animation after its own length.
        Loop = "loop",
        /// plays backwards, then forwards again, and so on.
        PingPong = "ping_pong",
    }
}

impl AnimationDesc {
    /// `animation = "walk"`, or a table.
    pub fn find(t: &mut Table) -> Option<Self> {
        t.name_or_table("animation").map(|found| match found {
            Either::Name(name) => Self::endless(vec![name]),
            Either::Nested(desc) => desc,
        })
    }

    /// Whether the animation called `name` is played.
    pub fn plays(&self, name: &str) -> bool {
        self.name.iter().any(|n| n.value == "*" || n.value == name)
    }

    /// Endless playback of the named animations from time 0, at their own speed.
    pub fn endless(name: Vec<At<String>>) -> Self {
        Self {
            name,
            speed: 1.0,
            start_s: 0.0,
            repeat: Playback::default(),
        }
    }
}
