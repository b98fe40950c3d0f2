//! Camera controls: orbit, pan, dolly, look around, fly, frame; and the camera as scene text.

use std::fmt::Write as _;

use glam::{Quat, Vec2, Vec3};

use super::{Numbers, inspect::fields};
use reflet_base::math::Bounds;
use reflet_scene::{
    desc::{CAMERA, CameraDesc},
    syntax::key_text,
};

/// Minimum angle between the view direction and straight up or down, radians.
const POLE: f32 = 0.02;
/// Rotation for a drag over the picture's height, radians.
const TURN: f32 = std::f32::consts::PI;
/// Fraction of the distance to the target per notch of the wheel.
const NOTCH: f32 = 0.12;

/// Keys of cameras that moves change.
const MOVED_KEYS: [&str; 3] = ["eye", "target", "orthographic_height_m"];

/// A camera moved by the user.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraControls {
    /// Current pose and lens of the camera.
    pub camera: CameraDesc,
    /// Flying speed, meters per second.
    pub speed_m: f32,
    /// Diagonal of the scene, meters; scales speeds and distances.
    scale_m: f32,
}

impl CameraControls {
    /// Starts at a camera of a scene of this size.
    pub fn new(camera: CameraDesc, bounds: &Bounds) -> Self {
        let scale_m = scale_of(bounds);
        Self {
            camera,
            speed_m: scale_m / 8.0,
            scale_m,
        }
    }

    /// Numbers that its moves have changed since it was at `start`.
    pub fn moved_from(&self, start: &CameraDesc) -> Vec<Numbers> {
        let [before, now] = [start, &self.camera].map(|camera| fields(camera, &CAMERA));
        let is_moved =
            |number: &Numbers| MOVED_KEYS.contains(&number.key) && !before.contains(number);
        now.into_iter().filter(is_moved).collect()
    }

    /// Adopts the size of a reloaded scene; camera and speed stay.
    pub fn rescale(&mut self, bounds: &Bounds) {
        self.scale_m = scale_of(bounds);
    }

    fn forward(&self) -> Vec3 {
        (self.camera.target - self.camera.eye).normalize_or(Vec3::NEG_Z)
    }

    fn up(&self) -> Vec3 {
        self.camera.up.normalize_or(Vec3::Y)
    }

    fn right(&self) -> Vec3 {
        let forward = self.forward();
        let side = forward.cross(self.up());
        side.try_normalize()
            .unwrap_or_else(|| forward.any_orthonormal_vector())
    }

    fn distance(&self) -> f32 {
        self.camera.eye.distance(self.camera.target)
    }

    /// The view direction after turning by a drag, given as a part of the picture's height.
    fn turned(&self, drag: Vec2) -> Vec3 {
        let forward = self.forward();
        let elevation = forward.dot(self.up()).clamp(-1.0, 1.0).asin();
        let most = std::f32::consts::FRAC_PI_2 - POLE;
        let wanted = (elevation - drag.y * TURN).clamp(-most, most);
        let pitch = Quat::from_axis_angle(self.right(), wanted - elevation);
        Quat::from_axis_angle(self.up(), -drag.x * TURN) * (pitch * forward)
    }

    /// Orbits around the target.
    pub fn orbit(&mut self, drag: Vec2) {
        let forward = self.turned(drag);
        self.camera.eye = self.camera.target - forward * self.distance();
    }

    /// Looks around: turns on the spot.
    pub fn look(&mut self, drag: Vec2) {
        let forward = self.turned(drag);
        self.camera.target = self.camera.eye + forward * self.distance();
    }

    /// Pans; points at the target's distance stay under the pointer.
    pub fn pan(&mut self, drag: Vec2) {
        let right = self.right();
        let up = right.cross(self.forward());
        let height = 2.0 * self.camera.half_height_m(self.distance());
        self.shift((up * drag.y - right * drag.x) * height);
    }

    fn shift(&mut self, by: Vec3) {
        self.camera.eye += by;
        self.camera.target += by;
    }

    /// Dollies towards the target or away from it; never through it. An orthographic camera shows less or more.
    pub fn dolly(&mut self, notches: f32) {
        let factor = (-notches * NOTCH).exp();
        if let Some(height_m) = &mut self.camera.orthographic_height_m {
            let range = (self.scale_m * 1e-4, self.scale_m * 1e4);
            *height_m = (*height_m * factor).clamp(range.0, range.1);
            return;
        }
        let least = (self.scale_m * 1e-4).max(2.0 * self.near_m());
        let most = least.max(self.scale_m * 1e4);
        let distance = (self.distance() * factor).clamp(least, most);
        self.camera.eye = self.camera.target - self.forward() * distance;
    }

    /// Near plane of the camera, meters.
    fn near_m(&self) -> f32 {
        self.camera.near_in(self.scale_m / 16.0)
    }

    /// Flies for `seconds` along right, up and forward, each -1 to 1.
    pub fn fly(&mut self, direction: Vec3, seconds: f32) {
        let (right, forward) = (self.right(), self.forward());
        let along = right * direction.x + self.up() * direction.y + forward * direction.z;
        self.shift(along.normalize_or_zero() * self.speed_m * seconds);
    }

    /// Changes the flying speed by notches of the wheel.
    pub fn change_speed(&mut self, notches: f32) {
        let range = (self.scale_m * 1e-4, self.scale_m * 10.0);
        self.speed_m = (self.speed_m * (notches * 0.2).exp()).clamp(range.0, range.1);
    }

    /// Frames `bounds`: keeps the view direction and moves until all of it is visible.
    pub fn frame(&mut self, bounds: &Bounds, aspect: f32) {
        if bounds.is_empty() {
            return;
        }
        let radius = (bounds.diagonal() * 0.5).max(self.scale_m * 1e-4);
        let (forward, near_m) = (self.forward(), self.near_m());
        if let Some(height_m) = &mut self.camera.orthographic_height_m {
            *height_m = 2.2 * radius / aspect.min(1.0);
            let distance = self.distance().max(1.1 * radius + near_m);
            self.camera.target = bounds.center();
            self.camera.eye = self.camera.target - forward * distance;
            return;
        }
        let half = self.camera.fov_deg.to_radians() * 0.5;
        let narrow = half.min((half.tan() * aspect).atan());
        self.camera.target = bounds.center();
        self.camera.eye = self.camera.target - forward * (1.1 * radius / narrow.sin());
    }
}

fn scale_of(bounds: &Bounds) -> f32 {
    let diagonal = bounds.diagonal();
    if diagonal > 0.0 { diagonal } else { 1.0 }
}

/// A camera as scene text.
pub fn as_text(name: &str, camera: &CameraDesc) -> String {
    let defaults = CameraDesc::default();
    // Precision: a ten-thousandth of the distance to the target, in scenes of any size.
    let distance = camera.eye.distance(camera.target).max(1e-30);
    let decimals = (4.0 - distance.log10().floor()).clamp(4.0, 30.0) as usize;
    let mut text = format!(
        "[camera.{}]\neye = {}\ntarget = {}\n",
        key_text(name),
        vector(camera.eye, decimals),
        vector(camera.target, decimals)
    );
    // Writing to a string cannot fail.
    if camera.up != defaults.up {
        let _ = writeln!(text, "up = {}", vector(camera.up, 6));
    }
    let _ = match camera.orthographic_height_m {
        Some(height_m) => writeln!(text, "orthographic_height_m = {height_m}"),
        None => writeln!(text, "fov_deg = {}", number(camera.fov_deg, 4)),
    };
    if let Some(near_m) = camera.near_m {
        let _ = writeln!(text, "near_m = {near_m}");
    }
    let [x, y] = camera.lens_shift;
    if camera.lens_shift != defaults.lens_shift {
        let _ = writeln!(text, "lens_shift = [{x}, {y}]");
    }
    if !camera.clip_planes.is_empty() {
        let _ = writeln!(text, "clip_planes = {:?}", camera.clip_planes);
    }
    let lens = [
        ("aperture_f", camera.aperture_f),
        ("focus_m", camera.focus_m),
    ];
    for (key, value) in lens {
        if let Some(value) = value {
            let _ = writeln!(text, "{key} = {value}");
        }
    }
    text
}

fn vector(v: Vec3, decimals: usize) -> String {
    let [x, y, z] = v.to_array().map(|part| number(part, decimals));
    format!("[{x}, {y}, {z}]")
}

/// Number with this many decimals, without trailing zeros.
fn number(v: f32, decimals: usize) -> String {
    let text = format!("{v:.decimals$}");
    let text = if decimals > 0 {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        &text
    };
    if text == "-0" {
        "0".to_owned()
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use reflet_scene::stages::Scene;

    fn camera_controls() -> CameraControls {
        let bounds = Bounds {
            min: Vec3::splat(-1.0),
            max: Vec3::splat(1.0),
        };
        CameraControls::new(CameraDesc::default(), &bounds)
    }

    #[test]
    fn orbiting_keeps_the_distance_and_never_tips_over() {
        let mut nav = camera_controls();
        let distance = nav.distance();
        for i in 0..200 {
            nav.orbit(Vec2::new(0.03, if i % 70 < 40 { 0.05 } else { -0.05 }));
            assert!((nav.distance() - distance).abs() < 1e-3 * distance);
            assert!(nav.forward().dot(nav.up()).abs() < 1.0);
            assert_eq!(nav.camera.target, Vec3::ZERO);
        }
    }

    #[test]
    fn look_keeps_the_eye_and_pan_keeps_the_direction() {
        let mut nav = camera_controls();
        let eye = nav.camera.eye;
        nav.look(Vec2::new(0.25, -0.1));
        assert_eq!(nav.camera.eye, eye);
        let forward = nav.forward();
        nav.pan(Vec2::new(0.5, 0.5));
        assert!(nav.forward().distance(forward) < 1e-5 && nav.camera.eye != eye);
    }

    #[test]
    fn zoom_never_passes_the_target() {
        let mut nav = camera_controls();
        let forward = nav.forward();
        nav.dolly(1000.0);
        assert!(nav.distance() > 0.0 && nav.forward().distance(forward) < 1e-3);
        nav.dolly(-10.0);
        assert!(nav.distance() > 2.0 * nav.near_m());
        for _ in 0..1000 {
            nav.dolly(-20.0);
        }
        nav.dolly(200.0);
        assert!(nav.distance() < 1.0, "one comes back from far away");
    }

    #[test]
    fn diagonal_flight_has_the_set_speed() {
        let mut nav = camera_controls();
        let eye = nav.camera.eye;
        nav.fly(Vec3::new(1.0, 0.0, 1.0), 0.5);
        assert!((nav.camera.eye.distance(eye) - 0.5 * nav.speed_m).abs() < 1e-4);
        nav.change_speed(1e6);
        assert!(nav.speed_m.is_finite());
    }

    #[test]
    fn moved_numbers_alone_are_told() {
        let mut nav = camera_controls();
        let start = nav.camera.clone();
        assert_eq!(nav.moved_from(&start), []);
        let mut keys_after = |by: fn(&mut CameraControls)| {
            by(&mut nav);
            let moved = nav.moved_from(&start).into_iter();
            moved.map(|number| number.key).collect::<Vec<_>>()
        };
        assert_eq!(keys_after(|nav| nav.dolly(1.0)), ["eye"]);
        let pan = |nav: &mut CameraControls| nav.pan(Vec2::new(0.1, 0.0));
        assert_eq!(keys_after(pan), ["eye", "target"]);
    }

    #[test]
    fn framing_sees_all_corners() {
        let mut nav = camera_controls();
        let bounds = Bounds {
            min: Vec3::new(3.0, -2.0, 1.0),
            max: Vec3::new(4.0, 5.0, 9.0),
        };
        let half = (nav.camera.fov_deg.to_radians() * 0.5).tan();
        for aspect in [0.5, 1.0, 2.0] {
            nav.frame(&bounds, aspect);
            for i in 0..8 {
                let pick = |bit: u32| {
                    if i >> bit & 1 == 0 {
                        bounds.min
                    } else {
                        bounds.max
                    }
                };
                let corner = Vec3::new(pick(0).x, pick(1).y, pick(2).z) - nav.camera.eye;
                let depth = corner.dot(nav.forward());
                let side = corner.dot(nav.right()).abs();
                assert!(depth > 0.0 && side <= depth * half * aspect, "{aspect}");
            }
        }
    }

    #[test]
    fn orthographic_cameras_zoom_by_their_height() {
        let mut nav = camera_controls();
        nav.camera.orthographic_height_m = Some(4.0);
        let (eye, target) = (nav.camera.eye, nav.camera.target);
        nav.dolly(5.0);
        let height_m = nav
            .camera
            .orthographic_height_m
            .expect("still orthographic");
        assert!(height_m < 3.0 && nav.camera.eye == eye);
        nav.pan(Vec2::new(0.0, 1.0));
        assert!((nav.camera.target.distance(target) - height_m).abs() < 1e-4);
        let bounds = Bounds {
            min: Vec3::splat(-5.0),
            max: Vec3::splat(5.0),
        };
        nav.frame(&bounds, 0.5);
        let height_m = nav
            .camera
            .orthographic_height_m
            .expect("still orthographic");
        assert!(0.5 * height_m > bounds.diagonal());
        assert!(nav.distance() > 0.5 * bounds.diagonal());
        let text = format!("version = 1\n{}", as_text("flat", &nav.camera));
        let (desc, _) = Scene::from_text(&text, Path::new("copied.toml"), &[]).expect(&text);
        let read = desc.cameras[0].value.orthographic_height_m;
        assert_eq!(read, nav.camera.orthographic_height_m);
    }

    #[test]
    fn a_copied_camera_reads_back() {
        let mut camera = CameraDesc {
            up: Vec3::Z,
            fov_deg: 33.3333,
            near_m: Some(0.0025),
            clip_planes: vec![[0.0, -1.0, 1e-7, 2.5]],
            ..CameraDesc::default()
        };
        camera.eye = Vec3::new(-0.000_01, 12.345_67, 1e3);
        for name in ["main", "my \"best\" view", "zero\u{200b}width"] {
            let text = format!("version = 1\n{}", as_text(name, &camera));
            let (desc, _) = Scene::from_text(&text, Path::new("copied.toml"), &[]).expect(&text);
            assert_eq!(desc.cameras[0].name, name);
            let read = &desc.cameras[0].value;
            assert!(read.eye.distance(camera.eye) < 2e-4 && read.up == camera.up);
            assert!((read.fov_deg - camera.fov_deg).abs() < 1e-4);
            assert_eq!(read.near_m, camera.near_m);
            assert_eq!(read.clip_planes, camera.clip_planes);
        }
        // A view of a point a micrometer away.
        camera.target = Vec3::new(0.001, 0.002, 0.003);
        camera.eye = camera.target + Vec3::new(1e-6, 0.0, 2e-6);
        let text = format!("version = 1\n{}", as_text("near", &camera));
        let (desc, _) = Scene::from_text(&text, Path::new("copied.toml"), &[]).expect(&text);
        let read = &desc.cameras[0].value;
        assert!(read.eye.distance(camera.eye) < 1e-9 && read.target.distance(camera.target) < 1e-9);
    }
}
