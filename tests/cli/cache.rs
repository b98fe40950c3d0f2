//! `cache`, and compiled pipelines that cannot be kept: each is a start without them, and never an error.

use std::process::{Command, Output};

use super::*;

/// Variables of the environment that lead to a cache folder.
const PLACES: [&str; 6] = [
    "REFLET_CACHE",
    "XDG_CACHE_HOME",
    "HOME",
    "TMPDIR",
    "MESA_SHADER_CACHE_DIR",
    "MESA_SHADER_CACHE_DISABLE",
];

const RENDER: [&str; 5] = ["render", "scene.toml", "-oa.png", "--size", "32x18"];

/// The program with no cache folders but these.
fn command(folder: &Path, arguments: &[&str], places: &[(&str, &str)]) -> Command {
    let mut command = reflet(folder, arguments);
    for name in PLACES {
        command.env_remove(name);
    }
    for (name, place) in places {
        command.env(name, folder.join(place));
    }
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// Standard output of a run that succeeds and says no more than that it wrote the picture.
fn quiet(output: &Output) -> String {
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{text}");
    assert!(text.lines().all(|line| line == "wrote a.png"), "{text}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Renders, and returns the picture.
fn picture(folder: &Path, places: &[(&str, &str)]) -> Vec<u8> {
    let output = command(folder, &RENDER, places).output();
    quiet(&output.expect("the program starts"));
    fs::read(folder.join("a.png")).expect("a picture")
}

/// Every file below a folder, sorted.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let below = |path: PathBuf| match path.is_dir() {
        true => files(&path),
        false => vec![path],
    };
    let mut found: Vec<_> = entries.flat_map(|entry| below(entry.path())).collect();
    found.sort();
    found
}

#[test]
fn compiled_pipelines_are_kept_and_cleared() {
    if gpu_or_skip().is_none() || !cfg!(target_os = "linux") {
        return;
    }
    let folder = folder("cache");
    let home = [("HOME", "home"), ("TMPDIR", "tmp")];
    fs::create_dir(folder.join("home")).expect("a folder");
    let kept = || files(&folder.join("home/.cache/reflet/pipelines"));
    let run = |arguments: &[&str]| {
        let output = command(&folder, arguments, &home).output();
        quiet(&output.expect("the program starts"))
    };
    // Two at once share an empty cache.
    let cold: Vec<_> = (0..2)
        .map(|_| command(&folder, &RENDER, &home).spawn())
        .collect();
    for child in cold {
        let output = child.and_then(|child| child.wait_with_output());
        quiet(&output.expect("the program starts"));
    }
    let first = fs::read(folder.join("a.png")).expect("a picture");
    let after_first = kept();
    assert!(!after_first.is_empty());
    assert_eq!(picture(&folder, &home), first);
    assert_eq!(kept(), after_first, "nothing was compiled again");

    let report = run(&["cache"]);
    let says = format!(" in {} files, at most ", after_first.len());
    assert!(report.contains(&says), "{says:?} in {report}");
    // Broken files are compiled again.
    for (path, broken) in after_first
        .iter()
        .zip([&b""[..], b"not a pipeline"].iter().cycle())
    {
        fs::write(path, broken).expect("writable");
    }
    assert_eq!(picture(&folder, &home), first);
    let foreign = folder.join("home/.cache/reflet/pipelines/notes.txt");
    fs::write(&foreign, "not Reflet's").expect("writable");
    assert!(run(&["cache", "--clear"]).contains(", removed\n"));
    assert_eq!(kept(), [foreign]);
    assert!(run(&["cache"]).contains(" 0.0 MiB in 0 files, at most "));
    assert_eq!(files(&folder.join("tmp")), [] as [PathBuf; 0]);
}

#[test]
fn without_a_cache_folder_pictures_are_the_same() {
    if gpu_or_skip().is_none() || !cfg!(target_os = "linux") {
        return;
    }
    let folder = folder("no-cache");
    fs::create_dir(folder.join("tmp")).expect("a folder");
    fs::write(folder.join("file"), "").expect("a file");
    let temporary = || files(&folder.join("tmp"));
    // No folder is named, or one that cannot be: shaders are kept among the temporary files.
    let unnamed = picture(&folder, &[("TMPDIR", "tmp")]);
    let kept = temporary();
    assert!(!kept.is_empty());
    let places = [("HOME", "file"), ("TMPDIR", "tmp")];
    assert_eq!(picture(&folder, &places), unnamed);
    assert_eq!(temporary(), kept, "nothing was compiled again");
    // There is no place at all.
    let places = [("XDG_CACHE_HOME", "file"), ("TMPDIR", "file")];
    assert_eq!(picture(&folder, &places), unnamed);
    // A folder that others can write to is not used.
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        let open = folder.join("open/pipelines");
        fs::create_dir_all(&open).expect("a folder");
        fs::set_permissions(&open, fs::Permissions::from_mode(0o777)).expect("its mode");
        let places = [("REFLET_CACHE", "open"), ("TMPDIR", "tmp")];
        assert_eq!(picture(&folder, &places), unnamed);
        assert_eq!(files(&open), [] as [PathBuf; 0]);
        assert_eq!(temporary(), kept);
    }
}

#[test]
fn a_full_and_a_read_only_cache_change_nothing() {
    if gpu_or_skip().is_none() || !cfg!(target_os = "linux") {
        return;
    }
    let folder = folder("full-cache");
    fs::create_dir(folder.join("tmp")).expect("a folder");
    let expected = picture(&folder, &[("TMPDIR", "tmp")]);
    for (options, fill) in [
        ("size=64k", "head -c 60000 /dev/zero > disk/filler; "),
        // A driver that maps its index there would end by a signal.
        ("size=64k", "cat /dev/zero > disk/filler 2> /dev/null; "),
        ("ro", ""),
    ] {
        let mount = format!("mkdir -p disk && mount -t tmpfs -o {options} none disk");
        let program = command(&folder, &RENDER, &[("HOME", "disk"), ("TMPDIR", "tmp")]);
        let in_shell = |line: &str| {
            let mut shell = Command::new("unshare");
            shell.args(["-rm", "sh", "-c", line]);
            shell.arg(program.get_program()).args(program.get_args());
            for (name, value) in program.get_envs() {
                match value {
                    Some(value) => shell.env(name, value),
                    None => shell.env_remove(name),
                };
            }
            shell.current_dir(&folder).stdin(Stdio::null()).output()
        };
        if !in_shell(&mount).is_ok_and(|output| output.status.success()) {
            eprintln!("SKIPPED: no disk can be mounted here");
            return;
        }
        fs::remove_file(folder.join("a.png")).expect("a picture");
        let output = in_shell(&format!("{mount} && {fill} exec \"$0\" \"$@\""));
        quiet(&output.expect("the shell starts"));
        let found = fs::read(folder.join("a.png")).expect("a picture");
        assert_eq!(found, expected, "{options}");
    }
}
