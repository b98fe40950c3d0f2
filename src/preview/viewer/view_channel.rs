//! Channels of a frame that the preview can display.

use std::iter;

use reflet_render::picture::aov::Aov;

/// Face positions in an unfolded cube map, in faces from the top left; neighbors share an edge.
pub const CUBE_CROSS: [[u32; 2]; 6] = [[2, 1], [0, 1], [1, 0], [1, 2], [1, 1], [3, 1]];
/// Gray around a picture of another aspect ratio, 0 to 255.
pub const BACKGROUND_GRAY: u8 = 16;

/// Displayed channel of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewChannel {
    /// The finished picture.
    Picture,
    /// An AOV.
    Aov(Aov),
    /// The shadow map of a light.
    Shadow(ShadowMapChoice),
    /// Traced pixels, colored by their index in the ray list.
    Rays,
}

/// One light's shadow map, or a face of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShadowMapChoice {
    /// Index into the world's lights.
    pub light: usize,
    /// Face of a point light's cube; `None` unfolds all six.
    pub face: Option<usize>,
}

impl ViewChannel {
    /// Channels that every frame has: all but shadow maps.
    pub fn of_frames() -> impl Iterator<Item = Self> {
        let aovs = Aov::ALL.into_iter().map(Self::Aov);
        iter::once(Self::Picture).chain(aovs).chain([Self::Rays])
    }

    /// Name in menus.
    pub fn name(self) -> &'static str {
        match self {
            Self::Picture => "picture",
            Self::Aov(aov) => aov.name(),
            Self::Shadow(_) => "shadow_map",
            Self::Rays => "ray_list",
        }
    }

    /// Whether its pixels correspond to the camera's, so that a click can pick an instance.
    pub fn is_of_camera(self) -> bool {
        !matches!(self, Self::Shadow(_))
    }

    /// Whether it is an unfolded cube map.
    pub fn is_cross(self, shadow_lights: &[ShadowLight]) -> bool {
        let Self::Shadow(ShadowMapChoice { light, face: None }) = self else {
            return false;
        };
        let mut of = shadow_lights
            .iter()
            .filter(|shadow_light| shadow_light.light == light);
        of.any(|shadow_light| shadow_light.faces > 1)
    }

    /// Equivalent channel in a reloaded scene, by the light's name; the picture if it has no map now.
    pub fn after_reload(self, old: &[ShadowLight], new: &[ShadowLight]) -> Self {
        let Self::Shadow(shadow_map) = self else {
            return self;
        };
        let light = old.iter().find(|old| old.light == shadow_map.light);
        let found = light.and_then(|old| new.iter().find(|new| new.name == old.name));
        found.map_or(Self::Picture, |new| Self::Shadow(new.map(shadow_map.face)))
    }
}

/// A light with shadow maps.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShadowLight {
    /// Index into the world's lights.
    pub light: usize,
    /// Name of the light.
    pub name: String,
    /// Number of maps: six for a point light.
    pub faces: usize,
}

impl ShadowLight {
    /// Shadow map of this face, if the light has it; else its whole map.
    pub fn map(&self, face: Option<usize>) -> ShadowMapChoice {
        ShadowMapChoice {
            light: self.light,
            face: face.filter(|face| *face < self.faces),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shadow_light(light: usize, name: &str, faces: usize) -> ShadowLight {
        ShadowLight {
            light,
            name: name.to_owned(),
            faces,
        }
    }

    fn shadow(light: usize, face: Option<usize>) -> ViewChannel {
        ViewChannel::Shadow(ShadowMapChoice { light, face })
    }

    #[test]
    fn a_shadow_map_is_kept_by_the_name_of_its_light() {
        let old = [shadow_light(0, "sun", 1), shadow_light(1, "lamp", 6)];
        let new = [shadow_light(0, "lamp", 6), shadow_light(1, "moon", 1)];
        assert_eq!(
            shadow(1, Some(4)).after_reload(&old, &new),
            shadow(0, Some(4))
        );
        assert_eq!(
            shadow(0, None).after_reload(&old, &new),
            ViewChannel::Picture
        );
        let spot = [shadow_light(3, "lamp", 1)];
        assert_eq!(
            shadow(1, Some(4)).after_reload(&old, &spot),
            shadow(3, None)
        );
        assert_eq!(
            ViewChannel::Rays.after_reload(&old, &new),
            ViewChannel::Rays
        );
        assert!(shadow(1, None).is_cross(&old) && !shadow(1, None).is_cross(&new));
        assert!(!shadow(1, Some(0)).is_cross(&old));
    }
}
