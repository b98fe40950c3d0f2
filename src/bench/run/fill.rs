//! Fills the columns of a sample.

use crate::sample::{BEHIND_COLUMN, Sample, pass_column};
use reflet_metric::{hits::CauseTally, structure::Structure, table};
use reflet_render::{
    passes,
    pipeline::instrument::{Counts, PassCounts},
    renderer::stats::FrameStats,
};

use super::judge::Judged;

/// Fills in errors, structure, changes, false accepts and false rejects of a picture.
pub(super) fn fill_errors(sample: &mut Sample, judged: &Judged) {
    let errors = &judged.errors;
    sample.mask_px = errors.mask_px as u64;
    for (column, metric) in table::columns() {
        let mut fill = |column: &str, scores| {
            let cell = sample.number_mut(column);
            *cell.expect("every metric is a column") = (metric.score)(scores);
        };
        fill(column, &errors.frame);
        if let Some(mask) = &errors.mask {
            fill(&format!("mask_{column}"), mask);
        }
    }
    if let Some(structure) = &errors.structure {
        fill_structure(sample, structure);
    }
    sample.probe_seam_step = judged.probe_seam_step;
    if let Some(changes) = judged.changes {
        sample.source_changes_px = Some(changes.source);
        sample.met_changes_px = Some(changes.met);
    }
    if let Some(since) = judged.since {
        sample.since_frame = Some(since.frame);
        sample.temporal_difference = Some(since.change.difference);
        sample.temporal_change = Some(since.change.reference);
        sample.mask_temporal_difference = since.mask.map(|change| change.difference);
        sample.mask_temporal_change = since.mask.map(|change| change.reference);
    }
    if let Some(verdicts) = &judged.verdicts {
        let sum =
            |of: fn(&CauseTally) -> usize| Some(verdicts.iter().map(of).sum::<usize>() as u64);
        sample.false_accepts = sum(|v| v.false_accepts);
        sample.false_rejects = sum(|v| v.false_rejects);
        for verdict in verdicts {
            let name = verdict.name;
            sample.set_detail(
                &format!("false_accept_{name}_px"),
                verdict.false_accepts as f64,
            );
            sample.set_detail(
                &format!("false_reject_{name}_px"),
                verdict.false_rejects as f64,
            );
        }
    }
}

fn fill_structure(sample: &mut Sample, structure: &Structure) {
    sample.edge_flip = structure.edge_flip;
    sample.inner_flip = structure.inner_flip;
    let [thin, thicker, thickest] = structure.recall.map(|share| share.map(|s| 100.0 * s));
    sample.recall_1px_percent = thin;
    sample.recall_2px_percent = thicker;
    sample.recall_4px_percent = thickest;
    sample.seam_step = structure.seam_step;
    sample.error_length_px = structure.error_length_px;
    sample.stripes = structure.stripes;
}

/// Fills in the counted work of the passes of a frame.
pub(super) fn fill_counts(sample: &mut Sample, passes: &[PassCounts]) {
    for pass in passes {
        for (what, count) in pass.counts.named() {
            sample.set_detail(&format!("{}_{what}", pass.pass), count as f64);
        }
    }
    let all = passes.iter().map(|pass| pass.counts);
    let sum = all.fold(Counts::default(), Counts::plus);
    sample.march_steps = Some(sum.march_steps);
    sample.traversals = Some(sum.traversals);
    sample.visited_nodes = Some(sum.visited_nodes);
    sample.tested_triangles = Some(sum.tested_triangles);
}

/// Fills in the times and shares of one frame.
pub(super) fn timed(mut sample: Sample, stats: &FrameStats, repetition: u32) -> Sample {
    sample.repetition = repetition;
    sample.frame_ms = Some(stats.frame_ms);
    if !stats.passes_ms.is_empty() {
        sample.passes_ms = Some(stats.passes_total_ms());
        sample.reflection_ms = Some(passes::reflection_ms(&stats.passes_ms));
    }
    if !stats.processor_ms.is_empty() {
        sample.passes_cpu_ms = Some(stats.cost_ms());
        sample.reflection_cpu_ms = Some(passes::reflection_ms(&stats.processor_ms));
    }
    sample.tree_ms = stats.tree_ms;
    sample.rays = u64::from(stats.rays);
    sample.bytes = stats.bytes.iter().map(|(_, bytes)| bytes).sum();
    sample.reflective_px = stats.shares.reflective;
    let percent = |name: &str| {
        let share = stats.shares.sources.iter().find(|s| s.name == name);
        share.map_or(0.0, |s| s.percent)
    };
    sample.screen_percent = percent("screen");
    sample.traced_percent = percent("traced");
    sample.probe_percent = Some(percent("probe") + percent("far"));
    sample.probe_bytes = stats.captured().map(|(bytes, _)| bytes);
    sample.capture_ms = stats.captured().map(|(_, ms)| ms);
    if let Some(bytes) = stats.structure_bytes() {
        sample.structure_bytes = Some(bytes);
        sample.structures_ms = Some(stats.structures_ms);
        sample.structures_update_ms = Some(stats.structures_update_ms);
    }
    sample.failed_percent = percent("failed");
    sample.none_percent = percent("none");
    sample.rough_percent = percent("rough");
    if let Some(second) = stats.second_layer {
        sample.set_detail(BEHIND_COLUMN, f64::from(second.behind));
    }
    for (name, ms) in &stats.passes_ms {
        sample.set_detail(&pass_column(name), *ms);
    }
    for share in &stats.shares.causes {
        sample.set_detail(&format!("cause_{}_px", share.name), share.pixels as f64);
    }
    sample
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::detail_columns;
    use reflet_render::renderer::stats::Shares;
    use reflet_scene::desc::Method;

    #[test]
    fn smoothing_of_reflections_counts_as_reflection_time() {
        let passes_ms = [
            ("light", 1.0),
            ("ssr", 2.0),
            ("filter", 4.0),
            ("audit", 8.0),
        ];
        let stats = FrameStats {
            size: [1, 1],
            samples: 1,
            method: Method::Hybrid,
            unit_m: 1.0,
            shares: Shares::new(&[], [1, 1], Method::Hybrid),
            passes_ms: passes_ms.map(|(name, ms)| (name.to_owned(), ms)).to_vec(),
            frame_ms: 15.0,
            ..FrameStats::default()
        };
        let empty = Sample {
            detail: vec![0.0; detail_columns().len()],
            ..Sample::default()
        };
        let sample = timed(empty, &stats, 0);
        assert_eq!(sample.passes_ms, Some(15.0));
        assert_eq!(sample.reflection_ms, Some(6.0));
    }
}
