//! Sessions: commands one after another in a folder, each with its exit code, its words and the files that it leaves.

#[cfg(unix)]
use std::{
    io::{BufRead as _, BufReader},
    os::unix::process::ExitStatusExt as _,
    process::Command,
};

#[cfg(unix)]
use super::agent::Agent;
use super::{project::show, *};
#[cfg(unix)]
use crate::common::program::signal;

/// Steps of a session, a line each: `file NAME` with its text in the indented lines below, `copy NAME FILE` with a file of
/// `tests`, `link NAME TARGET`, `remove NAME`, `run CODE ARGUMENTS`, `stop CODE ARGUMENTS`, which sends SIGTERM to the
/// program after its first line, `feed ARGUMENTS` with standard input in the lines below; `agent ARGUMENTS`, the
/// client of `reflet mcp ARGUMENTS`, which has an answer by `call TOOL JSON`, an error by `fail TOOL JSON`, an answer and
/// an error of two calls at a time by `race TOOL JSON`; and of the run or call before: `says TEXT`, in which `{line}` begins a line, `once TEXT`,
/// `line TEXT`, `lacks TEXT`, `json KEY` at the top, and `files FOLDER: NAMES`, `same A B` and `differ A B`, which compare
/// bytes. `{here}` is the folder, `''` an empty argument.
fn session(folder: &Path, text: &str) {
    let here = folder.canonicalize().expect("there");
    let text = text.replace("{here}", &here.display().to_string());
    let mut lines = text.lines().peekable();
    let mut said = String::new();
    #[cfg(unix)]
    let mut agent = None;
    while let Some(line) = lines.next() {
        let (step, rest) = line.split_once(' ').unwrap_or((line, ""));
        let pair = || rest.split_once(' ').expect("two words");
        let read = |name: &str| fs::read(folder.join(name)).expect(line);
        let mut below = || {
            let indented = |line: &&str| line.starts_with("    ");
            std::iter::from_fn(|| lines.next_if(indented))
                .map(|line| format!("{}\n", &line[4..]))
                .collect::<String>()
        };
        match step {
            "" | "#" => {}
            "file" => {
                let path = folder.join(rest);
                fs::create_dir_all(path.parent().expect("a folder")).expect(line);
                fs::write(path, below()).expect(line);
            }
            "feed" => {
                fs::write(folder.join("fed"), below()).expect(line);
                let fed = fs::File::open(folder.join("fed")).expect(line);
                said = ends(reflet(folder, rest).stdin(fed), 0).concat();
            }
            #[cfg(unix)]
            "agent" => agent = Some(Agent::start(folder, rest)),
            #[cfg(unix)]
            "call" | "fail" | "race" => {
                let agent = agent.as_ref().expect("a step `agent` before");
                let count = if step == "race" { 2 } else { 1 };
                let (errors, words) = agent.call(pair(), count);
                assert_eq!(errors, usize::from(step != "call"), "{line}: {words}");
                said = words;
            }
            #[cfg(unix)]
            "link" => {
                let (name, target) = pair();
                std::os::unix::fs::symlink(target, folder.join(name)).expect(line);
            }
            "copy" => {
                let (name, of) = pair();
                let path = folder.join(name);
                fs::create_dir_all(path.parent().expect("a folder")).expect(line);
                let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
                fs::copy(tests.join(of), path).expect(line);
            }
            "remove" => fs::remove_file(folder.join(rest)).expect(line),
            "run" => {
                let (code, arguments) = pair();
                let arguments = arguments.split(' ').map(|a| if a == "''" { "" } else { a });
                let arguments: Vec<&str> = arguments.collect();
                said = exits(folder, arguments, code.parse().expect(line)).concat();
            }
            #[cfg(unix)]
            "stop" => {
                let (code, arguments) = pair();
                said = stopped(reflet(folder, arguments), code.parse().expect(line));
            }
            "says" => assert!(
                said.contains(&rest.replace("{line}", "\n")),
                "{line}: {said}"
            ),
            "json" => {
                let all: serde_json::Value = serde_json::from_str(&said).expect(line);
                assert!(all.get(rest).is_some(), "{line}: {said}");
            }
            "once" => assert_eq!(said.matches(rest).count(), 1, "{line}: {said}"),
            "line" => assert!(said.lines().any(|own| own == rest), "{line}: {said}"),
            "lacks" => assert!(!said.contains(rest), "{line}: {said}"),
            "files" => {
                let (below, all) = rest.split_once(": ").expect(line);
                assert_eq!(names(&folder.join(below)).join(" "), all, "{line}");
            }
            "same" | "differ" => {
                let (a, b) = pair();
                assert_eq!(read(a) == read(b), step == "same", "{line}");
            }
            _ => panic!("{line}: no such step"),
        }
    }
}

/// Ends a program by SIGTERM after its first line of standard output; returns standard error.
#[cfg(unix)]
fn stopped(mut command: Command, code: i32) -> String {
    let command = command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the program starts");
    let mut out = BufReader::new(child.stdout.take().expect("piped"));
    let read = out.read_line(&mut String::new()).expect("readable");
    assert!(read > 0, "it has ended");
    signal(&child, "-TERM");
    let output = child.wait_with_output().expect("it ends");
    let status = output.status;
    let ended = status.code().or(status.signal().map(|signal| -signal));
    let [_, said] = texts(&output);
    assert_eq!(ended, Some(code), "{said}");
    said
}

/// Declares tests of the sessions of this folder, in a folder with a scene, or in the project of these settings.
macro_rules! sessions {
    ($($name:ident $(($project:literal))?,)*) => {
        $(#[test]
        fn $name() {
            let text = include_str!(concat!("sessions/", stringify!($name), ".txt"));
            if ["\nrun 0 render", "\nrun 5 render", "call render"].iter().any(|s| text.contains(s)) {
                or_skip!(gpu_or_skip());
            }
            let folder = [folder(stringify!($name)) $(, show(stringify!($name), $project))?];
            session(folder.last().expect("one"), text);
        })*
    };
}

sessions! {
    info_counts_warnings_as_check_does_and_lights_of_materials,
    a_log_of_check_has_rules_places_and_what_to_do,
    pages_and_completions_have_the_options,
    mistakes_in_a_scene_are_said_with_their_place_by_each_command,
    render_names_likely_mistakes_that_check_explains,
    check_lists_defaults_that_have_changed,
    the_manual_and_the_schema_are_printed_whole_and_by_key,
    an_outline_of_a_file_is_found_told_and_packed,
    fonts_are_found_by_the_names_inside_of_their_files,
    an_agent_makes_a_scene_and_checks_it,
    an_agent_reads_a_project_alone_and_writes_new_pictures_alone,
    an_agent_that_sends_garbage_or_goes_is_answered_as_far_as_it_asked,
    each_file_of_a_folder_has_a_picture_or_an_error,
    frames_that_fail_are_listed_and_others_are_written,
    films_that_cannot_be_written_are_refused_before_rendering,
    a_picture_says_how_far_it_is_and_keeps_its_samples_if_asked,
    a_scene_is_asked_before_it_is_rendered,
    check_poses_each_frame_and_names_the_first_of_each_mistake,
    several_cameras_are_written_to_files_with_their_names,
    letters_and_lamps_of_a_film_are_written_as_the_pages_say,
    bare_models_have_light_and_turn_as_asked,
    leaves_in_a_mirror_are_as_thick_as_traced_ones,
    a_scene_of_47_km_shows_what_is_near_the_eye,
    render_takes_camera_variant_size_and_output_from_the_project(""),
    names_of_a_project_that_are_nearly_those_of_the_scene_are_warned_of(""),
    names_climb_inside_a_project_and_nowhere_else("scripts = \"scripts\"\n"),
    links_out_of_a_project_are_refused("assets = [\"lib\"]\n"),
    no_output_of_a_project_follows_a_link(""),
    outputs_of_a_project_are_pictures_with_numbers_in_their_names(""),
    a_pack_of_a_project_names_it_and_is_marked_when_unpacked("scripts = \"scripts\"\n"),
}
