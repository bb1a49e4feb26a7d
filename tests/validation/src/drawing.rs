//! Arguments of the programs that measure and draw.

use std::path::PathBuf;

use clap::Parser;

/// Where to draw, and how thoroughly.
#[derive(Clone, Debug, Parser)]
pub struct Drawing {
    /// Folder of results and pictures
    pub folder: PathBuf,
    /// Takes coarser meshes, fewer samples and fewer load steps
    #[arg(long)]
    pub quick: bool,
    /// Draws what an earlier run measured
    #[arg(long)]
    pub redraw: bool,
}
