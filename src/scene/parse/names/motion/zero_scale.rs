//! Rejects scale tracks that pass through 0: the model would turn inside out between two frames, and
//! vanish in a frame at 0.

use crate::table::report::Report;
use crate::{
    desc::{CurveKind, InstanceMotionDesc, KeyDesc, PlacementDesc, TimelineDesc, TrackDesc},
    diagnostic::{Diagnostic, Span},
    motion::track::Track,
};

/// Number of times per frame at which a track is sampled.
const STEPS: u32 = 8;
/// Largest number of such times in a timeline.
const MOST_STEPS: u32 = 1 << 16;

/// Refuses a track of `scale` that is 0 or passes through 0; `placement` is the moving thing's.
pub fn check(
    timeline: Option<&TimelineDesc>,
    placement: &PlacementDesc,
    motion: &InstanceMotionDesc,
    at: &Span,
    report: &mut Report,
) {
    let Some(track) = &motion.scale else {
        return;
    };
    if let Some(key) = track
        .keys
        .iter()
        .find(|key| key.value.abs().min_element() == 0.0)
    {
        let help = "it would flatten the model; for growth, start from a small scale, such as \
                    at 0.001";
        let message = "a key of `scale` must not be 0";
        report.push(Diagnostic::new("singular", key.at.clone(), message).help(help));
        return;
    }
    if track.curve == CurveKind::Step && !track.keys.is_empty() {
        return; // a step curve jumps over 0
    }
    let help = "write sizes of one sign; to mirror a model, write `curve = \"step\"`";
    if let Some([before, key]) = between_keys(track) {
        let message = "`scale` passes through 0 before this key";
        let error = Diagnostic::new("passes-zero", key.at.clone(), message).help(help);
        report.push(error.related(before.at.clone(), "the previous key is here"));
    } else if let Some(time_s) = on_the_way(timeline, placement, track) {
        let message = format!("`scale` passes 0 at about {time_s:.2} s");
        report.push(Diagnostic::new("passes-zero", at.clone(), message).help(help));
    }
}

/// Two successive keys whose values differ in sign; in a loop, the first key also comes after the
/// last.
fn between_keys(track: &TrackDesc) -> Option<[&KeyDesc; 2]> {
    (0..3).find_map(|axis| {
        let keys = &track.keys;
        let back = track.loop_s.and(keys.first());
        let mut pairs = keys.iter().zip(keys.iter().skip(1).chain(back));
        let passes = |(a, b): &(&KeyDesc, &KeyDesc)| a.value[axis] * b.value[axis] < 0.0;
        pairs.find(passes).map(|(a, b)| [a, b])
    })
}

/// Time in the timeline at which the track passes through 0 by its curve, rate or oscillation, seconds.
fn on_the_way(
    timeline: Option<&TimelineDesc>,
    placement: &PlacementDesc,
    track: &TrackDesc,
) -> Option<f64> {
    let timeline = timeline?;
    let PlacementDesc::Trs { scale: base, .. } = *placement else {
        return None;
    };
    let ready = Track::new(track, |_| None);
    let time = |frame: u32| f64::from(frame) / f64::from(timeline.fps);
    let (start, end) = (time(timeline.start), time(timeline.end));
    let frames = timeline.end - timeline.start;
    let steps = frames.saturating_mul(STEPS).min(MOST_STEPS);
    let times = (0..=steps).map(|step| {
        let share = f64::from(step) / f64::from(steps.max(1));
        start + share * (end - start)
    });
    let signs = |time_s: f64| {
        ready
            .value_at(time_s, base, None)
            .to_array()
            .map(f32::signum)
    };
    let first = signs(start);
    times
        .map(|time_s| (time_s, signs(time_s)))
        .find_map(|(time_s, now)| (now != first).then_some(time_s))
}
