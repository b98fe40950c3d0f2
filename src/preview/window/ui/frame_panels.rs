//! Statistics panels: pass times, and where reflections come from.

use std::collections::VecDeque;

use eframe::egui::{self, Color32, Ui};

use super::charts;
use reflet_render::renderer::stats::{Audit, FrameStats, Share};

/// Pass times: of the last frame as bars, of the history as stacked columns.
pub fn times(ui: &mut Ui, stats: &FrameStats, history: &VecDeque<FrameStats>) {
    egui::CollapsingHeader::new("Passes")
        .default_open(true)
        .show(ui, |ui| {
            let most = stats
                .passes_ms
                .iter()
                .map(|(_, ms)| *ms)
                .fold(1e-6, f64::max);
            egui::Grid::new("passes")
                .num_columns(3)
                .striped(true)
                .show(ui, |ui| {
                    for (name, ms) in &stats.passes_ms {
                        ui.label(name);
                        ui.monospace(format!("{ms:9.3} ms"));
                        charts::bar(ui, (*ms / most) as f32, charts::pass_color(name));
                        ui.end_row();
                    }
                    ui.strong("frame");
                    ui.monospace(format!("{:9.3} ms", stats.frame_ms));
                    ui.end_row();
                });
            if stats.passes_ms.is_empty() {
                ui.weak("this adapter has no timestamps");
            }
            let column = |stats: &FrameStats| {
                let passes = stats.passes_ms.iter();
                let rest_ms = (stats.frame_ms - stats.passes_total_ms()).max(0.0);
                let mut column: Vec<_> = passes
                    .map(|(name, ms)| (charts::pass_color(name), *ms as f32))
                    .collect();
                column.push((Color32::from_gray(70), rest_ms as f32));
                column
            };
            let columns: Vec<_> = history.iter().map(column).collect();
            let height = |c: &Vec<(Color32, f32)>| c.iter().map(|(_, ms)| ms).sum();
            // Room above the stacks for the label.
            let top = 1.3 * columns.iter().map(height).fold(1e-3, f32::max);
            charts::stack(ui, &columns, top, &format!("lately, up to {top:.1} ms"));
            let pixels = format!("{} × {}", stats.size[0], stats.size[1]);
            ui.weak(format!(
                "{pixels}, samples {}, {} rays",
                stats.samples, stats.rays
            ));
        });
}

/// Number of recent pictures over which audits are summed.
const AUDITED_FRAMES: usize = 10;

/// Reflection sources and causes.
pub fn shares(ui: &mut Ui, stats: &FrameStats, history: &VecDeque<FrameStats>) {
    egui::CollapsingHeader::new("Reflections")
        .default_open(true)
        .show(ui, |ui| {
            let shares = &stats.shares;
            if shares.reflective == 0 {
                ui.weak("no reflective pixels");
                return;
            }
            let part = 100.0 * shares.reflective as f64 / shares.pixels.max(1) as f64;
            ui.weak(format!(
                "{part:.1} % of the picture reflects; of that, in %:"
            ));
            charts::shares(ui, &shares.sources);
            over_time(ui, history, "sources lately", charts::source_color, |s| {
                &s.shares.sources
            });
            egui::Grid::new("causes")
                .num_columns(3)
                .striped(true)
                .show(ui, |ui| {
                    for cause in shares.causes.iter().filter(|cause| cause.pixels > 0) {
                        ui.label(cause.name);
                        ui.monospace(format!("{:5.1} %", cause.percent));
                        charts::bar(
                            ui,
                            (cause.percent / 100.0) as f32,
                            charts::cause_color(cause.name),
                        );
                        ui.end_row();
                    }
                });
            over_time(ui, history, "causes lately", charts::cause_color, |s| {
                &s.shares.causes
            });
            let latest = history.iter().rev().take(AUDITED_FRAMES);
            let audit: Audit = latest.filter_map(|stats| stats.audit).sum();
            if audit.hits > 0 {
                ui.weak(audit.to_string());
            }
        });
}

/// Shares of the reflective pixels over the history.
fn over_time(
    ui: &mut Ui,
    history: &VecDeque<FrameStats>,
    label: &str,
    color: fn(&str) -> Color32,
    of: fn(&FrameStats) -> &[Share],
) {
    let part = |share: &Share| (color(share.name), share.percent as f32);
    let columns: Vec<Vec<_>> = history
        .iter()
        .map(|stats| of(stats).iter().map(part).collect())
        .collect();
    charts::stack(ui, &columns, 100.0, label);
}
