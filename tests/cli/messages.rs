//! Messages on standard error: errors of usage, and streams that take no message.

use clap::Parser as _;
use reflet::app::cli::Cli;

use super::*;
use crate::common::cases;

#[test]
fn usage_errors_exit_with_2_and_say_what_is_wrong() {
    let folder = folder("usage");
    fs::create_dir(folder.join("shots")).expect("new");
    fs::write(folder.join("shots/sea.toml"), SCENE).expect("written");
    fs::write(folder.join("photo.png"), b"\x89PNG\r\n\x1a\n").expect("written");
    let of_usage = cases(include_str!("messages/usage_errors.txt"));
    let of_files = cases(include_str!("messages/file_errors.txt"));
    for (cases, code) in [(of_usage, 2), (of_files, 3)] {
        for (arguments, says) in cases {
            let [_, error] = exits(&folder, words(arguments), code);
            assert!(error.contains(says), "{arguments} says {error}");
        }
    }
    assert_eq!(names(&folder), ["photo.png", "scene.toml", "shots"]);
}

/// Commands in shell blocks of the documents: names of options and forms of values, not the files, are checked.
#[test]
fn commands_of_the_documents_are_understood() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let docs = fs::read_dir(root.join("docs")).expect("documents");
    let pages = docs.map(|entry| entry.expect("an entry").path());
    let is_page = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "md");
    let mut count = 0;
    for page in pages.filter(is_page).chain([root.join("README.md")]) {
        let text = fs::read_to_string(&page)
            .expect("a page")
            .replace("\\\n", " ");
        let blocks = text.split("```sh\n").skip(1);
        let lines = blocks.flat_map(|block| block.split("```").next().expect("a block").lines());
        for line in lines.filter(|line| line.starts_with("reflet ")) {
            let ends = [" #", " |", " >", " &&"].map(|end| line.find(end));
            let end = ends.into_iter().flatten().min().unwrap_or(line.len());
            let command = line[..end].replace(['\'', '"'], "");
            if let Err(error) = Cli::try_parse_from(command.split_whitespace()) {
                panic!("{}: {line}: {error}", page.display());
            }
            count += 1;
        }
    }
    assert!(count > 50, "only {count} commands are found");
}

#[cfg(target_os = "linux")]
#[test]
fn messages_that_cannot_be_written_end_nothing() {
    or_skip!(gpu_or_skip());
    let folder = folder("stderr");
    let full = || {
        let device = fs::OpenOptions::new().write(true).open("/dev/full");
        device.expect("Linux has this device")
    };
    let film = words("render scene.toml -o a.##.png --size 16x9 --set timeline.end=1");
    for (arguments, code) in [
        (&film[..], 0),
        (&["check", "scene.toml", "gone.toml"], 3),
        (&["render"], 2),
    ] {
        let status = reflet(&folder, arguments)
            .stdout(Stdio::null())
            .stderr(full())
            .status();
        let status = status.expect("the program starts");
        assert_eq!(status.code(), Some(code), "{arguments:?}");
    }
    assert_eq!(names(&folder), ["a.00.png", "a.01.png", "scene.toml"]);
}
