//! `check`: reads a scene, loads the files that it names and poses its frames.

use std::{
    collections::HashSet,
    io::{self, Read as _},
    path::Path,
    sync::Arc,
    time::{Duration, Instant},
};

use super::{
    args::{CheckArgs, SceneArgs},
    error::AppError,
    folder::files_of,
    lint::{KeptTrees, Lint, since::changed_defaults},
    print_json, print_out,
    project::{check_output_of, misspelt_names},
    sarif,
};
use crate::{
    runtime::{
        catch_panic::catch_panic,
        kept_assets::KeptAssets,
        posing::{frames_of, pose_all},
        scene_text::{LoadedScene, SceneOptions, SceneText},
    },
    scene::{
        dependencies::Dependencies,
        diagnostic::{Diagnostic, Source, at_most, print_diagnostics},
        parse::MOST_BYTES,
        reach::UnsavedTexts,
        stages::Animator,
    },
    world::World,
};

/// Time budget for posing frames, without variants; most errors of scripts and tracks show in a few frames. Variants
/// share their own budget.
const POSING: Duration = Duration::from_secs(2);
/// Time budget for checking variants, each as a scene of its own.
const VARIANTS: Duration = Duration::from_secs(20);
/// Maximum number of displayed lines printed by a script in its frames.
const MOST_LINES: usize = 100;
/// Name of standard input in messages.
const STDIN: &str = "<stdin>";

/// Reports every problem of the scenes, and of all files of folders.
///
/// # Errors
/// [`AppError::Usage`] for a folder without files to check.
/// [`AppError::Scene`] if a scene has errors; the messages are printed.
pub fn check(args: &CheckArgs) -> Result<(), AppError> {
    let (mut all, mut paths) = (Vec::new(), Vec::new());
    for path in &args.scenes {
        let found = match path.is_dir() {
            false => Ok(vec![path.clone()]),
            true => files_of(path, &mut |file, why| {
                let why = why.to_string();
                all.push(Diagnostic::in_file("unreadable-file", file, why));
            }),
        };
        match found {
            Ok(found) => paths.extend(found),
            Err(error) if args.scenes.len() == 1 => return Err(error),
            Err(error) => {
                let why = error.to_string();
                all.push(Diagnostic::in_file("unreadable-file", path, why));
            }
        }
    }
    let mut seen = HashSet::new();
    paths.retain(|path| seen.insert(path.canonicalize().unwrap_or_else(|_| path.clone())));
    if !args.json {
        print_diagnostics(&all);
    }
    let count = paths.len() + all.len();
    let mut right = 0;
    for path in &paths {
        let checked = catch_panic(path, || check_one(path, args));
        right += usize::from(checked.is_ok());
        let messages = match checked {
            Ok((messages, summary)) => {
                if !args.json {
                    print_diagnostics(&messages);
                    print_out(&summary)?;
                }
                messages
            }
            Err(messages) => {
                if !args.json {
                    print_diagnostics(&messages);
                }
                messages
            }
        };
        all.extend(messages);
    }
    if args.json {
        print_json(&sarif::log(&all))?;
    } else if args.scenes.iter().any(|path| path.is_dir()) {
        print_out(&format!("{right} of {count} files are right"))?;
    }
    match right < count {
        true => Err(AppError::Scene(Vec::new())), // already printed
        false => Ok(()),
    }
}

/// Returns the warnings about a scene and its summary line, or all messages. If no variant is chosen,
/// each variant is checked too.
fn check_one(path: &Path, args: &CheckArgs) -> Result<(Vec<Diagnostic>, String), Vec<Diagnostic>> {
    let options = options(&args.from);
    let text = match path == Path::new("-") {
        true => SceneText::new(&read_stdin()?, Path::new(STDIN), &options),
        false => SceneText::read(Some(path), &options)?,
    };
    let kept = Kept {
        tells_defaults: args.since.is_some(),
        ..Kept::default()
    };
    check_text(&text, &args.from, kept)
}

/// All messages about a scene, whose text and `unsaved` ones stand for files; adds the texts that it reads to `files`.
pub fn messages(
    text: &Arc<Source>,
    from: &SceneArgs,
    unsaved: UnsavedTexts,
    files: &Dependencies,
) -> Vec<Diagnostic> {
    let mut options = options(from);
    options.unsaved = unsaved;
    let text = SceneText::from_source(Arc::clone(text), &options);
    let kept = Kept {
        files: files.clone(),
        ..Kept::default()
    };
    let (Ok((messages, _)) | Err(messages)) = check_text(&text, from, kept);
    messages
}

/// Options for opening a scene. Without chosen variants it is checked as it is and with each variant, but not with its
/// project's choice.
fn options(from: &SceneArgs) -> SceneOptions {
    let mut options = from.options();
    if options.variant.is_empty() {
        options.variant.push(String::new());
    }
    options
}

fn check_text(
    text: &SceneText,
    from: &SceneArgs,
    mut kept: Kept,
) -> Result<(Vec<Diagnostic>, String), Vec<Diagnostic>> {
    check_output_of(text)?;
    let whole = check_variant(text.clone(), &mut kept, POSING);
    let mut failed = whole.is_err();
    let (mut messages, mut summary, variants) = match whole {
        Ok(whole) => (whole.messages, whole.summary, whole.variants),
        // A script that exceeded a limit would do so in each variant.
        Err(messages) if messages.iter().any(|d| d.name == "script-limit") => return Err(messages),
        Err(messages) => (messages, String::new(), text.variants()),
    };
    let started = Instant::now();
    let posing = POSING.min(VARIANTS / (variants.len() as u32).max(1));
    let mut checked_variants = 0;
    for variant in variants.iter().filter(|_| from.variant.is_empty()) {
        if started.elapsed() > VARIANTS {
            break;
        }
        checked_variants += 1;
        let checked = check_variant(text.with_variant(variant), &mut kept, posing);
        failed |= checked.is_err();
        let found = checked.map_or_else(|errors| errors, |checked| checked.messages);
        let new: Vec<_> = found
            .into_iter()
            .filter(|d| !messages.contains(d))
            .collect();
        messages.extend(new);
    }
    if failed {
        return Err(at_most(messages));
    }
    match variants.len() {
        _ if !from.variant.is_empty() => {}
        0 => {}
        1 => summary += ", 1 variant",
        n if checked_variants < n => {
            let seconds = VARIANTS.as_secs();
            summary += &format!(", {checked_variants} of {n} variants in {seconds} s");
        }
        n => summary += &format!(", {n} variants"),
    }
    summary += &text
        .project()
        .map_or(String::new(), |project| project.in_words());
    match messages.len() {
        0 => {}
        1 => summary += ", 1 warning",
        n => summary += &format!(", {n} warnings"),
    }
    Ok((at_most(messages), summary))
}

/// Messages and summary of a scene with the chosen variants.
struct Checked {
    messages: Vec<Diagnostic>,
    summary: String,
    /// Names of all variants of the scene.
    variants: Vec<String>,
}

/// State and choices shared by a scene and its variants: files and geometry that were read, their trees, the paths of
/// texts, and whether defaults that have changed are told.
#[derive(Default)]
struct Kept {
    assets: KeptAssets,
    trees: KeptTrees,
    files: Dependencies,
    tells_defaults: bool,
}

/// Checks a scene with the chosen variants; posing its frames takes about `posing`.
fn check_variant(
    text: SceneText,
    kept: &mut Kept,
    posing: Duration,
) -> Result<Checked, Vec<Diagnostic>> {
    let name = text.name();
    let opened = text.open(&[], &kept.files)?;
    for line in opened.scene.scripts().flat_map(|s| &s.setup_log) {
        reflet_base::error_line!("{line}");
    }
    let mut loaded = kept.assets.load(&opened, name)?;
    let mut log = Log::default();
    let mut print = |_: &World, frame, lines| log.add(frame, lines);
    let found = pose_and_lint(&mut loaded, &mut kept.trees, posing, &mut print);
    log.print();
    let mut messages = [misspelt_names(&loaded), loaded.warnings].concat();
    if kept.tells_defaults {
        messages.extend(changed_defaults(&loaded.scene).map(Diagnostic::warning));
    }
    let posed = match found {
        Ok((posed, warnings)) => {
            messages.extend(warnings);
            Some(posed)
        }
        Err(errors) => {
            messages.extend(errors);
            None
        }
    };
    let refused = Lint::refused_here(&loaded.scene, &loaded.world);
    let (Some(posed), None) = (posed, &refused) else {
        messages.extend(refused);
        return Err(messages);
    };
    let frames = frames_of(&loaded.scene);
    let all = frames.end() - frames.start() + 1;
    let frames = match posed {
        _ if all == 1 => String::new(),
        posed if posed == all => format!(", {all} frames"),
        posed => format!(
            ", {posed} of {all} frames in {} s, spread over all",
            POSING.as_secs()
        ),
    };
    let variants = loaded.scene.variants.iter();
    Ok(Checked {
        messages,
        summary: format!("{}: ok{frames}", loaded.name),
        variants: variants.map(|v| v.value.clone()).collect(),
    })
}

/// All warnings of [`Lint`] about a loaded scene; none if a frame cannot be posed, which `check` reports. `visit` is
/// called with each posed world.
pub fn lint(loaded: &mut LoadedScene, visit: &mut dyn FnMut(&World)) -> Vec<Diagnostic> {
    let mut visit = |world: &World, _, _| visit(world);
    let found = pose_and_lint(loaded, &mut KeptTrees::default(), POSING, &mut visit);
    found.map_or_else(|_| Vec::new(), |(_, warnings)| warnings)
}

/// Poses frames; returns their number and the lint warnings, or all errors.
fn pose_and_lint(
    loaded: &mut LoadedScene,
    trees: &mut KeptTrees,
    posing: Duration,
    visit: &mut dyn FnMut(&World, u32, Vec<String>),
) -> Result<(u32, Vec<Diagnostic>), Vec<Diagnostic>> {
    let animator = Animator::new(&loaded.scene);
    let mut lint = Lint::new(&loaded.scene, trees);
    let mut visit = |world: &World, frame, log| {
        lint.frame(world);
        visit(world, frame, log);
    };
    let frames = frames_of(&loaded.scene);
    let count = frames.end() - frames.start() + 1;
    let posed = pose_all(&animator, &mut loaded.world, frames, posing, &mut visit)?;
    Ok((posed, lint.finish((posed == count).then_some(count))))
}

/// Reads scene text from standard input; its relative paths start from the current folder.
fn read_stdin() -> Result<String, Vec<Diagnostic>> {
    let refuse = |why: String| vec![Diagnostic::in_file("unreadable-file", STDIN.as_ref(), why)];
    let mut bytes = Vec::new();
    let read = io::stdin()
        .lock()
        .take(MOST_BYTES + 1)
        .read_to_end(&mut bytes);
    read.map_err(|error| refuse(format!("cannot be read: {error}")))?;
    if bytes.len() as u64 > MOST_BYTES {
        return Err(refuse(format!(
            "a scene may have at most {} MiB",
            MOST_BYTES >> 20
        )));
    }
    String::from_utf8(bytes).map_err(|_| refuse("a scene must be UTF-8 text".into()))
}

/// Output of the script in the first frames, truncated.
#[derive(Default)]
struct Log {
    lines: Vec<(u32, String)>,
    num_more: usize,
}

impl Log {
    fn add(&mut self, frame: u32, lines: Vec<String>) {
        let lines = lines.into_iter().map(|line| (frame, line));
        self.lines.extend(lines);
        self.lines.sort_by_key(|(frame, _)| *frame);
        self.num_more += self.lines.len().saturating_sub(MOST_LINES);
        self.lines.truncate(MOST_LINES);
    }

    fn print(&self) {
        for (frame, line) in &self.lines {
            reflet_base::error_line!("frame {frame}: {line}");
        }
        if self.num_more > 0 {
            reflet_base::error_line!("and {} more lines of the script", self.num_more);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Log, MOST_LINES};

    #[test]
    fn script_log_keeps_only_shown_lines() {
        let mut log = Log::default();
        for frame in [9, 0, 5, 3] {
            log.add(frame, vec!["line".to_owned(); 60]);
        }
        assert_eq!((log.lines.len(), log.num_more), (MOST_LINES, 140));
        let frames = log.lines.iter().map(|(frame, _)| *frame);
        let expected = [0; 60].into_iter().chain([3; 40]);
        assert!(frames.eq(expected));
    }
}
