//! The commands: they turn a command line into files, text and an exit code.

use std::{
    ffi::OsString,
    io::{self, Write as _},
};

use clap::{CommandFactory as _, Parser as _};

use crate::{
    app::compare::{CompareArgs, compare},
    render::query::answer,
    scene::{
        diagnostic::printable_lines,
        schema::{project_schema, schema},
        script,
    },
};

pub mod args;
pub mod bench;
pub mod cache;
pub mod cameras;
pub mod check;
pub mod cli;
pub mod compare;
pub mod encoder;
pub mod error;
pub mod folder;
pub mod info;
pub mod job;
pub mod lint;
pub mod lsp;
pub mod manual;
pub mod mcp;
pub mod new;
pub mod own_process;
pub mod pack;
#[cfg(any(feature = "window", feature = "serve"))]
pub mod preview;
pub mod progress;
pub mod project;
pub mod query;
pub mod relight;
pub mod render;
pub mod render_session;
pub mod sarif;
pub mod scene;
pub mod sequence;
pub mod shaders;
pub mod sheet;
pub mod shell;
pub mod shutdown;
pub mod size_arg;
pub mod stats;
pub mod still;
pub mod thumbs;
pub mod usage;
pub mod watch;

use cli::{Cli, Command};
pub use error::AppError;

/// Message of `preview` in a build without the feature `window`.
#[cfg(not(feature = "window"))]
const NO_WINDOW: &str = "this build of Reflet has no window; build it without `--no-default-features`, or with the feature `serve` for the page of `--serve`";

/// Runs one command line; help and usage errors of the parser print and exit by themselves.
///
/// # Errors
/// Error of the command.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> Result<(), AppError> {
    own_process::end_with_parent();
    let cli = Cli::try_parse_from(arguments).unwrap_or_else(|error| usage::exit(error));
    match cli.command {
        Command::Render(args) if args.watch => watch::follow(&args),
        Command::Render(args) => render::render(&args),
        #[cfg(feature = "serve")]
        Command::Preview(args) if args.serve.is_some() => preview::page(&args),
        #[cfg(feature = "window")]
        Command::Preview(args) => preview::preview(&args),
        #[cfg(not(feature = "window"))]
        Command::Preview(_) => Err(AppError::Usage(NO_WINDOW.to_owned())),
        Command::Check(args) => check::check(&args),
        Command::Info(args) => info::info(&args),
        Command::Query(args) => query::query(&args),
        Command::Cache(args) => cache::cache(args),
        Command::Lsp => lsp::lsp(),
        Command::Mcp(args) => mcp::mcp(&args, &Cli::command()),
        Command::Job { command } => job::job(&command),
        Command::New(args) => new::new(&args),
        Command::Pack(args) => pack::pack(&args),
        Command::Sheet(args) => sheet::sheet(&args),
        Command::Thumbs(args) => thumbs::thumbs(&args),
        Command::Unpack(args) => pack::unpack::unpack(&args),
        Command::Compare(args) => run_compare(&args),
        Command::Bench(args) => bench::bench(&args),
        Command::Schema { query: true, .. } => print_json(&answer::schema()),
        Command::Schema { project: true, .. } => print_json(&project_schema()),
        Command::Schema { .. } => print_json(&schema()),
        Command::Manual(args) => manual::manual(&args),
        Command::Scripting { definitions: true } => print_out(&script::api::definitions()),
        Command::Scripting { definitions: false } => print_out(&script::api::manual()),
        Command::Completions { shell } => print_out(&shell::completions(shell)),
        Command::Man { command } => print_out(&shell::man_page(&command)?),
    }
}

fn run_compare(args: &CompareArgs) -> Result<(), AppError> {
    let comparison = compare(args).map_err(|diagnostic| AppError::Picture(vec![*diagnostic]))?;
    print_out(&if args.json {
        comparison.to_json()
    } else {
        comparison.to_string()
    })?;
    if comparison.passed() {
        Ok(())
    } else {
        Err(AppError::THRESHOLD)
    }
}

/// Writes to standard output; what could control a terminal is replaced. A closed pipe (`reflet manual | head`) is no
/// error.
///
/// # Errors
/// [`AppError::Internal`] for anything else that stops the writing.
pub fn print_out(text: &str) -> Result<(), AppError> {
    let mut out = io::stdout().lock();
    let end = if text.ends_with('\n') { "" } else { "\n" };
    let text = printable_lines(text);
    let written = write!(out, "{text}{end}").and_then(|()| out.flush());
    match written {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(AppError::Internal(
            format!("cannot write to standard output: {error}"),
        )),
        _ => Ok(()),
    }
}

/// Writes a value to standard output as JSON.
///
/// # Errors
/// Same errors as [`print_out`].
pub fn print_json(value: &impl serde::Serialize) -> Result<(), AppError> {
    let json = serde_json::to_string_pretty(value)
        .map_err(|error| AppError::Internal(format!("as JSON: {error}")))?;
    // JSON may hold control characters behind ASCII as they are; escaped as \uXXXX they mean the same.
    let escape = |c: char| match c.is_control() && c != '\n' {
        true => format!("\\u{:04x}", c as u32),
        false => c.to_string(),
    };
    print_out(&json.chars().map(escape).collect::<String>())
}
