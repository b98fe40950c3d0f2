//! Tests of values in scene text: changed and unchanged parts, and where new keys and tables land.

use super::*;
use crate::{insert::order_of, tree::Locator};
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
    // Lines of `changes.txt`: table, key and numbers; the part of the text that they replace, and the new part.
    for case in include_str!("changes.txt").lines() {
        let case = case.replace("\\r", "\r").replace("\\n", "\n");
        let (place, rest) = case.split_once(" = ").expect("numbers");
        let (numbers, change) = rest.split_once(" |").expect("a change");
        let (from, to) = change.split_once(" =>").expect("two texts");
        let [kind, step, key] = place.split('.').collect::<Vec<_>>()[..] else {
            panic!("{case}");
        };
        let step = step.parse().map_or_else(|_| named(step), Step::Index);
        let numbers = numbers.split(' ').map(|x| x.parse().expect("a number"));
        let value = Value::Numbers(numbers.collect());
        let found = changed(TEXT, &locator(kind, step), key, &value, &[]);
        let (from, to) = (from.strip_prefix(' '), to.strip_prefix(' '));
        let (from, to) = (from.unwrap_or_default(), to.unwrap_or_default());
        assert_eq!(found, TEXT.replacen(from, to, 1), "{case}");
    }
}

/// Cases of `splices.txt`, divided by lines that begin with `====`: the path of a table (with `@` a name, with `#` an
/// index), a key, its value, and the type whose manual orders the keys; then a text with `«old|new»` at the change.
#[test]
fn keys_and_tables_land_where_the_manual_lists_them_and_values_keep_their_form() {
    for case in include_str!("splices.txt").split("====") {
        let (head, marked) = case.split_once('=').expect("a value");
        let (value, marked) = marked.split_once('\n').expect("a text");
        let head = head.lines().last().expect("a path").trim();
        let (path, key) = head.rsplit_once(' ').expect("a key");
        let step = |step: &str| match step.split_at(1) {
            ("@", name) => named(name),
            ("#", index) => Step::Index(index.parse().expect("an index")),
            _ => Step::Key(step.to_owned()),
        };
        let path: Locator = path.split('/').map(step).collect();
        let words: Vec<&str> = value.split_whitespace().collect();
        let numbers = words.iter().filter_map(|word| word.parse().ok()).collect();
        let value = match words[0] {
            "color" => Value::Color(numbers),
            text if text.starts_with('"') => Value::Toml(text.to_owned()),
            _ => Value::Numbers(numbers),
        };
        let order = words.last().filter(|word| word.ends_with("Desc"));
        let order = order.map(|section| order_of(section)).unwrap_or_default();
        let (before, rest) = marked.split_once('«').expect("a change");
        let (change, after) = rest.split_once('»').expect("its end");
        let (old, new) = change.split_once('|').expect("two texts");
        let found = changed(&[before, old, after].concat(), &path, key, &value, &order);
        assert_eq!(found, [before, new, after].concat(), "{head}");
    }
}
