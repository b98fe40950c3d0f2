//! Tests of values in scene text: changed and unchanged parts, and where new keys and tables land.

use super::*;
use crate::write_back::{
    insert::order_of,
    tree::{Locator, keys},
};
use reflet_scene::syntax::SyntaxTree;

const TEXT: &str = "version = 1 # one\r\n[[instance]]\r\n  name = \"a\" # its name\r\n  translation = [ 1.50, 2, # two\r\n    -3 ]\r\n[instance.material]\r\nroughness = 1\r\n# of b\r\n[[instance]]\r\nname = \"b\"\r\n[light.\"old lamp\"]\r\nscale = 2 # twice\r\n[variant.night.light.x]\r\n";

/// The text after a value was put; it is checked to be scene text.
fn changed(text: &str, path: &[Step], key: &str, value: &Value, order: &[&str]) -> String {
    let tree = SyntaxTree::parse(text);
    let root = tree.correct().expect("it is right");
    let after = put(text, root, path, key, value, order).expect("it can be put");
    let again = SyntaxTree::parse(&after);
    assert!(again.errors().is_empty(), "{after}: {:?}", again.errors());
    let node = find(again.root(), path).expect("the table is there");
    let table = node.get_ref().as_table().expect("it is a table");
    assert!(
        table.contains_key(key),
        "{key} is in another table: {after}"
    );
    after
}

fn locator(kind: &str, step: Step) -> Locator {
    vec![Step::Key(kind.to_owned()), step]
}

fn named(name: &str) -> Step {
    Step::Name(name.to_owned())
}

#[test]
fn only_what_changes_is_written() {
    for (kind, step, key, values, from, to) in [
        (
            "instance",
            named("a"),
            "translation",
            &[1.5, 2.0, -3.0][..],
            "",
            "",
        ),
        (
            "instance",
            named("a"),
            "translation",
            &[1.5, 2.25, -3.0],
            "1.50, 2,",
            "1.50, 2.25,",
        ),
        (
            "instance",
            Step::Index(0),
            "translation",
            &[-0.000_000_1, 2.0, 4.0],
            "[ 1.50, 2, # two\r\n    -3 ]",
            "[ 0, 2, # two\r\n    4 ]",
        ),
        (
            "instance",
            named("a"),
            "scale",
            &[2.0],
            "    -3 ]\r\n",
            "    -3 ]\r\n  scale = 2\r\n",
        ),
        (
            "instance",
            named("b"),
            "scale",
            &[1.0, 2.0, 0.1],
            "name = \"b\"\r\n",
            "name = \"b\"\r\nscale = [1, 2, 0.1]\r\n",
        ),
        (
            "light",
            named("old lamp"),
            "scale",
            &[3.0, 3.0, 3.0],
            "scale = 2 #",
            "scale = 3 #",
        ),
        (
            "light",
            named("old lamp"),
            "scale",
            &[3.0, 1.0, 3.0],
            "scale = 2 #",
            "scale = [3, 1, 3] #",
        ),
    ] {
        let value = Value::Numbers(values.to_vec());
        let found = changed(TEXT, &locator(kind, step), key, &value, &[]);
        assert_eq!(found, TEXT.replacen(from, to, 1), "{kind} {key}");
    }
}

#[test]
fn new_keys_land_where_the_manual_lists_them() {
    let order = order_of("MaterialDesc");
    let [color, rough] = ["base_color", "roughness"].map(|key| {
        let place = order.iter().position(|known| *known == key);
        place.expect("the manual has it")
    });
    assert!(color < rough);
    let text = "[material.a] # red\n  # its color\n  base_color = \"#f00\" # pure\n  reflectivity = 0.5\n[material.b]\nreflectivity = 1\n";
    let number = Value::Numbers(vec![0.25]);
    let between = changed(
        text,
        &locator("material", named("a")),
        "roughness",
        &number,
        &order,
    );
    let (from, to) = ("# pure\n", "# pure\n  roughness = 0.25\n");
    assert_eq!(between, text.replacen(from, to, 1));
    let first = changed(
        text,
        &locator("material", named("b")),
        "roughness",
        &number,
        &order,
    );
    let (from, to) = ("[material.b]\n", "[material.b]\nroughness = 0.25\n");
    assert_eq!(first, text.replacen(from, to, 1));
    // The kind of a light stands first.
    let lamp = "[light.a]\nkind = \"point\"\nintensity_cd = 2\n";
    let value = Value::Color(vec![1.0, 0.5, 0.0]);
    let found = changed(
        lamp,
        &locator("light", named("a")),
        "color",
        &value,
        &order_of("LightDesc"),
    );
    assert_eq!(
        found,
        lamp.replacen("\nint", "\ncolor = [1, 0.5, 0]\nint", 1)
    );
    let inline = "material = { a = { base_color = [1, 0, 0], reflectivity = 1 } }\n";
    let found = changed(
        inline,
        &locator("material", named("a")),
        "roughness",
        &number,
        &order,
    );
    assert!(
        found.contains("0], roughness = 0.25, reflectivity"),
        "{found}"
    );
    // Dotted keys stay dotted.
    let dotted = "[[instance]]\nname = \"x\"\nmaterial.base_color = [1, 0, 0]\ndynamic = true\n";
    let path = [locator("instance", named("x")), keys(["material"])].concat();
    let found = changed(dotted, &path, "roughness", &number, &order);
    let (from, to) = ("0, 0]\n", "0, 0]\nmaterial.roughness = 0.25\n");
    assert_eq!(found, dotted.replacen(from, to, 1));
}

#[test]
fn colors_stay_as_they_are_written() {
    let text = "[light.a]\ncolor = \"#ff8000\" # warm\n[light.b]\ncolor = [1, 0.50, 0]\n";
    let put = |name: &str, values: [f64; 3]| {
        let value = Value::Color(values.to_vec());
        changed(text, &locator("light", named(name)), "color", &value, &[])
    };
    // 0.2140 is sRGB 0.5.
    let found = put("a", [1.0, 0.214, 0.0]);
    assert_eq!(found, text.replacen("#ff8000", "#ff7f00", 1));
    // No sRGB text is brighter than white.
    let found = put("a", [2.0, 0.5, 0.0]);
    assert_eq!(found, text.replacen("\"#ff8000\"", "[2, 0.5, 0]", 1));
    assert_eq!(
        put("b", [1.0, 0.5, 0.25]),
        text.replacen("0.50, 0]", "0.50, 0.25]", 1)
    );
}

#[test]
fn missing_tables_are_made() {
    let text = "version = 1\n[model.fox]\nfile = \"fox.glb\"\n[[instance]]\nmodel = \"fox\"\n[[instance]]\nmodel = \"fox\"\n[light.lamp]\nkind = \"point\" # by the door\n\n[timeline]\nend = 24\n";
    let number = Value::Numbers(vec![0.5]);
    let of_file = keys(["model", "fox", "material", "Fur 2"]);
    let found = changed(text, &of_file, "roughness", &number, &[]);
    let (from, to) = (
        "\"fox.glb\"\n",
        "\"fox.glb\"\n\n[model.fox.material.\"Fur 2\"]\nroughness = 0.5\n",
    );
    assert_eq!(found, text.replacen(from, to, 1));
    // The manual has the environment between lights and the timeline.
    let found = changed(text, &keys(["environment"]), "intensity", &number, &[]);
    let (from, to) = ("door\n", "door\n\n[environment]\nintensity = 0.5\n");
    assert_eq!(found, text.replacen(from, to, 1));
    let own = [locator("instance", Step::Index(0)), keys(["material"])].concat();
    let found = changed(text, &own, "roughness", &number, &[]);
    let (from, to) = (
        "model = \"fox\"\n",
        "model = \"fox\"\nmaterial = { roughness = 0.5 }\n",
    );
    assert_eq!(found, text.replacen(from, to, 1));
    let inline = "model = { fox = { file = \"fox.glb\" } }\n";
    let found = changed(inline, &of_file, "roughness", &number, &[]);
    assert!(
        found.contains("\", material = { \"Fur 2\" = { roughness = 0.5 } } }"),
        "{found}"
    );
}

#[test]
fn inline_and_empty_tables_take_new_keys() {
    let text = "light = { a = { kind = \"point\" }, b = {} }\n[light2]\n[light2.c] # c\n";
    let of = |kind, name: &str| {
        let value = Value::Numbers(vec![0.0, 1.0]);
        changed(text, &locator(kind, named(name)), "position", &value, &[])
    };
    let a = of("light", "a");
    assert!(a.contains("{ kind = \"point\", position = [0, 1] }"), "{a}");
    assert!(of("light", "b").contains("b = { position = [0, 1] }"));
    assert!(of("light2", "c").ends_with("[light2.c] # c\nposition = [0, 1]\n"));
    // A list of inline tables is a value of its table, not a table below it.
    let text = "[motion.camera.a]\neye = { keys = [{ at_s = 0, value = [0, 0, 1] }] }\n";
    let path = keys(["motion", "camera", "a", "eye"]);
    let value = Value::Toml("\"linear\"".to_owned());
    let found = changed(text, &path, "curve", &value, &order_of("TrackDesc"));
    assert!(found.contains("1] }], curve = \"linear\" }"), "{found}");
}
