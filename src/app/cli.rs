//! The command line: the commands and their help.

use clap::{Parser, Subcommand};

#[cfg(not(feature = "preview"))]
use LeftOutArgs as PreviewArgs;
#[cfg(not(feature = "bench"))]
use LeftOutArgs as BenchArgs;
#[cfg(not(feature = "bench"))]
use LeftOutArgs as CompareArgs;

#[cfg(feature = "preview")]
use super::args::PreviewArgs;
#[cfg(feature = "bench")]
use super::bench::args::BenchArgs;
use super::{
    args::{CalibrateArgs, CheckArgs, InfoArgs, RenderArgs},
    job::JobCommand,
    pack::{PackArgs, unpack::UnpackArgs},
};
#[cfg(feature = "bench")]
use crate::bench::compare::CompareArgs;

/// Renders scenes written as text with hybrid reflections: marched in screen space first, ray
/// traced only where that fails.
#[derive(Clone, Debug, Parser)]
#[command(name = "reflet", version, arg_required_else_help = true)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Clone, Debug, Subcommand)]
pub enum Command {
    /// Render a scene to pictures or a film
    Render(RenderArgs),
    /// Show a scene in a window; every save of its files shows at once
    #[cfg_attr(
        not(feature = "preview"),
        command(hide = true, disable_help_flag = true)
    )]
    Preview(PreviewArgs),
    /// Read scenes and everything they refer to, pose their frames, and report every problem, with
    /// warnings about what is allowed but hardly meant; needs no GPU
    Check(CheckArgs),
    /// Print what a scene holds: counts, sizes in meters, memory; needs no GPU
    Info(InfoArgs),
    /// Measure what pieces of work take on this adapter, for --plan
    Calibrate(CalibrateArgs),
    /// Write what a render farm needs to render a film in parts; needs no GPU
    Job {
        /// For which farm
        #[command(subcommand)]
        command: JobCommand,
    },
    /// Write a scene and everything that it reads into one ZIP file, to be rendered elsewhere; needs no GPU
    Pack(PackArgs),
    /// Make the folder of a pack, checked file by file, and print how it is rendered; needs no GPU
    Unpack(UnpackArgs),
    /// Judge a picture against a reference
    #[cfg_attr(not(feature = "bench"), command(hide = true, disable_help_flag = true))]
    Compare(CompareArgs),
    /// Measure speed against accuracy, and draw a report
    #[cfg_attr(not(feature = "bench"), command(hide = true, disable_help_flag = true))]
    Bench(Box<BenchArgs>),
    /// Serve an editor that starts it: messages as of check, completion, hover and definitions for scene text
    /// and scripts (Language Server Protocol, on standard input and output); needs no GPU
    Lsp,
    /// Print the JSON Schema of scene text, for editors
    Schema,
    /// Print the manual of scene text, as Markdown
    Manual,
    /// Print the manual of scripts, as Markdown
    Scripting {
        /// Print a Rhai definition file instead, from which editors complete and explain names
        #[arg(long)]
        definitions: bool,
    },
    /// Print completions for a shell, such as for bash into
    /// ~/.local/share/bash-completion/completions/reflet
    Completions {
        /// Which shell
        shell: clap_complete::Shell,
    },
    /// Print the manual page of Reflet or of one of its commands: reflet man render | man -l -
    Man {
        /// The command, such as render or bench paper; without one, all of Reflet
        command: Vec<String>,
    },
}

/// Arguments of a command that this build leaves out: anything, so that the message is about the
/// build.
#[cfg(not(feature = "preview"))]
#[derive(Clone, Debug, clap::Args)]
pub struct LeftOutArgs {
    /// Not read.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    pub rest: Vec<std::ffi::OsString>,
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
