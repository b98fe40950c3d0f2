//! `--light` and `--turntable`: light and a way of the camera in place of a scene's own, as overrides of its text.

use std::{
    f32::consts::TAU,
    io,
    path::{Path, PathBuf},
    str::FromStr,
    time::Duration,
};

use glam::{Vec2, Vec3, Vec3Swizzles as _};

use super::error::AppError;
use crate::{
    files::folder_of,
    math::Bounds,
    runtime::{
        model_viewer_scene::{sky, sun},
        scene_text::LoadedScene,
    },
    scene::{
        desc::{CameraDesc, FRAMES, TimelineDesc, is_panorama},
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
/// Maximum sine of the angle at which the camera looks down or up.
const MOST_RISE: f32 = 0.866;
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
    /// Values that take the place of a scene's lights, their motion and environment, and the folder of assets that they
    /// need; `assets` are the other folders.
    ///
    /// # Errors
    /// [`AppError::Usage`] for a panorama that is not there.
    pub fn overrides(
        &self,
        assets: &[PathBuf],
        scene: Option<&Path>,
    ) -> Result<([String; 3], Option<PathBuf>), AppError> {
        let mut needed = None;
        let [light, environment] = match self {
            Self::Outdoor => {
                let [sun, sky] = [sun(false), sky()].map(|part| value_text(&part));
                [
                    format!("light={{ sun = {sun} }}"),
                    format!("environment={sky}"),
                ]
            }
            Self::Studio => STUDIO.map(str::to_owned),
            Self::Panorama(path) => {
                let (folder, name) = reached(path, assets, scene)?;
                needed = Some(folder);
                let file = value_text(&Content::from(&*name.to_string_lossy()));
                [
                    "light={}".to_owned(),
                    format!("environment={{ file = {file} }}"),
                ]
            }
        };
        Ok(([light, "motion.light={}".to_owned(), environment], needed))
    }
}

/// A folder above the panorama, and its path below that: as short as no file of the scene's own folder, or of a given
/// one, stands at the same path.
fn reached(
    path: &Path,
    assets: &[PathBuf],
    scene: Option<&Path>,
) -> Result<(PathBuf, PathBuf), AppError> {
    let refuse = |error| {
        let help = "write outdoor, studio, or the path of a panorama from the current folder";
        AppError::Usage(format!("--light {}: {error}; {help}", path.display()))
    };
    let whole = path.canonicalize().map_err(refuse)?;
    let own = folder_of(scene.unwrap_or(Path::new(""))).to_owned();
    let folders = || assets.iter().chain([&own]);
    for folder in whole.ancestors().skip(1) {
        let name = whole.strip_prefix(folder).unwrap_or(&whole);
        let is_other = |found: PathBuf| found.canonicalize().is_ok_and(|found| found != whole);
        if !folders().any(|given| is_other(given.join(name))) {
            return Ok((folder.to_owned(), name.to_owned()));
        }
    }
    Err(refuse(io::ErrorKind::AlreadyExists.into()))
}

/// Values of a scene that turn the camera [`TURNTABLE`] once around everything that its first frame shows, about a
/// vertical axis, from the side of its main camera, on a timeline of this length.
///
/// # Errors
/// [`AppError::Usage`] for a scene that shows nothing, or farther than numbers reach, and for more frames than a timeline has.
pub fn turntable(loaded: &LoadedScene, time: Duration) -> Result<[String; 3], AppError> {
    let refuse = |text: String| Err(AppError::Usage(format!("--turntable: {text}")));
    let world = loaded.first_frame();
    let shown = world.instances.iter().filter(|i| i.shown.visible);
    let bounds = shown.fold(Bounds::EMPTY, |all, i| all.union(world.bounds_of(i)));
    if bounds.is_empty() || !bounds.diagonal().is_finite() {
        return refuse(format!("{} shows nothing to go around", loaded.name));
    }
    let defaults = CameraDesc::default();
    let main = world.cameras.get(world.main_camera());
    let eye = main.map_or(defaults.eye, |camera| camera.value.eye);
    let center = bounds.center();
    let across = (eye - center)
        .with_y(0.0)
        .try_normalize()
        .unwrap_or(Vec3::Z);
    let rise = (eye - center)
        .normalize_or_zero()
        .y
        .clamp(-MOST_RISE, MOST_RISE);
    let run = (1.0 - rise * rise).sqrt();
    let to_eye = across * run + Vec3::Y * rise;
    let [width, height] = loaded.scene.image.size.map(|px| px as f32);
    let half_height = (defaults.fov_deg.to_radians() * 0.5).tan() * FILLED;
    let half = Vec2::new(half_height * width / height, half_height);
    let size = (bounds.max - bounds.min) * 0.5;
    // Corners of the box around everything, which turn before the camera.
    let corners = (0..ANGLES).flat_map(|i| {
        let turned = Vec2::from_angle(TAU * i as f32 / ANGLES as f32) * size.xz().length();
        [-size.y, size.y].map(|y| Vec3::new(turned.x, y, turned.y))
    });
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
    let end = f64::from(start) + (f64::from(seconds) * f64::from(fps)).round().max(1.0) - 1.0;
    if end > FRAMES.max {
        return refuse(format!(
            "{seconds} s are more than the {} frames of a timeline",
            FRAMES.max
        ));
    }
    Ok([
        format!("camera.{TURNTABLE}={{ eye = {eye}, target = {target} }}"),
        format!(
            "motion.camera.{TURNTABLE}={{ eye = {{ orbit = {{ center = {target}, period_s = {seconds} }} }} }}"
        ),
        format!("timeline={{ fps = {fps}, start = {start}, end = {end} }}"),
    ])
}
