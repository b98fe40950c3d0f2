//! `bench paper scenario2 --systems`: the paper's Fig. 7 with all systems, a curve of each over the frames of the walk.

use super::{
    args::RunArgs,
    comparators::{measure, write_curves},
    open_gpu, write,
};
use crate::{
    app::{error::AppError, shaders},
    bench::{
        run::FrameSeries,
        systems::{chart, document::section, frames::table},
    },
    gpu::adapter,
};

/// File name of a chart that ends so.
fn chart_name(ending: &str) -> String {
    format!("systems{ending}.svg")
}

/// Measures all systems along the walk, and writes their table, their charts and a page with both.
///
/// # Errors
/// A folder that cannot be written to, errors of the renderer.
pub(super) fn walk(
    args: &RunArgs,
    size: [u32; 2],
    series: &mut FrameSeries,
) -> Result<(), AppError> {
    let library = shaders::library(args.shaders.as_deref())?;
    let gpu = open_gpu(args, true)?;
    let rows = measure(&gpu, &library, (size, args.frames), series)?;
    let path = |name: &str| args.output.join(name);
    write(&path("systems.csv"), table(&rows).as_bytes())?;
    let svg = chart::of_scene(&rows).map_err(AppError::Internal)?;
    write(&path(&chart_name("")), svg.as_bytes())?;
    write_curves(&rows, |ending| path(&chart_name(ending)))?;
    let time = match gpu.is_software() {
        true => "processor time",
        false => "GPU time",
    };
    let pictures = match args.frames {
        1 => "one picture".to_owned(),
        n => format!("the median of {n} pictures"),
    };
    let mut page = format!(
        "# Systems along the walk\n\nPictures of {} × {} pixels on {}. Milliseconds are {time}: {pictures} of each frame, and the \
         median of all frames.\n",
        size[0],
        size[1],
        adapter::name(&gpu.adapter_info),
    );
    section(&mut page, &rows, chart_name);
    write(&path("systems.md"), page.as_bytes())?;
    reflet_base::error_line!("wrote {}", path("systems.md").display());
    Ok(())
}
