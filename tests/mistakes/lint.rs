//! Lint warnings of `check`: allowed text that is hardly intended.

use std::{
    fs,
    io::Write as _,
    process::{Command, Stdio},
};

use super::{Mistake, check_group, folder, place, results, script, text};

/// A scene with a lit floor; text inserted before it moves its lines down.
macro_rules! scene {
    ($rest:literal) => {
        concat!(
            $rest,
            "[camera.main]\neye = [0, 2, 6]\ntarget = [0, 0.5, 0]\n",
            "[model.floor]\nshape = { kind = \"plane\", size = [8, 8] }\n",
        )
    };
}

pub const LINTS: &[Mistake] = &[
    text(
        "a light's color in bytes",
        scene!(
            "[light.lamp]\nkind = \"directional\"\ndirection = [0, -1, 0]\nintensity_lux = 3\n\
             color = [255, 200, 100]\n"
        ),
        [
            "bytes-as-color",
            "6:9",
            "[255, 200, 100] is 255 times as bright",
            "write \"#ffc864\"",
        ],
    ),
    text(
        "a decal that meets nothing",
        scene!(
            "[environment]\ncolor = [1, 1, 1]\n[material.paint]\n[decal.arrow]\nmaterial = \"paint\"\n\
             translation = [0, 0.6, 0]\nrotation_deg = [-90, 0, 0]\n"
        ),
        [
            "unseen-decal",
            "5:8",
            "decal \"arrow\" meets no surface",
            "half of `size` each way",
        ],
    ),
    text(
        "no light",
        scene!(""),
        [
            "no-light",
            "1:1",
            "the scene has no light",
            "write `[environment]`",
        ],
    ),
    text(
        "a slip in a name of a variant",
        scene!(
            "[environment]\ncolor = [1, 1, 1]\n[[instance]]\nmodel = \"floor\"\n\
             [variant.near.camera.mian]\neye = [0, 1, 3]\n[variant.near.camera.main2]\n\
             eye = [0, 3, 3]\n"
        ),
        [
            "near-name",
            "6:22",
            "camera \"mian\" is new, and the scene below this layer has \"main\"",
            "did you mean \"main\"?",
        ],
    ),
    text(
        "settings that follow from method path",
        scene!(
            "[environment]\ncolor = [1, 1, 1]\n[reflection]\nmethod = \"path\"\nbounces = 2\n\
             accept = \"verified\"\nfilter = true\n[[instance]]\nmodel = \"floor\"\n"
        ),
        [
            "ignored-key",
            "6:1",
            "so `bounces`, `filter` change nothing",
            "remove them",
        ],
    ),
    text(
        "a lamp in its bulb",
        scene!(
            "[light.lamp]\nkind = \"point\"\nposition = [0, 2, 0]\nintensity_cd = 20\n\
             [model.bulb]\nshape = { kind = \"sphere\", radius = 0.2 }\n[[instance]]\n\
             model = \"bulb\"\ntranslation = [0, 2.1, 0]\n[[instance]]\nmodel = \"floor\"\n"
        ),
        [
            "light-inside",
            "2:8",
            "\"lamp\" is inside of \"bulb\"",
            "`casts_shadow = false`",
        ],
    ),
    text(
        "a solid that nothing passes into",
        scene!(
            "[environment]\ncolor = [1, 1, 1]\n[material.glass]\nthickness_m = 0.1\n\
             dispersion = 0.3\n[model.ball]\nshape = { kind = \"sphere\" }\nmaterial = \"glass\"\n\
             [[instance]]\nmodel = \"ball\"\n[[instance]]\nmodel = \"floor\"\n"
        ),
        [
            "ignored-key",
            "4:11",
            "\"glass\" has no `transmission`, so `thickness_m`, `dispersion` change nothing",
            "write `transmission`, or remove them",
        ],
    ),
    text(
        "a coat of no strength",
        scene!(
            "[environment]\ncolor = [1, 1, 1]\n[material.paint]\nclearcoat_roughness = 0.1\n\
             [model.ball]\nshape = { kind = \"sphere\" }\n[[instance]]\nmodel = \"ball\"\n\
             material = \"paint\"\n[[instance]]\nmodel = \"floor\"\n"
        ),
        [
            "ignored-key",
            "4:11",
            "\"paint\" has no `clearcoat`, so `clearcoat_roughness` changes nothing",
            "write `clearcoat`, or remove it",
        ],
    ),
    text(
        "a shutter before what stands still",
        scene!(
            "[environment]\ncolor = [1, 1, 1]\n[image]\nshutter = 0.5\nsamples = 16\n\
             [[instance]]\nmodel = \"floor\"\n"
        ),
        [
            "ignored-key",
            "5:1",
            "nothing moves in the scene, so `shutter` changes nothing",
            "remove it",
        ],
    ),
    text(
        "a shadow map over too much",
        scene!(
            "[light.sun]\nkind = \"directional\"\ndirection = [0.2, -1, 0.1]\nintensity_lux = 3\n\
             [model.land]\nshape = { kind = \"plane\", size = [900, 900] }\n[[instance]]\n\
             model = \"land\"\ntranslation = [0, -0.1, 0]\n[[instance]]\nmodel = \"floor\"\n"
        ),
        [
            "coarse-shadow",
            "2:8",
            "of light \"sun\" spans",
            "`shadow = \"ray\"`",
        ],
    ),
    text(
        "a camera in a wall",
        scene!(
            "[environment]\ncolor = [1, 1, 1]\n[camera.wall]\neye = [3, 1, 0]\n[model.wall]\n\
             shape = { kind = \"box\", size = [1, 4, 4] }\n[[instance]]\nmodel = \"wall\"\n\
             translation = [3, 1, 0]\n[[instance]]\nmodel = \"floor\"\n"
        ),
        [
            "camera-inside",
            "4:9",
            "\"wall\" is inside of \"wall\"",
            "move `eye` out of it",
        ],
    ),
    text(
        "a camera that looks away",
        "[environment]\ncolor = [1, 1, 1]\n[camera.main]\neye = [0, 1, 5]\ntarget = [0, 1, 9]\n\
         [model.ball]\nshape = { kind = \"sphere\" }\n",
        [
            "empty-view",
            "4:9",
            "sees nothing but the environment",
            "`target = [0, 0, 0]`",
        ],
    ),
    text(
        "a camera with a near plane behind everything",
        "[environment]\ncolor = [1, 1, 1]\n[camera.main]\neye = [0, 0, 0.005]\ntarget = [0, 0, 0]\nnear_m = 0.01\n\
         [model.ball]\nshape = { kind = \"sphere\", radius = 0.001 }\n",
        [
            "clipped-view",
            "4:9",
            "nearer than its near plane, 0.01 m",
            "write `near_m = 0.001`",
        ],
    ),
    text(
        "a picture without exposure",
        scene!("[environment]\ncolor = [1, 1, 1]\n[image]\nexposure_ev = -15\n"),
        [
            "black-picture",
            "6:9",
            "black all over",
            "write `exposure_ev = -1`",
        ],
    ),
    text(
        "a picture with too much",
        scene!("[environment]\ncolor = [1, 1, 1]\n[image]\nexposure_ev = 5\n"),
        [
            "blown-picture",
            "6:9",
            "white nearly all over",
            "write `exposure_ev = -1`",
        ],
    ),
    text(
        "short reflection rays",
        scene!(
            "[environment]\ncolor = [1, 1, 1]\n[reflection]\nray_length_u = 0.1\nunit_m = 1\n\
             [material.mirror]\nmetallic = 1\nroughness = 0\n[model.wall]\n\
             shape = { kind = \"box\", size = [40, 40, 1] }\n[model.glass]\n\
             shape = { kind = \"box\", size = [2, 2, 0.1] }\nmaterial = \"mirror\"\n[[instance]]\n\
             model = \"wall\"\ntranslation = [0, 0, 20]\n[[instance]]\nmodel = \"glass\"\n\
             translation = [0, 1.5, 0]\n[[instance]]\nmodel = \"floor\"\ntranslation = [0, -9, 0]\n"
        ),
        [
            "short-reflection",
            "7:11",
            "rays end after 0.1 m",
            "write `ray_length_u = ",
        ],
    ),
    text(
        "a mirror in the dark",
        "[material.mirror]\nmetallic = 1\nroughness = 0\n[material.lamp]\nemission = [1, 1, 1]\n\
         [camera.main]\neye = [0, 0, 5]\ntarget = [0, 0, 0]\n[model.glass]\n\
         shape = { kind = \"box\", size = [2, 2, 0.1] }\nmaterial = \"mirror\"\n[model.bulb]\n\
         shape = { kind = \"sphere\" }\nmaterial = \"lamp\"\n[[instance]]\nmodel = \"glass\"\n\
         [[instance]]\nmodel = \"bulb\"\ntranslation = [3, 0, -1]\n",
        [
            "black-reflector",
            "2:11",
            "reflects nothing but the black",
            "write `[environment]`",
        ],
    ),
    text(
        "an unused material",
        scene!("[environment]\ncolor = [1, 1, 1]\n[material.old]\nroughness = 0.5\n"),
        [
            "unused-material",
            "4:11",
            "no model, instance or decal uses \"old\"",
            "remove it",
        ],
    ),
    text(
        "parameters without a script",
        scene!("[environment]\ncolor = [1, 1, 1]\n[params]\nspeed = 2\n"),
        [
            "unused-param",
            "5:1",
            "the scene has no script",
            "write `script = ",
        ],
    ),
    script(
        "an unused parameter",
        "fn frame(ctx) { }\n",
        [
            "unused-param",
            "3:12",
            "nothing reads the parameter \"count\"",
            "write `ctx.params.count`",
        ],
    ),
    script(
        "a name made between quotation marks",
        "fn frame(ctx) {\n    for i in 0..ctx.params.count {\n        print(\"ball${i}\");\n    }\n}\n",
        [
            "uninterpolated-text",
            "3:15",
            "is taken as it is written",
            "between backticks",
        ],
    ),
    script(
        "a quotient of whole numbers",
        "fn frame(ctx) {\n    ctx.place(\"b\", [ctx.frame / 24, 0, ctx.params.count]);\n}\n",
        [
            "integer-division",
            "2:21",
            "divides whole numbers",
            "write `ctx.frame / 24.0`",
        ],
    ),
    script(
        "a variable that hides another",
        "fn frame(ctx) {\n    let best = ctx.params.count;\n    if best > 1 { let best = 1; }\n}\n",
        [
            "shadowed-variable",
            "3:23",
            "another `best`",
            "write `best = …`",
        ],
    ),
];

#[test]
fn what_is_hardly_meant_is_a_warning() {
    check_group("lint");
}

/// Scene cameras that share a name with a placed scene's camera are told apart from it.
#[test]
fn cameras_of_placed_scenes_are_told_from_those_of_the_scene() {
    let folder = folder("placed");
    let wall = "version = 1\n[environment]\ncolor = [1, 1, 1]\n[camera.inside]\neye = [0, 0, 0]\n\
                target = [0, 0, -1]\n[model.wall]\nshape = { kind = \"box\" }\n";
    fs::write(folder.join("wall.toml"), wall).expect("writable");
    let scene = "version = 1\n[environment]\ncolor = [1, 1, 1]\n[camera.main]\neye = [0, 0, 3]\n\
                 target = [0, 0, 0]\n[camera.\"wall.own\"]\neye = [0, 0, 0]\ntarget = [0, 0, -1]\n\
                 [[instance]]\nmodel = { scene = \"wall.toml\" }\n";
    fs::write(folder.join("scene.toml"), scene).expect("writable");
    let found = results(&folder, &["scene.toml".to_owned()], 0);
    let named: Vec<_> = (found.iter())
        .filter(|found| found["ruleId"] == "camera-inside")
        .map(|found| place(found).0)
        .collect();
    assert_eq!(named, ["7:9"], "{found:#?}");
}

#[test]
fn mistakes_of_a_scene_do_not_hide_those_of_its_variants() {
    let folder = folder("both");
    let scene = "version = 1\n[camera.main]\nfov_deg = 900\n[variant.a.camera.main]\nlens = 3\n\
                 [variant.b]\nremove = \"camera.mian\"\n";
    fs::write(folder.join("scene.toml"), scene).expect("writable");
    let found = results(&folder, &["scene.toml".to_owned()], 3);
    let places: Vec<_> = found.iter().map(|found| place(found).0).collect();
    assert_eq!(places, ["3:11", "5:1", "7:10"], "{found:#?}");
}

#[test]
fn all_scenes_are_checked_and_one_may_come_from_standard_input() {
    let folder = folder("several");
    let good = "version = 1\nenvironment.color = [1, 1, 1]\n[model.a]\nshape.kind = \"box\"\n";
    fs::write(folder.join("good.toml"), good).expect("writable");
    fs::write(folder.join("bad.toml"), "version = 2\n").expect("writable");
    let check = |arguments: &[&str], input: &str| {
        let mut child = Command::new(env!("CARGO_BIN_EXE_reflet"))
            .current_dir(&folder)
            .arg("check")
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        let mut stdin = child.stdin.take().expect("piped");
        stdin.write_all(input.as_bytes()).expect("it reads");
        drop(stdin);
        let output = child.wait_with_output().expect("it ends");
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        (
            output.status.code(),
            text(&output.stdout),
            text(&output.stderr),
        )
    };
    let (code, out, errors) = check(&["bad.toml", "good.toml", "none.toml"], "");
    assert_eq!(
        (code, out.as_str()),
        (Some(3), "good.toml: ok\n"),
        "{errors}"
    );
    assert!(
        errors.contains("version 2") && errors.contains("none.toml"),
        "{errors}"
    );
    let (code, out, errors) = check(&["-"], good);
    assert_eq!((code, out.as_str()), (Some(0), "<stdin>: ok\n"), "{errors}");
    let (code, _, errors) = check(&["-"], "version = 1\n[material.a]\nroughness = 5\n");
    assert_eq!(code, Some(3));
    assert!(errors.contains("<stdin>:3:13"), "{errors}");
    let (code, out, _) = check(&["-", "--json"], "version = 1\nx = 1\n");
    let log: serde_json::Value = serde_json::from_str(&out).expect("it is JSON");
    let first = &log["runs"][0]["results"][0];
    assert_eq!(
        (code, place(first)),
        (Some(3), ("2:1".to_owned(), "%3Cstdin%3E".to_owned()))
    );
}
