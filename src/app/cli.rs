//! The command line: the commands and their help.

use clap::{Parser, Subcommand};

use super::{
    args::{CheckArgs, PreviewArgs, RenderArgs},
    bench::args::BenchArgs,
    cache::CacheArgs,
    info::InfoArgs,
    job::JobCommand,
    manual::ManualArgs,
    mcp::McpArgs,
    new::NewArgs,
    pack::{PackArgs, unpack::UnpackArgs},
    query::QueryArgs,
    sheet::SheetArgs,
    thumbs::ThumbsArgs,
};
use crate::app::compare::CompareArgs;

/// Renders scenes written as text; reflections are found in screen space, by rays, or in screen space first and by
/// rays where that fails.
#[derive(Clone, Debug, Parser)]
#[command(name = "reflet", version, arg_required_else_help = true)]
pub struct Cli {
    /// Command to run.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Clone, Debug, Subcommand)]
#[allow(
    clippy::large_enum_variant,
    reason = "a process has one, and without a window its sizes are far apart"
)]
pub enum Command {
    /// Write a project into a new folder: reflet.toml, a scene that renders, materials and a studio of lights
    New(NewArgs),
    /// Render a scene to pictures or a film
    Render(RenderArgs),
    /// Render cameras, variants and frames of a scene into one picture, each with its name
    Sheet(Box<SheetArgs>),
    /// Render a small picture of every model, panorama and scene of a folder
    Thumbs(Box<ThumbsArgs>),
    /// Show a scene in a window; every save of its files shows at once
    #[cfg_attr(not(any(feature = "window", feature = "serve")), command(hide = true))]
    Preview(PreviewArgs),
    /// Read scenes and everything they refer to, pose their frames, and report every problem, with
    /// warnings about likely mistakes; needs no GPU
    Check(CheckArgs),
    /// Print the contents of a scene: counts, sizes in meters, memory; needs no GPU
    Info(InfoArgs),
    /// Tell which things of a scene are visible, where they stand in the text, and which others hide, light and touch
    /// them, by rays on the processor; needs no GPU
    Query(Box<QueryArgs>),
    /// Write what a render farm needs to render a film in parts; needs no GPU
    Job {
        /// Kind of render farm
        #[command(subcommand)]
        command: JobCommand,
    },
    /// Write a scene and everything that it reads into one ZIP file, to be rendered elsewhere; needs no GPU
    Pack(PackArgs),
    /// Unpack a pack into a new folder, checking every file, and print the command that renders it; needs no GPU
    Unpack(UnpackArgs),
    /// Compare a picture with a reference
    Compare(CompareArgs),
    /// Measure speed against accuracy, and draw a report
    Bench(Box<BenchArgs>),
    /// Print where converted stages and compiled pipelines are kept between runs, and how large they are; or remove
    /// them
    Cache(CacheArgs),
    /// Run a language server for editors, which start it: diagnostics as in check, completion, hover and definitions
    /// for scene text and scripts (Language Server Protocol, on standard input and output); needs no GPU
    Lsp,
    /// Run a server for agents, which start it: tools that check, ask, render and compare scenes of a folder (Model Context
    /// Protocol, on standard input and output)
    Mcp(McpArgs),
    /// Print the JSON Schema of scene text, for editors
    Schema {
        /// Print the schema of projects (reflet.toml) instead
        #[arg(long)]
        project: bool,
        /// Print the schema of the answers of `query --json` instead
        #[arg(long, conflicts_with = "project")]
        query: bool,
    },
    /// Print the manual of scene text, or its part about a table, a key or a function of scripts, as Markdown
    Manual(ManualArgs),
    /// Print the manual of scripts, as Markdown
    Scripting {
        /// Print a Rhai definition file instead, from which editors complete and explain names
        #[arg(long)]
        definitions: bool,
    },
    /// Print completions for a shell, such as for bash into
    /// ~/.local/share/bash-completion/completions/reflet
    Completions {
        /// Shell to write completions for
        shell: clap_complete::Shell,
    },
    /// Print the manual page of Reflet or of one of its commands: reflet man render | man -l -
    Man {
        /// Command, such as render or bench stability; without one, all of Reflet
        command: Vec<String>,
    },
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    use super::*;

    #[test]
    fn command_line_definition_is_valid() {
        Cli::command().debug_assert();
    }
}
