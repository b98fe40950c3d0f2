//! Statistics of a picture: a table for people, JSON for machines.

use std::fmt::Write as _;

use serde::Serialize;

use reflet_base::memory::peak_resident_bytes;
use reflet_gpu::{Gpu, adapter};
use reflet_render::{
    decide::Decision,
    passes::audit,
    pipeline::instrument::PassCounts,
    renderer::stats::{FrameStats, Share},
};

/// Output of `--stats`: statistics of the frame, its adapter, and derived values.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Adapter, driver and API.
    pub adapter: String,
    /// Whether the adapter is the CPU.
    pub software: bool,
    /// Statistics of the frame.
    #[serde(flatten)]
    pub frame: FrameStats,
    /// Sum of the passes, milliseconds; 0 without timestamps.
    pub passes_total_ms: f64,
    /// Whether that sum and `frame_ms` differ by more than 10 %.
    pub times_disagree: bool,
    /// Traced pixels per second of the trace pass, if it was timed, follows all rays and shades no other hits: further
    /// bounces, shadow rays and shading are part of its time, not of the count.
    pub rays_per_s: Option<f64>,
    /// Time for reading the scene and every file it names, milliseconds.
    pub load_ms: f64,
    /// Time of an untimed sub-frame in which a software driver compiled pipelines, milliseconds; 0 on GPUs.
    pub warm_up_ms: f64,
    /// Time from the program's start to the finished picture, with the warm-up, milliseconds.
    pub first_picture_ms: f64,
    /// Work counters of the passes, from one more frame; none without `--counters`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub counts: Option<Vec<PassCounts>>,
    /// Peak resident memory, bytes, where the system reports it.
    pub peak_resident_bytes: Option<u64>,
}

/// Times of work outside of the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReportContext {
    /// See [`Report::load_ms`].
    pub load_ms: f64,
    /// See [`Report::first_picture_ms`].
    pub first_picture_ms: f64,
}

impl Report {
    /// Report of a frame on an adapter.
    pub fn new(gpu: &Gpu, frame: FrameStats, context: ReportContext) -> Self {
        Self {
            adapter: adapter::name(&gpu.adapter_info),
            software: gpu.is_software(),
            passes_total_ms: frame.passes_total_ms(),
            times_disagree: frame.times_disagree(),
            rays_per_s: frame.rays_per_s(),
            frame,
            load_ms: context.load_ms,
            warm_up_ms: 0.0,
            first_picture_ms: context.first_picture_ms,
            counts: None,
            peak_resident_bytes: peak_resident_bytes(),
        }
    }

    /// Size of the picture, its number of sub-frames and, where a bound chose that, the error.
    fn picture(&self) -> String {
        let frame = &self.frame;
        let ([width, height], samples) = (frame.size, frame.samples);
        let error = frame.error.map(|e| format!(", error {:.4}", e.error));
        format!(
            "{width} x {height}, samples {samples}{}",
            error.unwrap_or_default()
        )
    }

    /// Table of `--stats text`.
    pub fn table(&self) -> String {
        let frame = &self.frame;
        let mut out = String::new();
        let mut line = |label: &str, value: String| {
            // Writing to a string cannot fail.
            let _ = writeln!(out, "{label:<12}{value}");
        };
        let software = if self.software { " (software)" } else { "" };
        line("adapter", format!("{}{software}", self.adapter));
        line("picture", self.picture());
        line("loading", time("scene and files", self.load_ms));
        for (label, what, ms) in self.preparations() {
            line(label, time(what, ms));
        }
        for (index, (pass, ms)) in frame.passes_ms.iter().enumerate() {
            line(if index == 0 { "passes" } else { "" }, time(pass, *ms));
        }
        if !frame.processor_ms.is_empty() {
            line("", time("processor time of all passes", frame.cost_ms()));
        }
        line("", time("submit to done", frame.frame_ms));
        line("", time("start to picture", self.first_picture_ms));
        if frame.passes_ms.is_empty() {
            line(
                "",
                "passes are not timed: this adapter has no timestamps".to_owned(),
            );
        } else if self.times_disagree {
            line("", time("note: the passes add up to", self.passes_total_ms));
        }
        for (index, Decision { what, chosen, why }) in frame.decisions.iter().enumerate() {
            let label = if index == 0 { "decided" } else { "" };
            line(label, format!("{what} = {chosen}: {why}"));
        }
        let shares = &frame.shares;
        let reflective = 100.0 * shares.reflective as f64 / shares.pixels.max(1) as f64;
        line("reflective", format!("{reflective:.1} % of all pixels"));
        line("source", list(&shares.sources));
        line("cause", list(&shares.causes));
        line("rays", self.rays());
        if let Some((label, maps)) = captured(frame) {
            line(label, maps);
        }
        match &frame.audit {
            Some(audit) => line("audit", audit.to_string()),
            None if frame
                .passes_ms
                .iter()
                .any(|(pass, _)| pass == audit::PASS.name) =>
            {
                line("audit", "no hit on the screen".to_owned());
            }
            None => {}
        }
        if let Some(second) = frame.second_layer {
            line("layer 2", second.to_string());
        }
        if frame.exhausted_rays > 0 {
            let n = frame.exhausted_rays;
            line(
                "",
                format!("{n} visited too many nodes or surfaces and count as misses"),
            );
        }
        for (index, pass) in self.counts.iter().flatten().enumerate() {
            line(if index == 0 { "counted" } else { "" }, counted(pass));
        }
        let total: u64 = frame.bytes.iter().map(|(_, bytes)| bytes).sum();
        line(
            "memory",
            format!("{} of buffers and textures", mebibytes(total)),
        );
        if let Some(peak) = self.peak_resident_bytes {
            line("", format!("{} resident at most", mebibytes(peak)));
        }
        for (class, bytes) in &frame.bytes {
            line("", format!("{class:<26}{:>14}", mebibytes(*bytes)));
        }
        out
    }

    /// Preparations before the first pass: label, work, milliseconds.
    fn preparations(&self) -> impl Iterator<Item = (&'static str, &'static str, f64)> {
        let frame = &self.frame;
        let all = [
            ("trees", "built on the CPU", frame.tree_ms),
            ("structures", "built by the device", frame.structures_ms),
            ("", "updated for this pose", frame.structures_update_ms),
            ("warm-up", "pipelines compiled", self.warm_up_ms),
        ];
        all.into_iter().filter(|(.., ms)| *ms > 0.0)
    }

    fn rays(&self) -> String {
        let rays = self.frame.rays;
        match self.rays_per_s {
            Some(per_s) => format!("{rays}, {:.2} M rays/s", per_s * 1e-6),
            None => rays.to_string(),
        }
    }
}

/// Nonzero counters of a pass.
fn counted(pass: &PassCounts) -> String {
    let named = pass.counts.named().into_iter();
    let texts = named.filter(|(_, count)| *count > 0);
    let texts: Vec<String> = texts
        .map(|(what, count)| format!("{count} {}", what.replace('_', " ")))
        .collect();
    let texts = if texts.is_empty() {
        "nothing marched or traced".to_owned()
    } else {
        texts.join(", ")
    };
    format!("{:<8}{texts}", pass.pass)
}

fn time(what: &str, ms: f64) -> String {
    format!("{what:<26}{ms:>11.3} ms")
}

fn list(shares: &[Share]) -> String {
    let seen = shares.iter().filter(|share| share.pixels > 0);
    let texts: Vec<String> = seen
        .map(|share| format!("{} {:.1} %", share.name, share.percent))
        .collect();
    if texts.is_empty() {
        "no reflective pixels".to_owned()
    } else {
        texts.join(", ")
    }
}

/// Bytes with a unit.
pub fn mebibytes(bytes: u64) -> String {
    format!("{:.1} MiB", bytes as f64 / (1024.0 * 1024.0))
}

/// Maps that the frame captured or kept, by their label; a capture is not part of the frame's time, and one before the
/// timed picture may have no time.
fn captured(frame: &FrameStats) -> Option<(&'static str, String)> {
    let maps = frame.maps.as_ref()?;
    let (text, bytes) = (&maps.facts.texts[0], mebibytes(maps.facts.bytes));
    let ms = maps.capture_ms;
    let when = match (maps.update_ms > 0.0, ms > 0.0) {
        (true, _) => format!("captured for this picture in {ms:.3} ms, apart from the passes"),
        (false, true) => format!("captured before in {ms:.3} ms, apart from the passes"),
        (false, false) => "captured before this picture was timed".to_owned(),
    };
    Some((maps.facts.label, format!("{text}, {bytes}; {when}")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use reflet_render::{pipeline::instrument::Counts, renderer::stats::Shares};
    use reflet_scene::desc::Method;

    fn report() -> Report {
        let mut counters = [0; 10];
        counters[1] = 200; // hit
        counters[2] = 50; // hidden
        Report {
            load_ms: 12.0,
            warm_up_ms: 0.0,
            first_picture_ms: 300.0,
            peak_resident_bytes: None,
            counts: Some(vec![PassCounts {
                pass: "ssr",
                counts: Counts {
                    march_steps: 1200,
                    ..Counts::default()
                },
            }]),
            adapter: "llvmpipe".to_owned(),
            software: true,
            frame: FrameStats {
                size: [100, 10],
                samples: 1,
                method: Method::Hybrid,
                unit_m: 1.0,
                tree_ms: 0.5,
                passes_ms: vec![("ssr".to_owned(), 1.5), ("trace".to_owned(), 2.5)],
                frame_ms: 4.1,
                shares: Shares::new(&counters, [100, 10], Method::Hybrid),
                rays: 50,
                bytes: vec![("textures".to_owned(), 3 << 19)],
                ..FrameStats::default()
            },
            passes_total_ms: 4.0,
            times_disagree: false,
            rays_per_s: Some(1.25e6),
        }
    }

    #[test]
    fn the_table_has_adapter_times_shares_and_memory() {
        let mut report = report();
        let text = report.table();
        for part in [
            "adapter     llvmpipe (software)\n",
            "passes      ssr                             1.500 ms\n",
            "reflective  25.0 % of all pixels\n",
            "source      screen 80.0 %, traced 20.0 %\n",
            "cause       hit 80.0 %, hidden 20.0 %\n",
            "rays        50, 1.25 M rays/s\n",
            "counted     ssr     1200 march steps\n",
            "memory      1.5 MiB of buffers and textures\n",
        ] {
            assert!(text.contains(part), "{part:?} in\n{text}");
        }
        assert!(!text.contains("note:"));
        report.times_disagree = true;
        assert!(report.table().contains("note: the passes add up to"));
        report.frame.passes_ms.clear();
        assert!(report.table().contains("no timestamps"));
    }

    #[test]
    fn json_is_one_flat_object() {
        let json = serde_json::to_value(report()).expect("plain data");
        assert_eq!(json["method"], "hybrid");
        assert_eq!(json["shares"]["sources"][0]["name"], "screen");
        assert_eq!(json["passes_ms"]["trace"], 2.5);
        assert_eq!(json["rays_per_s"], 1.25e6);
        assert_eq!(json["counts"][0]["pass"], "ssr");
        assert_eq!(json["counts"][0]["march_steps"], 1200);
    }
}
