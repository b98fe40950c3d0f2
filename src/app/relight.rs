//! `--light` and `--turntable`: light and a way of the camera in place of a scene's own, as overrides of its text.

use std::{
    f32::consts::TAU,
    path::{Path, PathBuf},
    str::FromStr,
    time::Duration,
};

use glam::{Vec2, Vec3, Vec3Swizzles as _};

use crate::{
    files::folder_of,
    runtime::{
        model_viewer_scene::{sky, sun},
        scene_text::LoadedScene,
    },
    scene::{
        desc::{CameraDesc, TimelineDesc, is_panorama},
        syntax::{Content, value_text},
    },
};

/// Camera that goes around the scene.
pub const TURNTABLE: &str = "turntable";
/// Lamps of a studio, with walls that are bright above.
const STUDIO: [&str; 2] = [
    "light={ \
     key = { kind = 'directional', direction = [0.8, -0.8, -0.8], intensity_lux = 3, angle_deg = 20 }, \
     fill = { kind = 'directional', direction = [-1, -0.2, -0.6], intensity_lux = 0.6, angle_deg = 40 }, \
     rim = { kind = 'directional', direction = [0.4, -0.8, 1], intensity_lux = 2, angle_deg = 15 } }",
    "environment={ zenith = [0.5, 0.5, 0.5], horizon = [0.3, 0.3, 0.3], ground = [0.12, 0.12, 0.12] }",
];
/// Fraction of the picture's width or height that the scene fills where it is widest.
const FILLED: f32 = 0.9;
/// Number of angles at which the camera looks at the whole scene.
const ANGLES: u32 = 64;

/// Light of `--light`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Light {
    /// Sun and sky.
    Outdoor,
    /// Three large lamps before gray walls.
    Studio,
    /// A panorama image.
    Panorama(PathBuf),
}

impl FromStr for Light {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "outdoor" => Ok(Self::Outdoor),
            "studio" => Ok(Self::Studio),
            path if is_panorama(Path::new(path)) => Ok(Self::Panorama(path.into())),
            _ => Err("expected outdoor, studio, or a panorama (.hdr or .exr)".to_owned()),
        }
    }
}

impl Light {
    /// Values of a scene that take the place of its lights and environment.
    pub fn overrides(&self) -> [String; 2] {
        match self {
            Self::Outdoor => {
                let [sun, sky] = [sun(false), sky()].map(|part| value_text(&part));
                [
                    format!("light={{ sun = {sun} }}"),
                    format!("environment={sky}"),
                ]
            }
            Self::Studio => STUDIO.map(str::to_owned),
            Self::Panorama(path) => {
                let name = path.file_name().unwrap_or_default().to_string_lossy();
                let file = value_text(&Content::from(&*name));
                [
                    "light={}".to_owned(),
                    format!("environment={{ file = {file} }}"),
                ]
            }
        }
    }

    /// Folder of its image.
    pub fn folder(&self) -> Option<PathBuf> {
        match self {
            Self::Panorama(path) => Some(folder_of(path).to_owned()),
            Self::Outdoor | Self::Studio => None,
        }
    }
}

/// Values of a scene that turn the camera [`TURNTABLE`] once around everything in it, about a vertical axis, from where
/// its first camera stands, on a timeline of this length.
pub fn turntable(loaded: &LoadedScene, time: Duration) -> [String; 3] {
    let world = loaded.first_frame();
    let bounds = world.bounds();
    let defaults = CameraDesc::default();
    let from = world
        .cameras
        .first()
        .map_or(&defaults, |camera| &camera.value);
    let center = bounds.center();
    let to_eye = (from.eye - center).try_normalize().unwrap_or(Vec3::Z);
    let [width, height] = loaded.scene.image.size.map(|px| px as f32);
    let half_height = (defaults.fov_deg.to_radians() * 0.5).tan() * FILLED;
    let half = Vec2::new(half_height * width / height, half_height);
    let size = (bounds.max - bounds.min) * 0.5;
    // Corners of the box around everything, which turn before the camera.
    let corners = (0..ANGLES).flat_map(|i| {
        let turned = Vec2::from_angle(TAU * i as f32 / ANGLES as f32) * size.xz().length();
        [-size.y, size.y].map(|y| Vec3::new(turned.x, y, turned.y))
    });
    let (rise, run) = (to_eye.y, to_eye.xz().length());
    let distances = corners.map(|p| {
        let up = p.y * run - p.z * rise;
        p.z * run + p.y * rise + (p.x.abs() / half.x).max(up.abs() / half.y)
    });
    let distance = distances.fold(0.0, f32::max);
    let text = |v: Vec3| format!("[{}, {}, {}]", v.x, v.y, v.z);
    let [eye, target] = [center + to_eye * distance, center].map(text);
    let timeline = loaded.scene.timeline.clone();
    let TimelineDesc { fps, start, .. } = timeline.unwrap_or(TimelineDesc {
        fps: 24.0,
        start: 0,
        end: 0,
    });
    let seconds = time.as_secs_f32();
    // The frame after the last one is the first one again.
    let end = start + ((seconds * fps).round() as u32).max(1) - 1;
    [
        format!("camera.{TURNTABLE}={{ eye = {eye}, target = {target} }}"),
        format!(
            "motion.camera.{TURNTABLE}={{ eye = {{ orbit = {{ center = {target}, period_s = {seconds} }} }} }}"
        ),
        format!("timeline={{ fps = {fps}, start = {start}, end = {end} }}"),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lights_are_words_or_panoramas() {
        assert_eq!("studio".parse(), Ok(Light::Studio));
        assert_eq!("a/b.HDR".parse(), Ok(Light::Panorama("a/b.HDR".into())));
        assert!(
            "sunset"
                .parse::<Light>()
                .is_err_and(|text| text.contains(".hdr"))
        );
    }
}
