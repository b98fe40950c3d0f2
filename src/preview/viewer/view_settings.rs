//! Choices of a viewer: methods and channels of both sides, the camera, the selected material.

use super::{protocol::Side, view_channel::ViewChannel};
use crate::write_back::outline::LeftOut;
use reflet_scene::desc::Method;

/// User settings of the view.
#[derive(Clone, Debug)]
pub struct ViewSettings {
    /// The left side.
    pub a: Side,
    /// The right side.
    pub b: Side,
    /// Whether the wipe is on.
    pub wipe: bool,
    /// Position of the wipe line, 0 to 1.
    pub wipe_at: f32,
    /// Index of the selected material.
    pub material: Option<usize>,
    /// Whether to scroll to its values.
    pub scrolls_to_material: bool,
    /// Index of the scene's camera in use; `None` for the free camera.
    pub scene_camera: Option<usize>,
    /// Index of the scene's camera that was used last.
    pub last_camera: usize,
    /// Whether the cuts of the timeline choose the scene's camera.
    pub follows_cuts: bool,
    /// Whether the frame of the image is shown, with its safe area.
    pub image_frame: bool,
    /// Method of the displayed left side, also where its setting is `auto`.
    pub shown_method: Option<Method>,
    /// Whether the list of keys is open.
    pub help: bool,
    /// Whether the error map is shown in place of the picture.
    pub error_map: bool,
    /// Things that are left out of the view.
    pub left_out: LeftOut,
    /// Sub-frames of a picture in place of the scene's number.
    pub samples: Option<u32>,
    /// Whether pictures at rest are denoised; `None` without a denoiser.
    pub denoises: Option<bool>,
}

impl ViewSettings {
    /// Initial settings: the picture by one method.
    pub fn new(method: Method) -> Self {
        let side = |method| Side {
            method,
            channel: ViewChannel::Picture,
        };
        Self {
            a: side(method),
            b: side(other_than(method)),
            wipe: false,
            wipe_at: 0.5,
            material: None,
            scrolls_to_material: false,
            scene_camera: None,
            last_camera: 0,
            follows_cuts: true,
            image_frame: false,
            shown_method: None,
            help: false,
            error_map: false,
            left_out: LeftOut::default(),
            samples: None,
            denoises: None,
        }
    }
}

impl ViewSettings {
    /// Gives the right side of a wipe that begins another method, if both sides would show the same.
    pub fn start_wipe(&mut self) {
        let method = |method| match method {
            Method::Auto => self.shown_method.unwrap_or(Method::Rt),
            method => method,
        };
        let [a, b] = [self.a, self.b].map(|side| (method(side.method), side.channel));
        if self.wipe && a == b {
            self.b.method = other_than(a.0);
        }
    }
}

/// Method with which another one is compared first.
fn other_than(method: Method) -> Method {
    match method {
        Method::Rt => Method::Hybrid,
        _ => Method::Rt,
    }
}
