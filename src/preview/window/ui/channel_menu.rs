//! The menus that choose what one side of the picture shows.

use eframe::egui::{self, Ui};

use crate::{
    viewer::{
        protocol::Side,
        view_channel::{ShadowLight, ShadowMapChoice, ViewChannel},
    },
    write_back::presses::{FIRST_METHODS, rivals},
};
use reflet_render::lighting::lights::CUBE_FACES;
use reflet_scene::desc::Method;

/// Width of a menu, points; longer names are truncated.
pub const MENU: f32 = 88.0;

/// Method and channel of one side.
pub fn side_menu(ui: &mut Ui, id: &str, side: &mut Side, shadow_lights: &[ShadowLight]) {
    let auto = ui.selectable_value(&mut side.method, Method::Auto, Method::Auto.name());
    auto.on_hover_text("rt, as in render");
    for method in FIRST_METHODS {
        ui.selectable_value(&mut side.method, method, method.name());
    }
    let is_rival = rivals().any(|method| method == side.method);
    egui::ComboBox::from_id_salt((id, "others"))
        .selected_text(if is_rival {
            side.method.name()
        } else {
            "others"
        })
        .width(MENU)
        .truncate()
        .show_ui(ui, |ui| {
            for method in rivals() {
                ui.selectable_value(&mut side.method, method, method.name());
            }
        })
        .response
        .on_hover_text("methods to be compared with");
    egui::ComboBox::from_id_salt(id)
        .selected_text(side.channel.name())
        .width(MENU)
        .truncate()
        .height(400.0)
        .show_ui(ui, |ui| channels(ui, &mut side.channel, shadow_lights))
        .response
        .on_hover_text("the picture, or a texture that it was made from");
    if let ViewChannel::Shadow(shadow_map) = &mut side.channel {
        shadow_menu(ui, id, shadow_map, shadow_lights);
    }
}

/// The list of channels.
fn channels(ui: &mut Ui, channel: &mut ViewChannel, shadow_lights: &[ShadowLight]) {
    for other in ViewChannel::of_frames() {
        ui.selectable_value(channel, other, other.name());
    }
    let is_shadow = matches!(channel, ViewChannel::Shadow(_));
    let first = shadow_lights.first();
    ui.add_enabled_ui(first.is_some(), |ui| {
        let row = ui.selectable_label(is_shadow, "shadow_map");
        let row = row.on_disabled_hover_text("no light has shadow = \"map\"");
        if let (true, false, Some(first)) = (row.clicked(), is_shadow, first) {
            *channel = ViewChannel::Shadow(first.map(None));
        }
    });
}

/// Menus of the light whose shadow map is shown, and of the face of its cube.
fn shadow_menu(
    ui: &mut Ui,
    id: &str,
    shadow_map: &mut ShadowMapChoice,
    shadow_lights: &[ShadowLight],
) {
    let now = shadow_lights
        .iter()
        .find(|shadow_light| shadow_light.light == shadow_map.light);
    let label = ui.weak("of");
    let menu = egui::ComboBox::from_id_salt((id, "light"))
        .selected_text(now.map_or("?", |shadow_light| &shadow_light.name))
        .show_ui(ui, |ui| {
            for shadow_light in shadow_lights {
                let is_now = shadow_light.light == shadow_map.light;
                if ui.selectable_label(is_now, &shadow_light.name).clicked() {
                    *shadow_map = shadow_light.map(shadow_map.face);
                }
            }
        });
    menu.response.labelled_by(label.id);
    if now.is_some_and(|shadow_light| shadow_light.faces > 1) {
        let label = ui.weak("face");
        let menu = egui::ComboBox::from_id_salt((id, "face"))
            .selected_text(shadow_map.face.map_or("all", |face| CUBE_FACES[face]))
            .width(48.0)
            .show_ui(ui, |ui| {
                ui.selectable_value(&mut shadow_map.face, None, "all");
                for (face, name) in CUBE_FACES.into_iter().enumerate() {
                    ui.selectable_value(&mut shadow_map.face, Some(face), name);
                }
            });
        menu.response.labelled_by(label.id);
    }
}
