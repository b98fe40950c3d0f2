//! Every way in which editors and tools save a file, again and again: what is read last is always
//! what was saved last.

use std::{
    cell::RefCell,
    fs,
    io::Write as _,
    path::{Path, PathBuf},
    thread,
    time::Duration,
};

use reflet::app::watch::{Change, WatchList};

use crate::kit::{Folder, Watch};

/// How often each way of saving is tried.
const ROUNDS: usize = 50;

fn watch(path: &Path) -> Watch {
    Watch::settled(WatchList {
        files: vec![(path.to_owned(), Change::Scene)],
        shader_folders: Vec::new(),
    })
}

/// Saves round after round; each must be seen before the next.
fn every_save_is_seen(name: &str, save: impl Fn(&Folder, &Path, &str)) {
    let folder = Folder::new();
    let path = folder.write(name, "first");
    let watch = watch(&path);
    for round in 0..ROUNDS {
        let text = format!("{round} ").repeat(1 + 977 * (round % 3));
        save(&folder, &path, &text);
        let seen = RefCell::new(String::new());
        watch.until(
            |changes| {
                assert_eq!(changes.iter().collect::<Vec<_>>(), [&Change::Scene]);
                *seen.borrow_mut() = fs::read_to_string(&path).unwrap_or_default();
            },
            || *seen.borrow() == text,
        );
    }
}

#[test]
fn written_in_place() {
    every_save_is_seen("a.toml", |_, path, text| {
        fs::write(path, text).expect("written");
    });
}

#[test]
fn truncated_then_written_in_two_halves() {
    every_save_is_seen("a.toml", |_, path, text| {
        let mut file = fs::File::create(path).expect("truncated");
        let (first, second) = text.split_at(text.len() / 2);
        thread::sleep(Duration::from_millis(3));
        file.write_all(first.as_bytes()).expect("written");
        thread::sleep(Duration::from_millis(15));
        file.write_all(second.as_bytes()).expect("written");
    });
}

#[test]
fn renamed_over() {
    every_save_is_seen("a.toml", |folder, path, text| {
        let beside = folder.write(".a.toml.swp", text);
        fs::rename(beside, path).expect("renamed");
    });
}

#[test]
fn deleted_then_created() {
    every_save_is_seen("a.toml", |_, path, text| {
        fs::remove_file(path).expect("deleted");
        thread::sleep(Duration::from_millis(2));
        fs::write(path, text).expect("created");
    });
}

#[test]
fn the_folder_is_replaced() {
    every_save_is_seen("sub/a.toml", |folder, path, text| {
        fs::rename(folder.path("sub"), folder.path("old")).expect("renamed");
        fs::create_dir(folder.path("sub")).expect("created");
        fs::write(path, text).expect("written");
        fs::remove_dir_all(folder.path("old")).expect("deleted");
    });
}

#[cfg(unix)]
fn link(folder: &Folder, target: &str, name: &str) {
    let beside = folder.path("next-link");
    std::os::unix::fs::symlink(target, &beside).expect("linked");
    fs::rename(beside, folder.path(name)).expect("renamed");
}

#[cfg(unix)]
#[test]
fn a_link_to_the_file_is_swapped() {
    let folder = Folder::new();
    folder.write("first.toml", "first");
    link(&folder, "first.toml", "a.toml");
    let path = folder.path("a.toml");
    swaps_are_seen(&folder, &path, |round, text| {
        let target = format!("target-{}.toml", round % 3);
        folder.write(&target, text);
        link(&folder, &target, "a.toml");
    });
}

#[cfg(unix)]
#[test]
fn a_link_to_the_folder_is_swapped() {
    let folder = Folder::new();
    folder.write("version-first/a.toml", "first");
    link(&folder, "version-first", "current");
    let path = folder.path("current/a.toml");
    swaps_are_seen(&folder, &path, |round, text| {
        folder.write(&format!("version-{round}/a.toml"), text);
        link(&folder, &format!("version-{round}"), "current");
    });
}

#[cfg(unix)]
fn swaps_are_seen(folder: &Folder, path: &Path, save: impl Fn(usize, &str)) {
    let _ = folder;
    let watch = watch(path);
    for round in 0..ROUNDS {
        let text = format!("round {round}");
        save(round, &text);
        let seen = RefCell::new(String::new());
        watch.until(
            |_| *seen.borrow_mut() = fs::read_to_string(path).unwrap_or_default(),
            || *seen.borrow() == text,
        );
    }
}

#[test]
fn a_burst_of_a_thousand_saves_ends_with_the_last() {
    let folder = Folder::new();
    let path = folder.write("a.toml", "first");
    let watch = watch(&path);
    for burst in 0..3 {
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
        // They are not read one by one.
        assert!(*count.borrow() < 500, "{}", count.borrow());
    }
}

#[test]
fn a_touch_without_change_and_a_neighbor_are_no_change() {
    let folder = Folder::new();
    let path = folder.write("a.toml", "same");
    let watch = watch(&path);
    for round in 0..ROUNDS {
        fs::write(&path, "same").expect("written");
        let beside = folder.write("b.toml", "same");
        if round % 2 == 0 {
            fs::rename(beside, &path).expect("renamed");
        }
        fs::read(&path).expect("readable");
    }
    // The first write of each round truncates: a moment without content may have been seen, and
    // then its end was seen too.
    while let Some(changes) = watch.next(Duration::from_millis(200)) {
        assert!(changes.contains(&Change::Scene));
    }
    assert_eq!(fs::read_to_string(&path).expect("readable"), "same");
    for _ in 0..ROUNDS {
        let beside = folder.write("b.toml", "same");
        fs::rename(beside, &path).expect("renamed");
    }
    assert_eq!(watch.next(Duration::from_millis(300)), None);
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
        let changes = watch.next(Duration::from_secs(10)).expect("is seen");
        assert!(changes.contains(&Change::Asset));
    }
}

#[test]
fn a_shader_that_comes_or_goes_or_changes_is_seen() {
    let folder = Folder::new();
    folder.write("shaders/a.wgsl", "1");
    folder.write("shaders/lib/b.wgsl", "1");
    let watch = Watch::settled(WatchList {
        files: Vec::new(),
        shader_folders: vec![folder.path("shaders")],
    });
    let sees = || {
        let changes = watch.next(Duration::from_secs(10)).expect("is seen");
        assert!(changes.contains(&Change::Shader));
    };
    for (name, text) in [
        ("shaders/a.wgsl", "2"),
        ("shaders/lib/b.wgsl", "2"),
        ("shaders/new.wgsl", "1"),
    ] {
        folder.write(&format!("{name}.tmp"), text);
        fs::rename(folder.path(&format!("{name}.tmp")), folder.path(name)).expect("renamed");
        sees();
    }
    fs::remove_file(folder.path("shaders/new.wgsl")).expect("deleted");
    sees();
    folder.write("shaders/notes.txt", "not a shader");
    assert_eq!(watch.next(Duration::from_millis(200)), None);
}
