//! What of a frame can be looked at, and the menus that choose it.

use eframe::egui::{self, Ui};

use super::{
    panels::METHODS,
    protocol::{ShadowCaster, Side},
};
use crate::render::{aov::Aov, debug_readback::CUBE_FACES};

/// What of a frame is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewChannel {
    /// The finished picture.
    Picture,
    /// An intermediate one.
    Aov(Aov),
    /// The shadow map of a light.
    Shadow(ShadowMapChoice),
    /// The pixels that were traced, by their place in the list.
    Rays,
}

/// Which shadow map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShadowMapChoice {
    /// Index into the world's lights.
    pub light: usize,
    /// Face of a point light's cube; `None` unfolds all six.
    pub face: Option<usize>,
}

impl ViewChannel {
    /// Name in menus.
    pub fn name(self) -> &'static str {
        match self {
            Self::Picture => "picture",
            Self::Aov(aov) => aov.name(),
            Self::Shadow(_) => "shadow_map",
            Self::Rays => "ray_list",
        }
    }

    /// Whether its pixels are the camera's, so that a click on one means what is there.
    pub fn is_of_camera(self) -> bool {
        !matches!(self, Self::Shadow(_))
    }

    /// Whether it is a cube with all its faces.
    pub fn is_cross(self, casters: &[ShadowCaster]) -> bool {
        let Self::Shadow(ShadowMapChoice { light, face: None }) = self else {
            return false;
        };
        let mut of = casters.iter().filter(|caster| caster.light == light);
        of.any(|caster| caster.faces > 1)
    }

    /// The same in another scene, by the light's name; the picture where that has no map now.
    pub fn after(self, old: &[ShadowCaster], new: &[ShadowCaster]) -> Self {
        let Self::Shadow(cast) = self else {
            return self;
        };
        let name = old.iter().find(|c| c.light == cast.light).map(|c| &c.name);
        let found = new.iter().find(|c| Some(&c.name) == name);
        found.map_or(Self::Picture, |caster| {
            Self::Shadow(ShadowMapChoice {
                light: caster.light,
                face: cast.face.filter(|face| *face < caster.faces),
            })
        })
    }
}

/// Width of the menu of textures, points; longer names are cut off.
pub const MENU: f32 = 96.0;

/// Method and texture of one side.
pub fn side_menu(ui: &mut Ui, id: &str, side: &mut Side, casters: &[ShadowCaster]) {
    for (method, name) in METHODS {
        ui.selectable_value(&mut side.method, method, name);
    }
    egui::ComboBox::from_id_salt(id)
        .selected_text(side.look.name())
        .width(MENU)
        .truncate()
        .height(400.0)
        .show_ui(ui, |ui| textures(ui, &mut side.look, casters))
        .response
        .on_hover_text("the picture, or a texture that it was made from");
    if let ViewChannel::Shadow(cast) = &mut side.look {
        shadow_menu(ui, id, cast, casters);
    }
}

/// The list of everything that can be looked at.
fn textures(ui: &mut Ui, look: &mut ViewChannel, casters: &[ShadowCaster]) {
    let all =
        std::iter::once(ViewChannel::Picture).chain(Aov::ALL.into_iter().map(ViewChannel::Aov));
    for other in all.chain([ViewChannel::Rays]) {
        ui.selectable_value(look, other, other.name());
    }
    let is_shadow = matches!(look, ViewChannel::Shadow(_));
    let first = casters.first().map(|caster| {
        ViewChannel::Shadow(ShadowMapChoice {
            light: caster.light,
            face: None,
        })
    });
    ui.add_enabled_ui(first.is_some(), |ui| {
        let row = ui.selectable_label(is_shadow, "shadow_map");
        let row = row.on_disabled_hover_text("no light has shadow = \"map\"");
        if let (true, false, Some(first)) = (row.clicked(), is_shadow, first) {
            *look = first;
        }
    });
}

/// Which light, and which face of its cube.
fn shadow_menu(ui: &mut Ui, id: &str, cast: &mut ShadowMapChoice, casters: &[ShadowCaster]) {
    let now = casters.iter().find(|caster| caster.light == cast.light);
    let label = ui.weak("of");
    let menu = egui::ComboBox::from_id_salt((id, "light"))
        .selected_text(now.map_or("?", |caster| &caster.name))
        .show_ui(ui, |ui| {
            for caster in casters {
                let is_now = caster.light == cast.light;
                if ui.selectable_label(is_now, &caster.name).clicked() {
                    *cast = ShadowMapChoice {
                        light: caster.light,
                        face: cast.face.filter(|face| *face < caster.faces),
                    };
                }
            }
        });
    menu.response.labelled_by(label.id);
    if now.is_some_and(|caster| caster.faces > 1) {
        let label = ui.weak("face");
        let menu = egui::ComboBox::from_id_salt((id, "face"))
            .selected_text(cast.face.map_or("all", |face| CUBE_FACES[face]))
            .width(48.0)
            .show_ui(ui, |ui| {
                ui.selectable_value(&mut cast.face, None, "all");
                for (face, name) in CUBE_FACES.into_iter().enumerate() {
                    ui.selectable_value(&mut cast.face, Some(face), name);
                }
            });
        menu.response.labelled_by(label.id);
    }
}

#[cfg(test)]
mod tests {
    use eframe::egui::accesskit::Role;
    use egui_kittest::{Harness, kittest::Queryable as _};

    use super::*;
    use crate::scene::desc::Method;

    fn caster(light: usize, name: &str, faces: usize) -> ShadowCaster {
        ShadowCaster {
            light,
            name: name.to_owned(),
            faces,
        }
    }

    fn shadow(light: usize, face: Option<usize>) -> ViewChannel {
        ViewChannel::Shadow(ShadowMapChoice { light, face })
    }

    fn harness<'a>(casters: Vec<ShadowCaster>) -> Harness<'a, Side> {
        let side = Side {
            method: Method::Hybrid,
            look: ViewChannel::Picture,
        };
        Harness::builder()
            .with_size(egui::vec2(900.0, 600.0))
            .build_ui_state(
                move |ui, side| {
                    ui.horizontal(|ui| side_menu(ui, "texture", side, &casters));
                },
                side,
            )
    }

    /// Chooses an entry of one of the menus, from the left.
    fn choose(harness: &mut Harness<'_, Side>, menu: usize, entry: &str) {
        let mut menus = harness.get_all_by_role(Role::ComboBox);
        menus.nth(menu).expect("a menu").click();
        drop(menus);
        harness.run();
        let row = harness.get_all_by_label(entry).last();
        row.expect("listed").click();
        harness.run();
    }

    #[test]
    fn shadow_maps_are_chosen_by_light_and_face() {
        let mut harness = harness(vec![caster(0, "sun", 1), caster(2, "lamp", 6)]);
        choose(&mut harness, 0, "shadow_map");
        assert_eq!(harness.state().look, shadow(0, None));
        assert!(harness.query_by_label("face").is_none(), "the sun has one");
        choose(&mut harness, 1, "lamp");
        choose(&mut harness, 2, "-Y");
        assert_eq!(harness.state().look, shadow(2, Some(3)));
        choose(&mut harness, 1, "sun");
        assert_eq!(harness.state().look, shadow(0, None));
        choose(&mut harness, 0, "ray_list");
        assert_eq!(harness.state().look, ViewChannel::Rays);
    }

    #[test]
    fn without_maps_there_is_nothing_to_choose() {
        let mut harness = harness(Vec::new());
        choose(&mut harness, 0, "shadow_map");
        assert_eq!(harness.state().look, ViewChannel::Picture);
    }

    #[test]
    fn a_shadow_map_is_kept_by_the_name_of_its_light() {
        let old = [caster(0, "sun", 1), caster(1, "lamp", 6)];
        let new = [caster(0, "lamp", 6), caster(1, "moon", 1)];
        assert_eq!(shadow(1, Some(4)).after(&old, &new), shadow(0, Some(4)));
        assert_eq!(shadow(0, None).after(&old, &new), ViewChannel::Picture);
        let spot = [caster(3, "lamp", 1)];
        assert_eq!(shadow(1, Some(4)).after(&old, &spot), shadow(3, None));
        assert_eq!(ViewChannel::Rays.after(&old, &new), ViewChannel::Rays);
        assert!(shadow(1, None).is_cross(&old) && !shadow(1, None).is_cross(&new));
        assert!(!shadow(1, Some(0)).is_cross(&old));
    }
}
