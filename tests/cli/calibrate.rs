//! `calibrate` and `--plan`.

use reflet::{app::plan_file::PlanFile, render::settings::unit_costs::UnitCosts};

use super::*;
use crate::common::assert_says;

#[test]
fn unit_costs_of_a_plan_decide_and_only_on_its_adapter() {
    let Some(gpu) = gpu_or_skip() else { return };
    let plan = PlanFile {
        adapter: gpu.adapter_info.name.clone(),
        unit_ns: UnitCosts::PROCESSOR,
    };
    let folder = folder("plan");
    fs::write(folder.join("plan.toml"), plan.text().expect("TOML")).expect("a plan");
    check_plan(&folder);
}

#[test]
#[ignore = "long: times frames of up to 640 x 360 pixels"]
fn what_calibrate_measures_decides_and_only_on_its_adapter() {
    or_skip!(gpu_or_skip());
    let folder = folder("calibrate");
    let calibrate = ["calibrate", "-o", "plan.toml", "--frames", "1"];
    let [table, _] = exits(&folder, calibrate, 0);
    assert_says(&table, &["mirror_node", "its kind"]);
    check_plan(&folder);
}

/// Renders by `plan.toml`, by one with other unit costs, and by one of another adapter.
fn check_plan(folder: &Path) {
    let render = |plan: &str, code| {
        let mut arguments = vec!["render", "scene.toml", "-o", "a.png", "--plan", plan];
        arguments.extend(["--size", "64x36", "--stats", "text"]);
        exits(folder, &arguments, code)
    };
    render("plan.toml", 0);
    let plan = fs::read_to_string(folder.join("plan.toml")).expect("a plan");
    // Unit costs decide: almost zero for one of two alternatives, high for the other.
    for (cheap, dear, chosen) in [
        ("raster", "primary", "raster"),
        ("primary", "raster", "rays"),
    ] {
        let costs = |line: &str| {
            let name = line.split_once(" = ").map_or("", |(name, _)| name);
            match name {
                _ if name.starts_with(cheap) => format!("{name} = 0.001"),
                _ if name.starts_with(dear) => format!("{name} = 1000000.0"),
                _ => line.to_owned(),
            }
        };
        let text: Vec<String> = plan.lines().map(costs).collect();
        fs::write(folder.join("own.toml"), text.join("\n")).expect("a plan");
        let [stats, _] = render("own.toml", 0);
        let decision = format!("image.visibility = {chosen}");
        assert!(stats.contains(&decision), "{stats}");
    }
    let foreign = plan.replace("adapter = \"", "adapter = \"another ");
    fs::write(folder.join("foreign.toml"), foreign).expect("a plan");
    let [_, error] = render("foreign.toml", 2);
    assert!(error.contains("was measured on \"another "), "{error}");
    let [info, _] = exits(folder, "info scene.toml --plan own.toml", 0);
    let decided = "decided     image.visibility = rays on ";
    assert!(
        info.contains(decided) && !info.contains("on GPUs"),
        "{info}"
    );
    let names = names(folder);
    let want = [
        "a.png",
        "foreign.toml",
        "own.toml",
        "plan.toml",
        "scene.toml",
    ];
    assert_eq!(names, want);
}

#[test]
fn no_time_is_spent_on_a_plan_that_cannot_be_written_or_read() {
    let folder = folder("calibrate-refused");
    let [_, error] = exits(&folder, "calibrate -o none/plan.toml", 2);
    assert!(error.contains("there is no folder none"), "{error}");
    fs::write(folder.join("binary.toml"), [0xff, 0xfe]).expect("a file");
    fs::write(folder.join("long.toml"), vec![b'#'; (1 << 16) + 1]).expect("a file");
    for (plan, why) in [
        ("missing.toml", "No such file"),
        ("binary.toml", "not UTF-8"),
        ("long.toml", "longer than 64 KiB"),
        ("scene.toml", "unknown field"),
    ] {
        let [_, error] = exits(&folder, ["info", "scene.toml", "--plan", plan], 2);
        let cure = "`reflet calibrate -o FILE` measures";
        assert!(error.contains(why) && error.contains(cure), "{error}");
    }
}
