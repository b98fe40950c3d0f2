//! The command line: the commands and their help.

use clap::{Parser, Subcommand};

use super::{
    args::{CheckArgs, InfoArgs, PreviewArgs, RenderArgs},
    bench::args::BenchArgs,
    job::JobCommand,
};
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
    Preview(PreviewArgs),
    /// Read scenes and everything they refer to, pose their frames, and report every problem, with
    /// warnings about what is allowed but hardly meant; needs no GPU
    Check(CheckArgs),
    /// Print what a scene holds: counts, sizes in meters, memory; needs no GPU
    Info(InfoArgs),
    /// Write what a render farm needs to render a film in parts; needs no GPU
    Job {
        /// For which farm
        #[command(subcommand)]
        command: JobCommand,
    },
    /// Judge a picture against a reference
    Compare(CompareArgs),
    /// Measure speed against accuracy, and draw a report
    Bench(Box<BenchArgs>),
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
