//! `--stats`: prints the statistics of a picture.

use super::{
    args::{RenderArgs, StatsForm},
    error::AppError,
    print_json, print_out,
    render_session::RenderSession,
};
use crate::{
    output::stats::{Report, ReportContext},
    render::renderer::stats::FrameStats,
};

/// Prints the statistics of the last frame of a session, if requested.
///
/// # Errors
/// Render error of the additional frame for `--counters`.
pub fn print(
    args: &RenderArgs,
    session: &mut RenderSession,
    frame: FrameStats,
    context: ReportContext,
) -> Result<(), AppError> {
    let Some(form) = args.stats else {
        return Ok(());
    };
    let mut report = Report::new(session.scene.gpu(), frame, context);
    report.warm_up_ms = session.warm_up_ms;
    if args.counters {
        let counts = session.scene.counts();
        let explain = |error| AppError::from_render(error, session.own_shaders.is_some());
        report.counts = Some(counts.map_err(explain)?);
    }
    match form {
        StatsForm::Text => print_out(&report.table()),
        StatsForm::Json => print_json(&report),
    }
}
