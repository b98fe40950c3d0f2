//! Ways in which editors and tools save files: the last content read is the last content saved.

use std::{cell::RefCell, io::Write as _, thread};

use reflet_preview::watch::WatchList;

use crate::kit::*;

/// Daily a third of the repetitions: 20 of each way of saving, 6 of a thousand saves at once, of which some hundred are read.
pub fn rounds(all: usize) -> usize {
    if is_long() { all } else { all / 3 }
}

fn watch(path: &Path) -> Watch {
    Watch::settled(WatchList {
        files: vec![(path.to_owned(), Change::Scene)],
        shader_folders: Vec::new(),
    })
}

/// A way of saving a text over a file.
pub type Save = fn(&Folder, &Path, &str);

/// Ways in which editors and tools save.
pub const SAVES: [(&str, Save); 6] = [
    ("in place", |_, path, text| {
        fs::write(path, text).expect("written");
    }),
    ("truncated, then in two halves", |_, path, text| {
        let mut file = fs::File::create(path).expect("truncated");
        let (first, second) = text.split_at(text.len() / 2);
        thread::sleep(Duration::from_millis(3));
        file.write_all(first.as_bytes()).expect("written");
        thread::sleep(Duration::from_millis(15));
        file.write_all(second.as_bytes()).expect("written");
    }),
    ("renamed over", |folder, path, text| {
        let temporary = folder.write(".save.swp", text);
        fs::rename(temporary, path).expect("renamed");
    }),
    ("deleted, then created", |_, path, text| {
        fs::remove_file(path).expect("deleted");
        thread::sleep(Duration::from_millis(2));
        fs::write(path, text).expect("created");
    }),
    ("the folder is replaced", |_, path, text| {
        let sub = path.parent().expect("a folder");
        let old = sub.with_file_name("old");
        fs::rename(sub, &old).expect("renamed");
        fs::create_dir(sub).expect("created");
        fs::write(path, text).expect("written");
        fs::remove_dir_all(old).expect("deleted");
    }),
    ("a link to it is swapped", |folder, path, text| {
        let target = format!("target-{}", text.len() % 3);
        let sub = path.parent().expect("a folder");
        fs::write(sub.join(&target), text).expect("written");
        #[cfg(unix)]
        link(folder, &target, path);
        #[cfg(not(unix))]
        fs::rename(sub.join(target), folder.0.join(path)).expect("renamed");
    }),
];

#[test]
fn every_way_of_saving_is_seen() {
    for (way, save) in SAVES {
        let folder = Folder::new();
        let path = folder.write("sub/a.toml", "first");
        let watch = watch(&path);
        for round in 0..rounds(20) {
            let text = format!("{round} ").repeat(1 + 977 * (round % 3));
            save(&folder, &path, &text);
            let seen = RefCell::new(String::new());
            watch.until(
                |changes| {
                    assert_eq!(
                        changes.iter().collect::<Vec<_>>(),
                        [&Change::Scene],
                        "{way}"
                    );
                    *seen.borrow_mut() = fs::read_to_string(&path).unwrap_or_default();
                },
                || *seen.borrow() == text,
            );
        }
    }
}

#[cfg(unix)]
fn link(folder: &Folder, target: &str, path: &Path) {
    let temporary = folder.path("next-link");
    std::os::unix::fs::symlink(target, &temporary).expect("linked");
    fs::rename(temporary, path).expect("renamed");
}

#[cfg(unix)]
#[test]
fn a_link_to_the_folder_is_swapped() {
    let folder = Folder::new();
    folder.write("version-first/a.toml", "first");
    link(&folder, "version-first", &folder.path("current"));
    let path = folder.path("current/a.toml");
    let watch = watch(&path);
    for round in 0..rounds(20) {
        let text = format!("round {round}");
        folder.write(&format!("version-{round}/a.toml"), &text);
        link(
            &folder,
            &format!("version-{round}"),
            &folder.path("current"),
        );
        let seen = RefCell::new(String::new());
        watch.until(
            |_| *seen.borrow_mut() = fs::read_to_string(&path).unwrap_or_default(),
            || *seen.borrow() == text,
        );
    }
}

#[test]
fn a_burst_of_a_thousand_saves_ends_with_the_last() {
    let folder = Folder::new();
    let path = folder.write("a.toml", "first");
    let watch = watch(&path);
    for burst in 0..rounds(6) {
        for i in 0..1000 {
            fs::write(&path, format!("{burst} {i}")).expect("written");
        }
        let (seen, count) = (RefCell::new(String::new()), RefCell::new(0));
        watch.until(
            |_| {
                *count.borrow_mut() += 1;
                *seen.borrow_mut() = fs::read_to_string(&path).expect("readable");
            },
            || *seen.borrow() == format!("{burst} 999"),
        );
        // Saves are coalesced.
        assert!(*count.borrow() < 500, "{}", count.borrow());
    }
}

#[test]
fn a_touch_without_change_and_a_neighbor_are_no_change() {
    let folder = Folder::new();
    let path = folder.write("a.toml", "same");
    let watch = watch(&path);
    for round in 0..rounds(20) {
        fs::write(&path, "same").expect("written");
        let temporary = folder.write("b.toml", "same");
        if round % 2 == 0 {
            fs::rename(temporary, &path).expect("renamed");
        }
        fs::read(&path).expect("readable");
    }
    // The first write of each round truncates: a moment without content may have been seen, and
    // then its end was seen too.
    for changes in watch.changes_so_far() {
        assert_eq!(changes, [Change::Scene].into());
    }
    assert_eq!(fs::read_to_string(&path).expect("readable"), "same");
    for _ in 0..rounds(20) {
        let temporary = folder.write("b.toml", "same");
        fs::rename(temporary, &path).expect("renamed");
    }
    assert_eq!(watch.changes_so_far(), []);
}

#[test]
fn a_file_that_is_missing_is_seen_when_it_comes_also_with_its_folder() {
    let folder = Folder::new();
    let files: Vec<PathBuf> = ["later.png", "sub/deep/later.png"]
        .map(|name| folder.path(name))
        .into();
    let watch = Watch::settled(WatchList {
        files: files.iter().map(|f| (f.clone(), Change::Asset)).collect(),
        shader_folders: Vec::new(),
    });
    for name in ["later.png", "sub/deep/later.png"] {
        folder.write(name, "here");
        assert!(watch.next().contains(&Change::Asset));
    }
}

#[test]
fn a_shader_that_comes_or_goes_or_changes_is_seen() {
    let folder = Folder::new();
    folder.write("shaders/a.wgsl", "1");
    folder.write("shaders/lib/b.wgsl", "1");
    folder.write("shaders/methods/c/lib/d.wgsl", "1");
    let watch = Watch::settled(WatchList {
        files: Vec::new(),
        shader_folders: vec![folder.path("shaders")],
    });
    let sees = || {
        assert!(watch.next().contains(&Change::Shader));
    };
    for (name, text) in [
        ("shaders/a.wgsl", "2"),
        ("shaders/lib/b.wgsl", "2"),
        ("shaders/methods/c/lib/d.wgsl", "2"),
        ("shaders/new.wgsl", "1"),
    ] {
        folder.write(&format!("{name}.tmp"), text);
        fs::rename(folder.path(&format!("{name}.tmp")), folder.path(name)).expect("renamed");
        sees();
    }
    fs::remove_file(folder.path("shaders/new.wgsl")).expect("deleted");
    sees();
    folder.write("shaders/notes.txt", "not a shader");
    assert_eq!(watch.changes_so_far(), []);
}
