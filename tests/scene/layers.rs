//! Scenes over their bases, and variants.

use reflet::scene::{
    desc::{BevelDesc, LightKind, ModelSource, PlacementDesc, ShapeDesc},
    parse::ReadOptions,
};

use crate::kit::*;

pub use crate::common::folder::Folder;

impl Folder {
    /// Reads `shot/scene.toml`, with assets in `library`.
    pub fn read(&self, variants: &[&str], set: &[&str]) -> Result<Scene, String> {
        let path = self.0.join("shot/scene.toml");
        let text = fs::read_to_string(&path).expect("it is there");
        let owned = |list: &[&str]| list.iter().map(|s| (*s).to_owned()).collect();
        let options = ReadOptions {
            overrides: owned(set),
            variants: owned(variants),
            border: vec![self.0.join("library")].into(),
            ..ReadOptions::default()
        };
        let read = Scene::from_text_traced(&text, &path, &options, &Dependencies::default());
        let folder = format!("{}/", self.0.display());
        let shown = |all: &[_]| render_all(all, false).replace(&folder, "");
        match read {
            Ok((scene, warnings)) => {
                assert!(warnings.is_empty(), "{}", shown(&warnings));
                Ok(scene)
            }
            Err(errors) => Err(shown(&errors)),
        }
    }

    #[track_caller]
    pub fn expect(&self) -> Scene {
        or_panic!(self.read(&[], &[]))
    }

    /// Asserts that the first frame fails with this message.
    #[track_caller]
    pub fn assert_frame(&self, says: &str) {
        let scene = self.expect();
        let errors = scene.pose(0).expect_err("it is wrong");
        let said = format!("{}; {:?}", errors[0].message, errors[0].help);
        assert!(said.contains(says), "{said}");
    }

    /// Asserts that the errors contain each of these texts.
    #[track_caller]
    pub fn assert_says(&self, variants: &[&str], says: &[&str]) {
        let errors = self.read(variants, &[]).expect_err("it is wrong");
        for part in says {
            assert!(errors.contains(part), "no {part:?} in\n{errors}");
        }
    }
}

pub const BASE: &str = include_str!("layers/base.toml");

pub fn over_base(shot: &str) -> Folder {
    let shot = format!("version = 1\nbase = \"base.toml\"\n{shot}");
    Folder::with(&[("shot/base.toml", BASE), ("shot/scene.toml", &shot)])
}

#[test]
fn keys_above_win_and_all_others_stay() {
    let folder = over_base(
        "[camera.main]\nfov_deg = 20\n[[instance]]\nname = \"a\"\nmatrix = [1,0,0,0, 0,1,0,0, \
         0,0,1,0, 5,6,7,1]\n[[instance]]\nname = \"c\"\nmodel = \"ball\"\n[model.ball]\n\
         shape = { kind = \"box\" }\n[light.lamp]\ndirection = [1, 0, 0]\n",
    );
    let scene = folder.expect();
    let camera = &scene.cameras[0].value;
    assert_eq!(
        (camera.fov_deg, camera.eye),
        (20.0, Vec3::new(0.0, 1.0, 5.0))
    );
    let names: Vec<_> = scene
        .instances
        .iter()
        .filter_map(|i| i.name.as_deref())
        .collect();
    assert_eq!(names, ["a", "b", "c"]);
    // A key of the upper layer removes keys of the base that exclude it: `translation`, the radius, `target`.
    assert!(matches!(
        scene.instances[0].placement,
        PlacementDesc::Matrix(_)
    ));
    let ball = &scene.models[0].value;
    let (size, bevel) = (Vec3::ONE, BevelDesc::default());
    assert_eq!(
        ball.source,
        ModelSource::Shape(ShapeDesc::Box { size, bevel })
    );
    let material = ball.material.as_ref().expect("a material");
    assert_eq!(material.value, "red");
    let lamp = scene
        .lights
        .iter()
        .find(|l| l.name == "lamp")
        .expect("it stays");
    match lamp.value.kind {
        LightKind::Spot {
            direction,
            target,
            intensity_cd,
            ..
        } => {
            assert_eq!((direction, target, intensity_cd), (Vec3::X, None, 9.0));
        }
        other => panic!("{other:?}"),
    }
    assert!(
        scene.text_files()[0].ends_with("base.toml"),
        "bases are followed"
    );
}

/// Names of elements that equal keys exclude nothing.
#[test]
fn names_may_be_like_keys() {
    let base =
        "version = 1\n[model.file]\nshape = { kind = \"box\" }\n[camera.target]\nfov_deg = 20\n";
    let shot = "version = 1\nbase = \"base.toml\"\n[model.shape]\nshape = { kind = \"cone\" }\n\
                [camera.direction]\nfov_deg = 30\n[variant.v.model.file]\nshape = { kind = \"sphere\" }\n";
    let folder = Folder::with(&[("shot/base.toml", base), ("shot/scene.toml", shot)]);
    let scene = or_panic!(folder.read(&["v"], &[]));
    assert_eq!((scene.models.len(), scene.cameras.len()), (2, 2));
}

#[test]
fn mistakes_are_placed_in_the_file_that_has_them() {
    let folder = over_base(
        "[camera.main]\nfov_deg = 900\n[material.red]\nbase_color = [2, 0, 0]\n[light.sun]\n\
         kind = \"point\"\n",
    );
    folder.assert_says(
        &[],
        &[
            "--> shot/scene.toml:4:11",
            "--> shot/scene.toml:6:15",
            // A light of another kind keeps nothing of the base's light.
            "`position` is missing in `[light.sun]`\n --> shot/scene.toml:7:1",
        ],
    );
    let folder = over_base("[[instance]]\nmodel = \"bal\"\n");
    folder.assert_says(&[], &["--> shot/scene.toml:4:9", "--> shot/base.toml:7:8"]);
}

#[test]
fn what_is_removed_is_gone() {
    let folder =
        over_base("remove = [\"light.lamp\", \"instance.a\", \"material.red.base_color\"]\n");
    let scene = folder.expect();
    assert_eq!(scene.lights.len(), 1);
    assert_eq!(scene.instances.len(), 1);
    assert_eq!(scene.materials[0].value.base_color, None);
    // A model without an instance is not placed at the origin either.
    let all = "remove = [\"instance.a\", \"instance.b\"]\n";
    assert!(over_base(all).expect().models.is_empty());
    for (shot, says) in cases(include_str!("layers/what_is_removed_is_gone.txt")) {
        over_base(&format!("{shot}\n")).assert_says(&[], &says.split(" | ").collect::<Vec<_>>());
    }
    let alone = Folder::with(&[("shot/scene.toml", "version = 1\nremove = \"a\"\n")]);
    alone.assert_says(
        &[],
        &["there is no base of which something could be removed"],
    );
}

#[test]
fn circles_missing_bases_and_too_many_are_named() {
    let circle = Folder::with(&[
        ("shot/scene.toml", "version = 1\nbase = \"b.toml\"\n"),
        ("shot/b.toml", "version = 1\nbase = \"scene.toml\"\n"),
    ]);
    circle.assert_says(
        &[],
        &["\"scene.toml\" is its own base", "--> shot/b.toml:2:8"],
    );
    let missing = Folder::with(&[("shot/scene.toml", "version = 1\nbase = \"no.toml\"\n")]);
    missing.assert_says(
        &[],
        &["does not exist, nor in", "library", "scene.toml:2:8"],
    );
    let outside = Folder::with(&[("shot/scene.toml", "version = 1\nbase = \"../b.toml\"\n")]);
    outside.assert_says(&[], &["is not below the scene's folder"]);
    let number = Folder::with(&[("shot/scene.toml", "version = 1\nbase = 3\n")]);
    number.assert_says(&[], &["`base` must be text in quotes, not the number 3"]);
    let base = |i: u32| format!("version = 1\nbase = \"{}.toml\"\n", i + 1);
    let texts: Vec<_> = (0..200)
        .map(|i| (format!("library/{i}.toml"), base(i)))
        .collect();
    let mut files: Vec<_> = texts
        .iter()
        .map(|(n, t)| (n.as_str(), t.as_str()))
        .collect();
    files.push(("shot/scene.toml", "version = 1\nbase = \"0.toml\"\n"));
    let many = Folder::with(&files);
    let message = "a chain of bases may have at most 100 files";
    many.assert_says(&[], &[message, "library/99.toml:2:8"]);
}

#[test]
fn a_library_holds_bases_included_files_and_scripts() {
    let base = "version = 1\ninclude = \"looks/red.toml\"\nscript = \"move.rhai\"\n\
                timeline = { end = 1 }\n\
                [model.ball]\nshape = { kind = \"sphere\" }\nmaterial = \"red\"\n";
    let folder = Folder::with(&[
        ("library/base.toml", base),
        (
            "library/looks/red.toml",
            "[material.red]\nroughness = 0.3\n",
        ),
        (
            "library/move.rhai",
            "import \"more\" as more;\nfn frame(ctx) { }\n",
        ),
        ("library/more.rhai", "fn x() { }\n"),
        (
            "shot/scene.toml",
            "version = 1\nbase = \"base.toml\"\n[material.red]\nmetallic = 1\n",
        ),
    ]);
    let scene = folder.expect();
    let red = &scene.materials[0].value;
    assert_eq!((red.roughness, red.metallic), (Some(0.3), Some(1.0)));
    assert_eq!(scene.text_files().len(), 4);
    let inner = Folder::with(&[
        ("shot/scene.toml", "version = 1\ninclude = \"a.toml\"\n"),
        ("shot/a.toml", "base = \"b.toml\"\n"),
    ]);
    inner.assert_says(
        &[],
        &["an included file cannot have `base`", "shot/a.toml:1:1"],
    );
}

#[test]
fn variants_are_laid_over_the_scene() {
    let shot =
        "[variant.night]\nenvironment.color = \"#000010\"\n[variant.bad]\nlight.sun.kind = 3\n";
    let folder = over_base(shot);
    let lux = |scene: &Scene| {
        let sun = scene
            .lights
            .iter()
            .find(|l| l.name == "sun")
            .expect("it stays");
        sun.value.kind.intensity()
    };
    let plain = folder.expect();
    let names: Vec<_> = plain.variants.iter().map(|v| v.value.as_str()).collect();
    assert_eq!((lux(&plain), names), (2.0, vec!["bad", "night", "dusk"]));
    let night = folder.read(&["night"], &[]).expect("it is right");
    assert_eq!(lux(&night), 0.1);
    assert!(night.environment.zenith.z > 0.0 && night.environment.zenith.x == 0.0);
    let both = folder.read(&["night", "dusk"], &[]).expect("it is right");
    assert_eq!((lux(&both), both.lights.len()), (0.5, 1));
    assert_eq!(both.environment.zenith, Vec3::new(1.0, 0.5, 0.0));
    let set = folder
        .read(&["dusk"], &["light.sun.intensity_lux=7"])
        .expect("it is right");
    assert_eq!(lux(&set), 7.0, "values are set last");
    folder.assert_says(
        &["nihgt"],
        &["no variant is named \"nihgt\"", "did you mean \"night\"?"],
    );
    folder.assert_says(&["bad"], &["`kind` must be", "shot/scene.toml:6:18"]);
    let wrong = over_base("variant = 3\n");
    wrong.assert_says(&[], &["`variant` must be"]);
    let layered = over_base("[variant.v]\nbase = \"b.toml\"\n");
    layered.assert_says(&["v"], &["a variant cannot have `base`"]);
}
