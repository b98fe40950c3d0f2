//! Typical mistakes of people who write scenes, in `tests/bad_scenes/mistakes`: each gives one message, at its
//! place, with advice.
//!
//! A case is a scene, or a script of the scene `scripted.toml`. The first line of its expectation file says by hand
//! what the mistake is and where it stands; `UPDATE_EXPECTED=1` rewrites the messages below it.

use std::sync::{Arc, LazyLock};

use reflet::{
    app::{args::SceneArgs, check},
    scene::{
        diagnostic::{Severity, Source},
        reach::UnsavedTexts,
        syntax::parse_value,
    },
};

use crate::{
    bad::{bad_scenes, files_of, unexpected},
    kit::*,
};

/// Folders of mistakes, with their headings in docs/mistakes.md.
const GROUPS: [(&str, &str); 10] = [
    ("syntax", "TOML"),
    ("values", "Keys and values"),
    ("forms", "Forms of other programs"),
    ("habits", "Habits from other programs"),
    ("shapes", "Shapes, patterns and decals"),
    ("keys", "Keys that other programs have"),
    ("files", "Motion, layers and files"),
    ("scripts", "Scripts"),
    ("lint", "Warnings"),
    ("reported", "Reported by users"),
];

/// A mistake, and the program's messages.
struct Mistake {
    file: PathBuf,
    /// First line of the expectation file: the mistake and its place.
    head: String,
    messages: Vec<Diagnostic>,
}

static MISTAKES: LazyLock<Vec<(&str, Vec<Mistake>)>> = LazyLock::new(|| {
    std::thread::scope(|scope| {
        let groups = GROUPS.map(|(folder, title)| (title, scope.spawn(move || mistakes(folder))));
        let joined = groups.map(|(title, group)| (title, group.join().expect("it does not panic")));
        joined.into()
    })
});

fn mistakes(folder: &str) -> Vec<Mistake> {
    let folder = bad_scenes().join("mistakes").join(folder);
    let files = files_of(&folder, &["toml", "rhai"]);
    assert_eq!(
        files_of(&folder, &["txt"]).len(),
        files.len(),
        "an expectation of {} has lost its mistake",
        folder.display()
    );
    files.into_iter().map(Mistake::new).collect()
}

/// Messages about a scene, or about a script of the scene `scripted.toml`.
fn messages(case: &Arc<Source>) -> Vec<Diagnostic> {
    let scene = case.path.with_extension("toml");
    let is_script = scene != case.path;
    let source = if is_script {
        let text = include_str!("../bad_scenes/mistakes/scripted.toml");
        let stem = scene.file_stem().expect("a name").to_string_lossy();
        Arc::new(Source::new(scene.clone(), text.replace("NAME", &stem)))
    } else {
        case.clone()
    };
    let (args, files) = (SceneArgs::default(), Dependencies::default());
    check::messages(&source, &args, UnsavedTexts::new([case]), &files)
}

impl Mistake {
    fn new(file: PathBuf) -> Self {
        let expectation = fs::read_to_string(file.with_extension("txt")).expect("an expectation");
        let head = expectation.lines().next().unwrap_or_default().to_owned();
        let text = fs::read_to_string(&file).expect("text");
        let messages = messages(&Source::new(file.clone(), text).into());
        Self {
            file,
            head,
            messages,
        }
    }

    /// The message, and the text of the case with the message's advice written in its place.
    fn mended(&self) -> Option<(&Diagnostic, Arc<Source>)> {
        let message = self.message()?;
        let fix = reflet_lsp::quick_fix(message)?;
        let source = message.span.source.as_ref()?;
        let at = |end| reflet_lsp::offset(&source.text, &fix["range"][end]);
        let mut text = source.text.clone();
        text.replace_range(at("start")..at("end"), fix["new"].as_str()?);
        Some((message, Source::new(source.path.clone(), text).into()))
    }

    /// Description of the mistake, and the line and column at which it stands.
    fn claimed(&self) -> (&str, &str) {
        let parts = self.head.rsplit_once(", at ");
        parts.unwrap_or_else(|| panic!("{}: WHAT, at LINE:COLUMN", self.file.display()))
    }

    /// The only message that points into a text: the error, or the warning where there is no error.
    fn message(&self) -> Option<&Diagnostic> {
        let is_error = |d: &Diagnostic| d.severity == Severity::Error;
        let has_errors = self.messages.iter().any(is_error);
        let points = |d: &&Diagnostic| d.span.source.is_some() && is_error(d) == has_errors;
        let mut all = self.messages.iter().filter(points);
        all.next().filter(|_| all.next().is_none())
    }

    /// A text without the folder of the case.
    fn without_folder(&self, text: &str) -> String {
        let folder = self.file.parent().expect("a folder");
        text.replace(&format!("{}/", folder.display()), "")
    }

    /// The text at which the message points, and the line and column there.
    fn place(&self) -> Option<(&str, String)> {
        let span = &self.message()?.span;
        let source = span.source.as_ref()?;
        let place = source.place(span.range.start);
        Some((&source.text, format!("{}:{}", place.line, place.column)))
    }

    /// The only message and its advice in one sentence, as in `check --json`, with `scene` as the file's name.
    fn sentence(&self) -> String {
        let stem = self.file.file_stem().expect("a name").to_string_lossy();
        let said = |d: &Diagnostic| {
            let help = d.help.as_ref().map(|help| format!("; {help}"));
            [d.message.as_str(), help.as_deref().unwrap_or_default()].concat()
        };
        let sentence = self.message().map(said).unwrap_or_default();
        self.without_folder(&sentence).replace(&*stem, "scene")
    }

    fn score(&self) -> u32 {
        let is_at_place = self.place().is_some_and(|(_, at)| at == self.claimed().1);
        score(is_at_place, &self.sentence())
    }

    /// A row of the page.
    fn row(&self) -> String {
        let stem = self.file.file_stem().expect("a name").to_string_lossy();
        let cell = |text: &str| text.replace('|', "\\|").replace('\n', " ");
        // A code span of Markdown may hold single backticks between double ones.
        let line = self.place().map_or_else(String::new, |(text, at)| {
            format!("`` {} ``", line_at(text, &at).replace(&*stem, "scene"))
        });
        let sentence = self.sentence();
        let (says, cure) = sentence.split_once("; ").unwrap_or((&sentence, ""));
        format!(
            "| {} | {} | {}; *{}* | {} |\n",
            self.claimed().0,
            cell(&line),
            cell(says),
            cell(cure),
            self.score()
        )
    }
}

/// Score of a message: 0 if it does not stand at the place of the mistake, else 1, 2 if it also names what is wrong or
/// expected, 3 if its help names something too. A name is a piece of code, a quoted word or a number.
fn score(is_at_place: bool, message: &str) -> u32 {
    let (says, cure) = message.split_once("; ").unwrap_or((message, ""));
    let has_name = |text: &str| {
        let is_quoted = |mark: char| text.matches(mark).count() >= 2;
        is_quoted('`') || is_quoted('"') || text.contains(|c: char| c.is_ascii_digit())
    };
    let is_word = cure.contains("write true") || cure.contains("write false");
    match (is_at_place, has_name(says), has_name(cure) || is_word) {
        (false, ..) => 0,
        (true, false, _) => 1,
        (true, true, false) => 2,
        (true, true, true) => 3,
    }
}

/// Line of a text at a `line:column`, without spaces at its ends.
fn line_at<'a>(text: &'a str, place: &str) -> &'a str {
    let number = place.split(':').next().and_then(|line| line.parse().ok());
    let line = number.and_then(|number: usize| text.lines().nth(number.saturating_sub(1)));
    line.unwrap_or_default().trim()
}

fn all() -> impl Iterator<Item = &'static Mistake> + Clone {
    MISTAKES.iter().flat_map(|(_, mistakes)| mistakes)
}

/// Mean score of the messages about some mistakes.
fn mean_score<'m>(of: impl Iterator<Item = &'m Mistake> + Clone) -> f64 {
    f64::from(of.clone().map(Mistake::score).sum::<u32>()) / of.count() as f64
}

#[test]
fn each_mistake_gives_one_message_at_its_place_with_advice() {
    let mut wrong = Vec::new();
    for mistake in all() {
        let messages = mistake.without_folder(&render_all(&mistake.messages, false));
        wrong.extend(unexpected(
            &mistake.file,
            &format!("{}\n\n{messages}", mistake.head),
        ));
        let (what, claimed) = mistake.claimed();
        let place = mistake.place().map(|(_, place)| place);
        let sentence = mistake.sentence();
        let advice = sentence.split_once("; ").map(|(_, advice)| advice);
        if place.as_deref() != Some(claimed) || advice.is_none_or(str::is_empty) {
            wrong.push(format!(
                "{what}: not one message with advice at {claimed}, but\n{messages}"
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n======\n"));
    // None is removed unnoticed.
    assert!(all().count() >= 357, "{}", all().count());
}

/// Mistakes whose line has another mistake too.
const FURTHER: [&str; 3] = [
    "30_two_instances_with_one_bracket", // each of them
    "01_a_fov_of_the_whole_picture",     // two numbers
    "36_a_list_of_instances",            // names of models
];

#[test]
fn advice_that_is_written_is_not_refused_again() {
    let mended = all().filter_map(|it| Some((it.file.file_stem()?.to_str()?, it.mended()?)));
    let is_refused = |first: &Diagnostic, text: &Arc<Source>| {
        let line = |at: &Diagnostic| text.place(at.span.range.start).line;
        messages(text).iter().any(|next| {
            let is_error = next.severity == Severity::Error || next.message == first.message;
            let source = next.span.source.as_ref();
            let is_here =
                source.is_some_and(|it| it.path == text.path) && line(next) == line(first);
            // Cases have not all that they name.
            is_error && is_here && !["file-not-found", "dangling-name"].contains(&next.name)
        })
    };
    let refused = |(stem, (first, text))| is_refused(first, &text).then_some(stem);
    let refused: Vec<_> = mended.clone().filter_map(refused).collect();
    assert_eq!(refused, FURTHER);
    assert!(mended.count() >= 150, "there is advice to write");
    let is_no_number = |said: &String| {
        let new = said.split("write ").nth(1).unwrap_or_default();
        let new = new.split([' ', ',', ';']).next().unwrap_or_default();
        new.starts_with(|c: char| "+-.0123456789".contains(c)) && parse_value(new).is_err()
    };
    let wrong = all().map(Mistake::sentence).find(is_no_number);
    assert_eq!(wrong, None);
}

/// The messages about all mistakes score 2.8 of 3 on average.
#[test]
fn messages_say_where_what_and_what_to_write() {
    let lacking = all().filter(|mistake| mistake.score() < 3);
    let lacking: Vec<String> = lacking
        .map(|m| format!("{}: {}", m.score(), m.sentence()))
        .collect();
    let mean = mean_score(all());
    assert!(mean >= 2.8, "mean {mean:.2}\n{}", lacking.join("\n"));
}

const PAGE: &str = include_str!("mistakes.md");

/// The page of mistakes, with a table for each group.
fn page() -> String {
    let (count, mean) = (all().count(), mean_score(all()));
    let mut page = format!("{PAGE}The {count} mistakes score {mean:.2} on average.\n");
    for (title, mistakes) in &*MISTAKES {
        let mean = mean_score(mistakes.iter());
        page += &format!(
            "\n## {title}\n\nOn average {mean:.2}.\n\n| mistake | line | message | score |\n|---|---|---|---|\n"
        );
        page.extend(mistakes.iter().map(Mistake::row));
    }
    page
}

#[test]
fn the_page_of_mistakes_is_up_to_date() {
    crate::docs::check("docs/mistakes.md", &page());
}

#[test]
fn scores_tell_good_messages_from_poor_ones() {
    let good =
        "`color` must be three numbers or \"#rrggbb\", not the number 0.9; write [0.9, 0.9, 0.9]";
    let no_cure = "`color` must be three numbers or \"#rrggbb\"; correct it";
    let no_name = "the camera is inside of a shape; write another `eye`";
    for (is_at_place, message, expected) in [
        (true, good, 3),
        (false, good, 0),
        (true, no_cure, 2),
        (true, no_name, 1),
        (true, "syntax error", 1),
        (true, "", 1),
    ] {
        assert_eq!(score(is_at_place, message), expected, "{message}");
    }
}
