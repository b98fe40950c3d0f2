//! Arguments of `info`.

use std::path::PathBuf;

use clap::Args;

use crate::app::args::SceneArgs;

/// `info`
#[derive(Clone, Debug, Args)]
pub struct InfoArgs {
    /// Scene file; without one, the built-in atrium
    pub scene: Option<PathBuf>,
    /// Overrides of scene values
    #[command(flatten)]
    pub from: SceneArgs,
    /// File of unit costs that `calibrate` measured; settings left to auto are decided by them, not by the
    /// built-in costs of GPUs and of software adapters
    #[arg(long, value_name = "FILE")]
    pub plan: Option<PathBuf>,
    /// Frame of the timeline for which the instances are listed that reflections skip; default: the first
    #[arg(long, value_name = "FRAME")]
    pub at: Option<u32>,
    /// Print the passes of the frame instead, in their order, with the textures that each reads and writes
    #[arg(long)]
    pub frame: bool,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
}
