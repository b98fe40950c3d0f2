//! Keys of a layer that replace keys below, beside which they cannot stand.

use super::layers::{BASE, Folder};

#[test]
fn a_key_above_replaces_keys_that_cannot_stand_beside_it() {
    for line in include_str!("excluded/replaced.txt").lines().skip(1) {
        let (below, above) = line.split_once(" | ").expect(line);
        let below = format!("{BASE}{}", below.replace("\\n", "\n"));
        let above = format!("{above}\n");
        let in_variant = format!("{below}[variant.v]\n{above}");
        let shot = format!("version = 1\nbase = \"base.toml\"\n{above}");
        let files: [(&[_], &[&str], &[&str]); 3] = [
            (&[("shot/scene.toml", in_variant.as_str())], &["v"], &[]),
            (
                &[("shot/base.toml", &below), ("shot/scene.toml", &shot)],
                &[],
                &[],
            ),
            (&[("shot/scene.toml", &below)], &[], &[&above]),
        ];
        for (files, variants, set) in files {
            let read = Folder::with(files).read(variants, set);
            read.unwrap_or_else(|errors| panic!("{above}{errors}"));
        }
    }
}
