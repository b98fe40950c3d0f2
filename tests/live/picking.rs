//! Picking and view channels of the preview, without a window.

use reflet_preview::viewer::{
    protocol::{FrameAction, FrameRequest, Picked, Task, Visualization},
    view_channel::{ShadowMapChoice, ViewChannel},
};

use crate::kit::*;

const MIDDLE: [f32; 2] = [0.5, 0.5];
const SKY: [f32; 2] = [0.5, 0.0];

/// A floor and a box in the middle of the picture.
fn preview() -> Option<Watched> {
    let gpu = gpu()?;
    let folder = Folder::new();
    let scene = folder.write("scene.toml", SCENE);
    let live = open(&gpu, &scene, None);
    Some(Watched::start(gpu, folder, live, false))
}

fn pick(preview: &mut Watched, at: [f32; 2]) -> Option<Picked> {
    let inspection = FrameRequest {
        view: preview.view.clone(),
        action: FrameAction::Pick(at),
    };
    preview.worker.mailbox.post(Task::Frame(inspection.into()));
    preview.until("what was clicked", |report| match report {
        Report::Picked(picked) => Some(picked.clone()),
        _ => None,
    })
}

#[test]
fn what_a_pixel_holds_is_listed() {
    let Some(mut preview) = preview() else { return };
    let at = |preview: &mut Watched, at: [f32; 2]| {
        let inspection = FrameRequest {
            view: preview.view.clone(),
            action: FrameAction::Pick(at),
        };
        preview.worker.mailbox.post(Task::Frame(inspection.into()));
        let values = preview.until("a pixel", |report| match report {
            Report::Pixel(values) => Some(values.clone()),
            _ => None,
        });
        move |name: &str| {
            let value = values.iter().find(|v| v.name == name);
            value.unwrap_or_else(|| panic!("no {name}")).text.clone()
        }
    };
    let middle = at(&mut preview, MIDDLE);
    assert!(
        middle("ids").starts_with("box, triangle "),
        "{}",
        middle("ids")
    );
    let depth = middle("depth");
    let meters: f32 = depth
        .strip_suffix(" m")
        .expect("meters")
        .parse()
        .expect("a number");
    assert!((4.0..5.3).contains(&meters), "{depth}");
    assert_eq!(middle("base_color"), "0.8999, 0.1000, 0.1000");
    assert_eq!(middle("pixel"), "12, 8");
    // The floor before the box is a mirror.
    let floor = at(&mut preview, [0.5, 0.95]);
    assert!(floor("ids").starts_with("floor, "), "{}", floor("ids"));
    assert!(!["not reflective", "rough"].contains(&floor("source").as_str()));
    let sky = at(&mut preview, SKY);
    assert_eq!(
        (sky("ids"), sky("depth")),
        ("nothing".to_owned(), "nothing".to_owned())
    );
}

/// Saves atomically: a partial scene is an error.
fn save(preview: &Watched, text: &str) {
    let temporary = preview.folder.write("next.toml", text);
    fs::rename(temporary, preview.folder.path("scene.toml")).expect("renamed");
}

/// Waits for a picture whose selection fulfills the condition.
fn selected(preview: &mut Watched, is_right: impl Fn(&Option<Picked>) -> bool) -> Option<Picked> {
    preview.until("the selection", |report| match report {
        Report::Frame(shown) => is_right(&shown.picked).then(|| shown.picked.clone()),
        _ => None,
    })
}

/// Left side of the picture with this channel.
fn drawn(preview: &mut Watched, channel: ViewChannel) -> Visualization {
    preview.show(|view| view.a.channel = channel);
    preview.until("a picture", |report| match report {
        Report::Frame(shown) => (shown.sides[0].channel == channel).then(|| shown.sides[0].clone()),
        _ => None,
    })
}

#[test]
fn a_click_selects_an_instance_that_is_followed_through_saves_by_its_name() {
    let Some(mut preview) = preview() else { return };
    let picked = pick(&mut preview, MIDDLE).expect("the box");
    assert_eq!((picked.label.as_str(), picked.triangles), ("box", Some(12)));
    assert_eq!(picked.bounds.max, Vec3::new(0.5, 1.0, 0.5));
    let outline = picked.outline.expect("is seen");
    assert_eq!(outline.size, [24, 16]);

    let moved = SCENE.replace("translation = [0, 0.5, 0]", "translation = [1, 0.5, 0]");
    save(&preview, &moved);
    let is_moved = |picked: &Option<Picked>| {
        let picked = picked.as_ref().expect("is still there");
        picked.bounds.max.x == 1.5
    };
    selected(&mut preview, is_moved);
    // An instance behind the camera stays selected.
    let away = SCENE.replace("translation = [0, 0.5, 0]", "translation = [0, 0.5, 90]");
    save(&preview, &away);
    let is_away = |picked: &Option<Picked>| {
        let picked = picked.as_ref().expect("is still there");
        picked.outline.is_none()
    };
    selected(&mut preview, is_away);
    // A second instance without a name has a number, and the first one stays selected.
    let two = format!("{SCENE}[[instance]]\nmodel = \"box\"\n");
    save(&preview, &two);
    let is_one = |picked: &Option<Picked>| {
        let picked = picked.as_ref().expect("is still there");
        picked.label == "box" && picked.outline.is_some()
    };
    selected(&mut preview, is_one);
    let other = SCENE.replace("model.box", "model.cube");
    let other = other.replace("model = \"box\"", "model = \"cube\"");
    save(&preview, &other);
    selected(&mut preview, Option::is_none);
}

#[test]
fn background_pick_and_unpick_clear_the_selection() {
    let Some(mut preview) = preview() else { return };
    assert!(pick(&mut preview, MIDDLE).is_some());
    assert!(pick(&mut preview, SKY).is_none());
    assert!(pick(&mut preview, MIDDLE).is_some());
    preview.worker.mailbox.post(Task::Unpick);
    preview.until("the end of it", |report| {
        matches!(report, Report::Unpicked).then_some(())
    });
    preview.show(|view| view.size = [32, 16]);
    selected(&mut preview, Option::is_none);
}

#[test]
fn shadow_map_legend_is_in_meters() {
    let Some(mut preview) = preview() else { return };
    let shadow = |face| ViewChannel::Shadow(ShadowMapChoice { light: 0, face });
    // The lamp hangs 4 m over the floor and 3 m over the top of the box.
    let down = drawn(&mut preview, shadow(Some(3)));
    assert_eq!(down.texture.size, [64, 64]);
    assert_eq!(
        down.legend,
        "the face to -Y; white: 3.00 m, black: 4.00 m; no surface: blue"
    );
    let up = drawn(&mut preview, shadow(Some(2)));
    assert_eq!(up.legend, "the face to +Y; no surface");
    let all = drawn(&mut preview, shadow(None));
    assert_eq!(all.texture.size, [256, 192]);
    let none = drawn(
        &mut preview,
        ViewChannel::Shadow(ShadowMapChoice {
            light: 9,
            face: None,
        }),
    );
    assert!(none.legend.ends_with("no surface"), "{}", none.legend);
}

#[test]
fn ray_list_legend_has_its_count() {
    use reflet::scene::desc::Method;
    let Some(mut preview) = preview() else { return };
    let rays = drawn(&mut preview, ViewChannel::Rays);
    assert!(rays.stats.rays > 0);
    let count = format!("{} rays start from ", rays.stats.rays);
    assert!(rays.legend.starts_with(&count), "{}", rays.legend);
    drawn(&mut preview, ViewChannel::Picture);
    preview.show(|view| view.a.method = Method::Ssr);
    let none = drawn(&mut preview, ViewChannel::Rays);
    assert!(none.legend.starts_with("no ray list"), "{}", none.legend);
}

/// The first click selects the decal on top, further clicks at the same place select things below it; where its image
/// is clear the instance is selected.
#[test]
fn a_click_selects_the_decal_that_covers_the_pixel() {
    let (gpu, folder) = (or_skip!(gpu()), Folder::new());
    let clear_above = |_, y| image::Rgba([90, 90, 200, if y < 4 { 0 } else { 255 }]);
    let image = image::RgbaImage::from_fn(8, 8, clear_above);
    image.save(folder.path("paint.png")).expect("writable");
    // The box is seen from its front, and the sticker lies on all of that.
    let text = SCENE.replace("eye = [0, 2, 5]", "eye = [0, 0.5, 5]");
    let sticker = "[material.paint]\nbase_color_texture = \"paint.png\"\n[decal.sticker]\nmaterial = \"paint\"\n\
                   translation = [0, 0.5, 0.5]\n[decal.dot]\nmaterial = \"red\"\ntranslation = [0, 0.3, 0.5]\n\
                   size = [0.5, 0.4, 0.3]\n";
    let scene = folder.write("scene.toml", format!("{text}{sticker}"));
    let live = open(&gpu, &scene, None);
    let mut preview = Watched::start(gpu, folder, live, false);
    let mut labels = |at: [f32; 2], clicks: usize| -> Vec<String> {
        let mut click = || {
            let picked = pick(&mut preview, at).expect("something is there");
            assert!(picked.outline.is_some(), "{} is seen", picked.label);
            picked.label
        };
        (0..clicks).map(|_| click()).collect()
    };
    let names = ["decal dot", "decal sticker", "box", "decal dot"];
    assert_eq!(labels([0.5, 0.54], 4), names);
    assert_eq!(labels([0.44, 0.54], 2), ["decal sticker", "box"]);
    assert_eq!(labels([0.5, 0.44], 2), ["box", "box"]);
}
