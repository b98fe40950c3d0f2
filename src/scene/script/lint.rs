//! Warnings about script code that is allowed but hardly meant: division of whole numbers, names that hide
//! others. They are found in the tokens of the text, so that branches that are not taken count too.

use std::{
    collections::{HashMap, HashSet},
    ops::Range,
    sync::Arc,
};

use super::{
    api,
    tokens::{Token, tokens},
};
use crate::{
    desc::{Entry, ParamValue},
    diagnostic::{Diagnostic, Source, Span},
    forms, suggest,
};

/// Parameters that scripts read.
#[derive(Debug, PartialEq, Eq)]
pub enum Params<'t> {
    /// Only parameters with these names.
    Named(HashSet<&'t str>),
    /// Perhaps all parameters: the whole map is used.
    Unknown,
}

/// Parameters that texts read as `params.name`, `params["name"]` or `"name" in ctx.params`.
pub fn used_params<'t>(texts: impl Iterator<Item = &'t str>) -> Params<'t> {
    let mut used = HashSet::new();
    for text in texts {
        let tokens = tokens(text);
        let word = |i: usize| tokens.get(i).map_or("", |t| t.text);
        for i in (0..tokens.len()).filter(|i| tokens[*i].text == "params") {
            let is_asked = i >= 4 && word(i - 3) == "in";
            match (word(i + 1), word(i + 2)) {
                (".", name) if !name.is_empty() => used.insert(name),
                ("[", name) if name.starts_with('"') => used.insert(name.trim_matches('"')),
                _ if is_asked => used.insert(word(i - 4).trim_matches('"')),
                _ => return Params::Unknown,
            };
        }
    }
    Params::Named(used)
}

/// Warnings about the texts of a script, given as pairs of file name and text.
pub fn lint_scripts(texts: &[(String, String)], params: &[Entry<ParamValue>]) -> Vec<Diagnostic> {
    let whole = |p: &&Entry<ParamValue>| matches!(p.value, ParamValue::Integer(_));
    let params: HashSet<_> = params
        .iter()
        .filter(whole)
        .map(|p| p.name.as_str())
        .collect();
    let mut found = Vec::new();
    for (number, (name, text)) in texts.iter().enumerate() {
        let source = Source::new(name, text);
        let mut lint = ScriptLint {
            source: Arc::new(source),
            is_main: number == 0,
            tokens: tokens(text),
            params: &params,
            scopes: vec![Scope::default()],
            in_degrees: HashSet::new(),
            found: Vec::new(),
        };
        lint.run();
        lint.lines();
        found.append(&mut lint.found);
    }
    found
}

/// Variables of a block between braces.
#[derive(Default)]
struct Scope<'t> {
    /// Whether it is the block of a function, which does not see variables outside.
    is_function: bool,
    /// Range of the definition of each variable, and whether its value is a whole number.
    variables: HashMap<&'t str, (Range<usize>, bool)>,
}

struct ScriptLint<'t, 'p> {
    source: Arc<Source>,
    /// Whether it is the script that the scene names, not one that is imported.
    is_main: bool,
    tokens: Vec<Token<'t>>,
    /// Names of parameters that are whole numbers.
    params: &'p HashSet<&'p str>,
    scopes: Vec<Scope<'t>>,
    /// Variables that turn by quarters of a circle in degrees for each second.
    in_degrees: HashSet<&'t str>,
    found: Vec<Diagnostic>,
}

impl<'t> ScriptLint<'t, '_> {
    fn word(&self, i: usize) -> &'t str {
        self.tokens.get(i).map_or("", |t| t.text)
    }

    fn warn(
        &mut self,
        name: &'static str,
        range: Range<usize>,
        message: String,
        help: String,
    ) -> &mut Diagnostic {
        let source = Some(Arc::clone(&self.source));
        let span = Span { source, range };
        self.found
            .push(Diagnostic::new(name, span, message).help(help));
        let last = self.found.len() - 1;
        &mut self.found[last]
    }

    /// Warns about lines that have a form of mistakes.
    fn lines(&mut self) {
        let source = Arc::clone(&self.source);
        let starts = source.text.match_indices('\n').map(|(at, _)| at + 1);
        for start in std::iter::once(0).chain(starts) {
            let line = source.text[start..].lines().next().unwrap_or_default();
            let code = line.split("//").next().unwrap_or(line);
            if let Some((at, message, help)) = forms::found("line", code) {
                self.warn(
                    "unlikely-value",
                    start + at.start..start + at.end,
                    message,
                    help,
                );
            }
        }
    }

    fn run(&mut self) {
        // Variables of a function or a loop, for the scope that its brace opens.
        let mut next = Scope::default();
        for i in 0..self.tokens.len() {
            match self.word(i) {
                "{" | "#{" => self.scopes.push(std::mem::take(&mut next)),
                "}" if self.scopes.len() > 1 => drop(self.scopes.pop()),
                "fn" => {
                    self.in_degrees.clear();
                    next = self.function(i);
                    self.idle_frame(i);
                    self.time_in_setup(i);
                    self.lost_changes(i);
                }
                "for" => {
                    if let Some((name, at, whole)) = self.loop_variable(i) {
                        self.warn_if_hidden(name, &at);
                        next.variables.insert(name, (at, whole));
                    }
                }
                "let" | "const" if self.tokens.get(i + 1).is_some_and(Token::is_word) => {
                    let (name, at) = (self.word(i + 1), self.tokens[i + 1].at.clone());
                    let whole = self.word(i + 2) == "=" && self.word(i + 4) == ";";
                    let whole = whole && is_whole(self.word(i + 3));
                    self.degrees(i + 3, name);
                    // A second definition in the same scope hides nothing from the reader.
                    let scope = self.scopes.last();
                    if !scope.is_some_and(|s| s.variables.contains_key(name)) {
                        self.warn_if_hidden(name, &at);
                    }
                    if let Some(scope) = self.scopes.last_mut() {
                        scope.variables.insert(name, (at, whole));
                    }
                }
                "/" => self.division(i),
                "sin" | "cos" | "tan"
                    if self.in_degrees.contains(self.word(i + 2)) && self.word(i + 3) == ")" =>
                {
                    self.sine_of_degrees(i);
                }
                text if text.starts_with('"') => self.plain_text(i),
                _ => {}
            }
        }
    }

    /// Scope of a function, with its parameters; warns if the function hides one of the API.
    fn function(&mut self, i: usize) -> Scope<'t> {
        let mut scope = Scope {
            is_function: true,
            ..Scope::default()
        };
        let end = (i + 2..self.tokens.len()).find(|k| self.word(*k) == ")");
        let parameters = self.tokens.get(i + 3..end.unwrap_or(i + 3)).unwrap_or(&[]);
        for token in parameters.iter().filter(|t| t.is_word()) {
            scope
                .variables
                .insert(token.text, (token.at.clone(), false));
        }
        let Some(name) = self.tokens.get(i + 1).cloned() else {
            return scope;
        };
        let count = |form: &str| {
            let inner = form.split_once('(').map_or("", |(_, rest)| rest);
            let inner = inner.trim_end_matches(['`', ')']);
            inner
                .split([',', ')'])
                .filter(|p| !p.trim().is_empty())
                .count()
        };
        let forms = api::signatures(name.text);
        let start = format!("`{}(", name.text);
        let is_hidden =
            (forms.iter()).any(|f| f.starts_with(&start) && count(f) == scope.variables.len());
        if is_hidden {
            let shown = suggest::key(name.text);
            let message = format!("this hides the function {shown} that every script has");
            let help = "give it another name, or leave it out and call the other".to_owned();
            self.warn("shadowed-function", name.at, message, help);
        }
        scope
    }

    /// Tokens from the brace that opens the body of the function at `i`, without the brace that closes it.
    fn body(&self, i: usize) -> Option<Range<usize>> {
        let open = (i..self.tokens.len()).find(|k| self.word(*k) == "{")?;
        let mut depth = 0;
        let close = (open..self.tokens.len()).find(|k| {
            match self.word(*k) {
                "{" | "#{" => depth += 1,
                "}" => depth -= 1,
                _ => {}
            }
            depth == 0
        });
        Some(open..close?)
    }

    /// Warns about a `setup` that reads the time.
    fn time_in_setup(&mut self, i: usize) {
        let is_setup = self.is_main && self.word(i + 1) == "setup";
        let reads = |k: &usize| {
            let [owner, dot, key] = [0, 1, 2].map(|n| self.word(k + n));
            owner == self.word(i + 3) && dot == "." && ["t", "frame"].contains(&key)
        };
        let Some(at) = self
            .body(i)
            .filter(|_| is_setup)
            .and_then(|mut body| body.find(reads))
        else {
            return;
        };
        let message = "the time stands still in `setup`, which runs once, at time 0".to_owned();
        let help =
            "set what follows the time in `frame`, as in `ctx.place(\"ball\", [ctx.t, 0, 0]);`";
        let range = self.tokens[at].at.start..self.tokens[at + 2].at.end;
        self.warn("idle-function", range, message, help.to_owned());
    }

    /// Warns about a function that changes its parameters, which are copies, where calls drop its result.
    fn lost_changes(&mut self, i: usize) {
        const CHANGES: [&str; 8] = [
            "push", "insert", "append", "remove", "pop", "shift", "clear", "truncate",
        ];
        const ELSEWHERE: [&str; 5] = ["print", "debug", "throw", "this", "::"];
        let name = self.word(i + 1);
        let Some(body) = self.body(i) else {
            return;
        };
        let parameters = &self.tokens[i + 3..body.start];
        let parameter = body.clone().find_map(|k| {
            let is_changed = self.word(k + 1) == "." && CHANGES.contains(&self.word(k + 2));
            let mut own = parameters
                .iter()
                .filter(|token| token.is_word() && is_changed);
            own.any(|token| token.text == self.word(k))
                .then(|| self.word(k))
        });
        // Functions of a context, other functions of the script and prints have an effect outside.
        let is_own = |word: &str| {
            let mut pairs = self.tokens.windows(2);
            pairs.any(|pair| pair[0].text == "fn" && pair[1].text == word)
        };
        let has_effect = body.into_iter().any(|k| {
            let is_method = self.word(k + 1) == "." && self.word(k + 3) == "(";
            ELSEWHERE.contains(&self.word(k))
                || self.word(k + 1) == "(" && is_own(self.word(k))
                || is_method && !api::signatures(self.word(k + 2)).is_empty()
        });
        // A statement ends in `;`, unlike the last expression of a block.
        let call = (1..self.tokens.len()).find(|&k| {
            let is_first = [";", "{", "}"].contains(&self.word(k - 1));
            let end = (k..self.tokens.len()).find(|end| self.word(*end) == ")");
            let is_statement = is_first && end.is_some_and(|end| self.word(end + 1) == ";");
            is_statement && self.word(k) == name && self.word(k + 1) == "("
        });
        let (Some(parameter), Some(call)) = (parameter.filter(|_| !has_effect), call) else {
            return;
        };
        let message = format!("`{name}` changes a copy of its `{parameter}`, which is lost");
        let help = match self.word(call + 3) {
            ")" => {
                let list = self.word(call + 2);
                format!("end it with `{parameter}`, and write `{list} = {name}({list});` here")
            }
            _ => format!(
                "end it with `{parameter}`, and keep its result here, as in `x = {name}(…);`"
            ),
        };
        self.warn("idle-function", self.tokens[call].at.clone(), message, help);
    }

    /// Takes note of a variable that is the time in seconds times a quarter of a circle in degrees, or several.
    fn degrees(&mut self, value: usize, name: &'t str) {
        self.in_degrees.remove(name);
        let words = [0, 1, 2, 3, 4, 5].map(|n| self.word(value + n));
        let number = match words {
            [number, "*", "ctx", ".", "t", ";"] | ["ctx", ".", "t", "*", number, ";"] => number,
            _ => return,
        };
        let quarters = number.parse::<f64>().map_or(0.5, |degrees| degrees / 90.0);
        if quarters >= 1.0 && quarters.fract() == 0.0 {
            self.in_degrees.insert(name);
        }
    }

    /// Warns about a sine, cosine or tangent of such a variable.
    fn sine_of_degrees(&mut self, i: usize) {
        let (function, name) = (self.word(i), self.word(i + 2));
        let message = format!("`{function}` takes radians, and `{name}` seems to be in degrees");
        let help = format!("write `{function}(radians({name}))`");
        self.warn("unlikely-value", self.tokens[i].at.clone(), message, help);
    }

    /// Warns about a `frame` that sets nothing, since it calls nothing of its `ctx`, hands it to no function and says nothing.
    fn idle_frame(&mut self, i: usize) {
        let is_frame = self.is_main && self.word(i + 1) == "frame" && self.word(i + 4) == ")";
        let Some(body) = self.body(i).filter(|_| is_frame) else {
            return;
        };
        let context = self.word(i + 3);
        let is_used = |k: usize| match self.word(k) {
            text if text.starts_with('`') => text.contains(context),
            word => word == context && (self.word(k + 1) != "." || self.word(k + 3) == "("),
        };
        // Functions that it calls may say something, too.
        let says = |token: &Token| ["print", "debug", "throw"].contains(&token.text);
        let is_idle = !body.clone().any(is_used) && !self.tokens.iter().any(says);
        if body.len() > 1 && is_idle {
            let message = "`frame` sets nothing: its variables are copies".to_owned();
            let mut words = body.map(|k| self.word(k));
            let help = match words.any(|word| ["instances", "lights", "cameras"].contains(&word)) {
                true => {
                    "what it returns is dropped: write `fn setup(ctx)`, which adds to the scene"
                }
                false => "write at its end what changes, as in `ctx.place(\"ball\", p);`",
            };
            let help = help.to_owned();
            self.warn(
                "idle-function",
                self.tokens[i + 1].at.clone(),
                message,
                help,
            );
        }
    }

    /// Warns about `"lamp${i}"`: a text in `"` is not interpolated.
    fn plain_text(&mut self, i: usize) {
        let Token { text, at, .. } = self.tokens[i].clone();
        if !text.contains("${") {
            return;
        }
        let message =
            "text in `\"` is not interpolated: its `${` is taken as it is written".to_owned();
        let help = "write it between backticks: `` `lamp${i}` ``".to_owned();
        self.warn("uninterpolated-text", at, message, help);
    }

    /// Name and range of the variable of `for i in 0..3`, and whether it is a whole number.
    fn loop_variable(&self, i: usize) -> Option<(&'t str, Range<usize>, bool)> {
        let token = self.tokens.get(i + 1).filter(|t| t.is_word())?;
        let whole = self.word(i + 2) == "in"
            && is_whole(self.word(i + 3))
            && self.word(i + 4).starts_with("..");
        Some((token.text, token.at.clone(), whole))
    }

    fn variable(&self, name: &str) -> Option<&(Range<usize>, bool)> {
        for scope in self.scopes.iter().rev() {
            if let Some(variable) = scope.variables.get(name) {
                return Some(variable);
            }
            if scope.is_function {
                break;
            }
        }
        None
    }

    /// Warns about a definition that hides a visible variable of the same name.
    fn warn_if_hidden(&mut self, name: &'t str, at: &Range<usize>) {
        if name.starts_with('_') {
            return;
        }
        let Some((first, _)) = self.variable(name).cloned() else {
            return;
        };
        let shown = suggest::key(name);
        let message = format!("this is another {shown}; the one outside keeps its value");
        let help = format!("write `{name} = …` to change that one, or take another name");
        let source = Some(Arc::clone(&self.source));
        let warning = self.warn("shadowed-variable", at.clone(), message, help);
        warning.related = Some((
            Span {
                source,
                range: first,
            },
            "the one outside is here".into(),
        ));
    }

    /// Warns about a division of whole numbers, which drops the remainder.
    fn division(&mut self, i: usize) {
        let (Some(left), Some(right)) = (self.whole_before(i), self.whole_after(i)) else {
            return;
        };
        let text = &self.source.text;
        let (a, b) = (&text[left.clone()], &text[right.clone()]);
        let numbers = (
            a.replace('_', "").parse::<i64>(),
            b.replace('_', "").parse::<i64>(),
        );
        let is_exact = match numbers {
            (Ok(a), Ok(b)) => b == 0 || a % b == 0,
            (Err(_), Ok(b)) => b <= 1,
            _ => false,
        };
        // `i / 8` beside `i % 8` counts rows and columns.
        let is_modulo = |pair: &[Token]| pair[0].text == "%" && pair[1].text == b;
        if is_exact || self.tokens.windows(2).any(is_modulo) {
            return;
        }
        let quotient = format!("{} / {}", suggest::clip(a), suggest::clip(b));
        let message =
            format!("`{quotient}` divides whole numbers, which drops the rest: 1 / 2 is 0");
        let help = match numbers.1 {
            Ok(_) => format!("write `{a} / {b}.0`; for rows of a grid, `(i - i % {b}) / {b}`"),
            Err(_) => format!("write `1.0 * {a} / {b}`"),
        };
        self.warn("integer-division", left.start..right.end, message, help);
    }

    /// Range of the product before a sign, if all of its factors are whole numbers.
    fn whole_before(&self, sign: usize) -> Option<Range<usize>> {
        let mut end = sign;
        let mut range: Option<Range<usize>> = None;
        loop {
            let first = self.operand_before(end)?;
            let (from, to) = (self.tokens[first].at.start, self.tokens[end - 1].at.end);
            let to = range.map_or(to, |r: Range<usize>| r.end);
            range = Some(from..to);
            match first.checked_sub(1).map(|k| self.word(k)) {
                Some("*" | "/" | "%") => end = first - 1,
                _ => return range,
            }
        }
    }

    /// Index of the first token of the whole number that ends before `end`.
    fn operand_before(&self, end: usize) -> Option<usize> {
        let last = end.checked_sub(1)?;
        if self.word(last) == ")" {
            // `list.len()`
            let is_len = last >= 4 && self.word(last - 1) == "(" && self.word(last - 2) == "len";
            let owner = last
                .checked_sub(4)
                .filter(|_| is_len && self.word(last - 3) == ".")?;
            return Some(self.chain_start(owner));
        }
        let first = self.chain_start(last);
        self.is_whole_chain(first, last).then_some(first)
    }

    /// Index of the first token of `a.b.c` that ends at `last`.
    fn chain_start(&self, last: usize) -> usize {
        let mut first = last;
        while first >= 2 && self.word(first - 1) == "." && self.tokens[first - 2].is_word() {
            first -= 2;
        }
        first
    }

    /// Range of the operand after a sign, if it is a whole number.
    fn whole_after(&self, sign: usize) -> Option<Range<usize>> {
        let first = sign + 1;
        let mut last = first;
        while self.word(last + 1) == "." && self.tokens.get(last + 2).is_some_and(Token::is_word) {
            last += 2;
        }
        let is_call = self.word(last + 1) == "(";
        let is_len = is_call && self.word(last) == "len" && self.word(last + 2) == ")";
        let end = if is_len { last + 2 } else { last };
        let is_whole = is_len || !is_call && self.is_whole_chain(first, last);
        let range = self.tokens.get(first)?.at.start..self.tokens.get(end)?.at.end;
        is_whole.then_some(range)
    }

    /// Whether `ctx.frame`, a parameter, a variable or a literal is a whole number.
    fn is_whole_chain(&self, first: usize, last: usize) -> bool {
        let chain: Vec<_> = (first..=last).step_by(2).map(|k| self.word(k)).collect();
        match chain.as_slice() {
            ["ctx", "frame"] => true,
            ["ctx", "params", name] => self.params.contains(name),
            [one] if is_whole(one) => true,
            [name] => self.variable(name).is_some_and(|(_, whole)| *whole),
            _ => false,
        }
    }
}

/// Whether a token is a literal of a whole number.
fn is_whole(token: &str) -> bool {
    !token.is_empty() && token.bytes().all(|b| b.is_ascii_digit() || b == b'_')
}

#[cfg(test)]
mod tests;
