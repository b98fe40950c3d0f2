//! Comments that do not name their thing: fragments (`Of`, `As`, `Those`, `Which`, `What`) and pronouns without a noun.

/// Words that begin a fragment: a reader must guess the noun before them.
const FRAGMENTS: [&str; 5] = ["Of", "As", "Those", "Which", "What"];

/// Opens and closes a docstring of Python.
const DOCSTRING: &str = "\"\"\"";

/// Syntax of a language's comments.
#[derive(Clone, Copy, PartialEq)]
pub enum Syntax {
    /// Rust and WGSL: `///`, `//!` and `//`.
    Slashes,
    /// Python: `#` and docstrings.
    Python,
}

impl Syntax {
    /// Markers at the beginning of a comment's own line; longer ones first.
    const fn markers(self) -> &'static [&'static str] {
        match self {
            Self::Slashes => &["///", "//!", "//"],
            Self::Python => &["#", "r\"\"\"", "\"\"\"", "'''"],
        }
    }

    /// Marker of a comment behind code, with the spaces that tell it from text such as a URL.
    const fn trailing(self) -> &'static str {
        match self {
            Self::Slashes => " // ",
            Self::Python => "  # ",
        }
    }

    /// Marker and text of a line that is a comment.
    fn own_line(self, line: &str) -> Option<(&'static str, &str)> {
        let line = line.trim_start();
        let mut markers = self.markers().iter();
        markers.find_map(|marker| Some((*marker, line.strip_prefix(marker)?.trim())))
    }
}

/// Line number (from 1) and text of each comment that begins with a fragment. A line that continues the
/// comment directly above is none; a paragraph after an empty comment line or a heading begins anew.
pub fn fragments(text: &str, syntax: Syntax) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    // Marker of the comment on the line above, and whether that line only opens a docstring.
    let (mut above, mut is_opened) = (None, false);
    for (number, line) in (1..).zip(text.lines()) {
        let own = syntax.own_line(line);
        let begins = match own {
            Some((marker, comment)) => above != Some(marker) && is_fragment(comment),
            None if is_opened && is_fragment(line.trim()) => true,
            None => line.split(syntax.trailing()).skip(1).any(is_fragment),
        };
        if begins {
            found.push((number, line.trim().to_owned()));
        }
        is_opened = own.is_some_and(|(marker, comment)| marker.len() >= 3 && comment.is_empty())
            && syntax == Syntax::Python;
        above = match own {
            Some((marker, comment)) => {
                Some(marker).filter(|_| !comment.is_empty() && !comment.starts_with("# "))
            }
            None => line
                .contains(syntax.trailing())
                .then(|| syntax.trailing().trim()),
        };
    }
    found
}

fn is_fragment(comment: &str) -> bool {
    let word = comment.split(|c: char| !c.is_alphanumeric()).next();
    word.is_some_and(|word| FRAGMENTS.contains(&word))
}

/// Words behind which a pronoun stands for a noun that the sentence leaves out: "`those` in the cache".
const RELATIONS: &[&str] = &[
    "that", "which", "who", "whose", "with", "without", "in", "on", "at", "by", "for", "from",
    "to", "behind", "above", "below", "between", "before", "after", "under", "over", "inside",
    "outside", "within", "along", "around", "beside", "beyond", "across", "near", "not",
];

/// Words before which `what` is no question: "the depth of `what` is seen".
const BEFORE_WHAT: &[&str] = &[
    "of", "with", "without", "for", "by", "from", "to", "in", "on", "over", "through", "between",
    "behind", "beside", "beyond", "than", "and", "or", "but", "that",
];

/// Line number (from 1) and pronoun of each place in a comment where a pronoun stands for a noun: "`those` of the
/// mesh", "the `one` behind it", "depth of `what` is seen".
pub fn pronouns(text: &str, syntax: Syntax) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    for words in paragraphs(text, syntax) {
        for at in 0..words.len() {
            if let Some(pronoun) = pronoun(&words, at) {
                found.push((words[at].line, pronoun));
            }
        }
    }
    found
}

/// A word of a comment, in small letters without the marks around it.
struct Word {
    line: usize,
    text: String,
    begins_sentence: bool,
    /// Whether a mark such as a comma parts it from the next word.
    is_parted: bool,
    ends_sentence: bool,
}

impl Word {
    fn is(&self, words: &[&str]) -> bool {
        words.contains(&self.text.as_str())
    }
}

/// Words of each paragraph or list item of the comments; code between backticks is a word `code`.
fn paragraphs(text: &str, syntax: Syntax) -> Vec<Vec<Word>> {
    let mut all = vec![Vec::<Word>::new()];
    // Marker of the line above, and whether a docstring is open.
    let (mut above, mut is_open) = (None, false);
    for (line, code) in (1..).zip(text.lines()) {
        let (marker, comment) = if is_open {
            is_open = !code.contains(DOCSTRING);
            (Some(DOCSTRING), code.trim())
        } else if let Some((marker, comment)) = syntax.own_line(code) {
            is_open = marker.ends_with(DOCSTRING) && !comment.contains(DOCSTRING);
            (Some(if is_open { DOCSTRING } else { marker }), comment)
        } else {
            let trailing = code.split_once(syntax.trailing());
            (None, trailing.map_or("", |(_, comment)| comment))
        };
        let comment = comment.trim_end_matches(DOCSTRING).trim();
        let is_item = ["- ", "* ", "|", "#"]
            .iter()
            .any(|i| comment.starts_with(i));
        if comment.is_empty() || is_item || marker.is_none() || marker != above {
            all.push(Vec::new());
        }
        above = marker;
        let words = all.last_mut().expect("at least one");
        let spans = comment.split('`').enumerate();
        let plain = spans.map(|(k, span)| if k % 2 == 0 { span } else { "code" });
        for word in plain.collect::<String>().split_whitespace() {
            let begins = words.last().is_none_or(|last| last.ends_sentence);
            words.push(Word {
                line,
                text: word
                    .trim_matches(|c: char| !c.is_alphanumeric())
                    .to_lowercase(),
                begins_sentence: begins || word.starts_with('('),
                is_parted: word.ends_with([',', '.', ':', ';', '?', '!', ')']),
                ends_sentence: word.ends_with(['.', ':', '?', '!']),
            });
        }
    }
    all
}

/// The pronoun with its neighbors, if a noun is missing at this word.
fn pronoun(words: &[Word], at: usize) -> Option<String> {
    let word = &words[at];
    let next = words.get(at + 1).filter(|_| !word.is_parted);
    let before = at.checked_sub(1).map(|before| &words[before]);
    let before = before.filter(|_| !word.begins_sentence);
    let follows = |followers: &[&str]| next.is_some_and(|next| next.is(followers));
    let is_behind = |leaders: &[&str]| before.is_some_and(|before| before.is(leaders));
    let is_related = follows(&["of"]) || follows(RELATIONS);
    let is_of_them = follows(&["of"])
        && (words.get(at + 2)).is_some_and(|last| last.is(&["them", "these", "those", "it"]));
    let is_vague = match word.text.as_str() {
        "that" | "these" => follows(&["of"]),
        "those" | "ones" => is_related,
        "one" => is_of_them || is_behind(&["the"]) && is_related || is_behind(&["other"]),
        "what" => !follows(&["to"]) && (word.begins_sentence || is_behind(BEFORE_WHAT)),
        _ => false,
    };
    let text = |word: Option<&Word>| word.map_or(String::new(), |word| word.text.clone());
    is_vague.then(|| format!("{} {} {}", text(before), word.text, text(next)))
}
