//! Groups of comparable samples, and the points made of them.

use std::collections::{BTreeMap, BTreeSet};

use super::{
    Group, Point, Spread, label,
    pairs::{FlickerRatio, common_pairs},
};
use crate::sample::Sample;

/// Sorts samples into groups and points, both in the order of their first sample.
pub fn groups(samples: &[Sample]) -> Vec<Group> {
    let mut groups: Vec<(String, Vec<&Sample>)> = Vec::new();
    for sample in samples {
        collect(&mut groups, group_key(sample), sample);
    }
    groups
        .into_iter()
        .map(|(_, samples)| group(&samples))
        .collect()
}

/// Key that is equal for points that may be compared: the content of the scene, the machine, the
/// reference with all settings that no parameter varies, and the choice of the varied parameter.
fn group_key(s: &Sample) -> String {
    format!(
        "{:?}",
        (
            (&s.scene, &s.content, &s.camera, s.width, s.height),
            (s.samples, s.exposure_ev, &s.tone_map),
            (&s.adapter, &s.driver, &s.backend, &s.timing),
            (&s.version, &s.commit, &s.os, &s.cpu),
            (s.reference_bounces, s.reference_ray_length_u),
            (s.roughness_cutoff, s.unit_m, s.fade, s.blur_px),
            &s.turn,
        )
    )
}

fn collect<'a>(groups: &mut Vec<(String, Vec<&'a Sample>)>, key: String, sample: &'a Sample) {
    match groups.iter_mut().find(|(known, _)| *known == key) {
        Some((_, members)) => members.push(sample),
        None => groups.push((key, vec![sample])),
    }
}

fn group(samples: &[&Sample]) -> Group {
    let mut variants: Vec<(String, Vec<&Sample>)> = Vec::new();
    let moves = samples.iter().any(|s| s.frame != samples[0].frame);
    let left_out = if moves {
        uncommon_frames(samples)
    } else {
        Vec::new()
    };
    for sample in samples.iter().filter(|s| !left_out.contains(&s.frame)) {
        let key = if moves {
            label(sample)
        } else {
            sample.fingerprint.clone()
        };
        collect(&mut variants, key, sample);
    }
    let pairs = common_pairs(samples);
    let mut over_frames = Vec::new();
    let (mut points, mut failed) = (Vec::new(), Vec::new());
    for (_, samples) in variants {
        let broken = samples.iter().find(|sample| !sample.is_ok());
        match (broken, Point::new(&samples)) {
            (Some(sample), _) => failed.push(((*sample).clone(), sample.status.clone())),
            (None, Some(point)) if moves => {
                over_frames.extend(by_frame(&samples));
                let flicker = FlickerRatio::from_pairs(&samples, &pairs);
                points.push(Point {
                    flicker,
                    ..point.averaged(&samples)
                });
            }
            (None, Some(point)) => points.push(point),
            (None, None) => failed.push((samples[0].clone(), "was not timed".to_owned())),
        }
    }
    share_common_passes(&mut points, samples);
    let masked = points.iter().all(|p| p.sample.mask_flip.is_some());
    Group {
        points,
        failed,
        masked,
        over_frames,
        left_out,
    }
}

/// Frames that some setting lacks, such as the frame at which a run was stopped: settings cannot be
/// compared over different frames.
fn uncommon_frames(samples: &[&Sample]) -> Vec<u32> {
    let settings: BTreeSet<String> = samples.iter().map(|s| label(s)).collect();
    let mut of_frame: BTreeMap<u32, BTreeSet<String>> = BTreeMap::new();
    for sample in samples {
        of_frame
            .entry(sample.frame)
            .or_default()
            .insert(label(sample));
    }
    let lacking = of_frame
        .iter()
        .filter(|(_, has)| has.len() < settings.len());
    lacking.map(|(frame, _)| *frame).collect()
}

/// The points of each frame of one setting.
fn by_frame(samples: &[&Sample]) -> Vec<(u32, Point)> {
    let mut frames: Vec<(String, Vec<&Sample>)> = Vec::new();
    for sample in samples {
        collect(&mut frames, sample.frame.to_string(), sample);
    }
    let point = |(_, samples): (String, Vec<&Sample>)| {
        Some((samples.first()?.frame, Point::new(&samples)?))
    };
    frames.into_iter().filter_map(point).collect()
}

/// Charges all points of one rendered size the same time for shadow, G-buffer, light and tone, which do the
/// same work whatever the method: their noise must not decide between methods.
fn share_common_passes(points: &mut [Point], samples: &[&Sample]) {
    for point in points {
        let scale = point.sample.scale;
        let common = |s: &&&Sample| Some(s.passes_ms? - s.reflection_ms?);
        let alike = samples.iter().filter(|s| s.scale == scale && s.is_ok());
        let common = Spread::from_values(alike.filter_map(|s| common(&s)).collect());
        if let (Some(common), Some(own)) = (common, point.reflection_ms) {
            let total = |ms: f64| ms + common.median;
            point.timed.iter_mut().for_each(|t| t.ms = total(t.ms));
            point.ms = Spread {
                n: own.n,
                median: total(own.median),
                p5_p95: own.p5_p95.map(|ends| ends.map(total)),
            };
        }
    }
}
