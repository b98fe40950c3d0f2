//! Lights of scene text.

mod kind;

use glam::Vec3;

pub use self::kind::{BRIGHTNESS, LIGHT, LightKind, MOST_CD};
use super::{LightGroup, SceneDesc, Tracks, hierarchy::declare_parent, track::tracks};
use crate::{
    range::{ANY, FROM_0, range},
    table::{Keys, Table, color::Color},
};

declared! {
    /// How a light's shadows are found.
    #[words]
    pub enum ShadowMode = Default {
        /// `map` within a budget, the same on every adapter and for every size and number of samples: where a processor
        /// would take more than half a second to draw the maps of all such lights, a light takes `ray` if its map is
        /// expected to take twice as long as its rays in one picture of 1280 × 720 pixels; and of maps that take more
        /// than 256 MiB together, lights of which the camera sees least give theirs up. Lights with a size take `ray`.
        Default = "default",
        /// depth maps (cube maps for point lights), filtered, whatever they take; not for lights with a size. Where its
        /// light may pass something that casts a shadow, by its alpha or as glass, it is `ray`, which tells how much
        /// passes.
        Map = "map",
        /// shadow rays through the BVH that reflections use; exact, hard-edged for lights without a
        /// size, soft for lights with a size.
        Ray = "ray",
        /// no shadows; the light shines through everything.
        None = "none",
        /// `map` or `ray`, the same for all lights of a kind: whichever a cost model expects to take
        /// less time if every picture drew all shadow maps; `ray` where a texel of the map would cover
        /// more than 16 pixels of the view; `map` where nothing else traces rays. Lights with a size take
        /// `ray`.
        Auto = "auto",
    }
}

impl SceneDesc {
    /// Maximum number of lights of a scene, with the lights of files.
    pub const MOST_LIGHTS: usize = 1 << 20;
}

declared! {
    /// `[light.NAME]`: a light of one of five kinds. A white surface lit with π lux shows as 1 (white) at exposure 0.
    ///
    /// - `parent`: `name` of an instance, or of a `[group.NAME]`, to which the light is attached: its position
    ///   and directions are then relative to the parent and move with it; its size and intensity stay. Default:
    ///   none.
    #[derive(Clone, Copy, Debug, PartialEq)]
    #[table("[light.NAME]", also(LightKind), before(declare_parent), then(Self::settled))]
    pub struct LightDesc {
        /// Linear color, three numbers 0 or more, or a text as for all colors: sRGB `"#rrggbb"`, `"hsl(32, 100%, 50%)"` or
        /// `"hsv(32, 100%, 100%)"`, or `"3000 K"`, the glow of a black body of 1000 to 40000 kelvin with 1 as its largest
        /// component, and below 1900 without the negative blue that sRGB cannot show. Default white.
        pub color: Vec3 as Color [FROM_0] = Vec3::ONE,
        /// How the light's shadows are found: by a depth map or by rays. Default `"default"`.
        #[by(|t| Some(t.find("shadow", ANY).unwrap_or_default()))]
        pub shadow: ShadowMode,
        /// Edge length of the shadow map in pixels, 16 to 4096; for point lights, of each of six faces. More is
        /// sharper. The map of a directional light spans the whole scene, so large scenes need more, or `shadow
        /// = "ray"`. The largest value of a point light holds for all point lights, the largest value
        /// of any other light for all others. Without `shadow = "map"` maps have a budget, above which `shadow_px`
        /// changes nothing: 256 MiB for all, of which a point light takes 24 with 1024 and 384 with 4096. Default 1024.
        pub shadow_px: u32 [range(16.0, 4096.0)] = LightDesc::SHADOW_PX,
        /// Light group, 1 to 31 letters, digits, `-` and `_`: `--aov light:NAME` writes the light of all lights,
        /// materials and the environment of this name apart. Default "other".
        #[by(LightGroup::find)]
        pub light_group: LightGroup,
        /// Whether mirrors, glossy surfaces and glass show the light: its image, and its highlights. `false` leaves it the
        /// matte part of surfaces and fog, as for a lamp beside the picture that shall not stand in a shining floor. Default true.
        pub in_reflections: bool = true,
        /// `kind = "point" | "spot" | "directional" | "rect" | "disk"`, with the keys of that kind. Lights with
        /// a size are seen in reflections, not by the camera itself.
        #[by(Keys::read_keys)]
        pub kind: LightKind,
    }
}

impl LightDesc {
    /// Edge length of shadow maps of which a scene says none, pixels.
    pub const SHADOW_PX: u32 = 1024;

    /// White light of a kind, with the defaults of the other keys.
    pub fn new(kind: LightKind) -> Self {
        Self {
            kind,
            color: Vec3::ONE,
            shadow: ShadowMode::default(),
            shadow_px: Self::SHADOW_PX,
            light_group: LightGroup::default(),
            in_reflections: true,
        }
    }

    fn settled(mut self, t: &mut Table) -> Self {
        self.settle();
        if !self.kind.has_size() {
            return self;
        }
        if self.shadow == ShadowMode::Map {
            let message = "`shadow = \"map\"` cannot show the soft shadow of a light with a size";
            let help = "write `shadow = \"ray\"`, or leave it out";
            t.refuse("wrong-shadow", "shadow", message, help);
        }
        if matches!(self.shadow, ShadowMode::Default | ShadowMode::Auto) {
            self.shadow = ShadowMode::Ray;
        }
        self
    }

    /// Makes the numbers of a light consistent after some were set: its direction points at its target and
    /// has length 1, or 0 where there is none, and the fully lit part of its cone is no wider than the
    /// cone.
    pub fn settle(&mut self) {
        let target = self.kind.target_mut().and_then(|target| *target);
        let position = self.kind.position().unwrap_or_default();
        if let (Some(target), Some(direction)) = (target, self.kind.direction_mut()) {
            *direction = target - position;
        }
        if let LightKind::Spot {
            inner_deg,
            outer_deg,
            ..
        } = &mut self.kind
        {
            *inner_deg = inner_deg.min(*outer_deg);
        }
        if let Some(direction) = self.kind.direction_mut() {
            let unit = direction.as_dvec3().try_normalize();
            *direction = unit.map_or(Vec3::ZERO, |unit| unit.as_vec3());
        }
    }
}

declared! {
    /// `[motion.light.NAME]`: tracks that change a light; only for keys that the light's `kind` has.
    #[derive(Clone, Debug, Default, PartialEq)]
    #[table("[motion.light.NAME]", before(Self::alternatives))]
    pub struct LightMotionDesc {
        /// Tracks of the values of [`LIGHT`].
        ///
        /// - `inner_deg`: track of the angle from the middle of a spot's beam up to which it has full
        ///   brightness, degrees, 0 to `outer_deg`.
        #[by(|t| Some(tracks(t, &LIGHT)))]
        pub tracks: Tracks,
    }
}

impl LightMotionDesc {
    fn alternatives(t: &mut Table) {
        t.one_of(false, &[&["direction"], &["target"]]);
        t.one_of(false, &BRIGHTNESS.each_ref().map(std::slice::from_ref));
    }
}
