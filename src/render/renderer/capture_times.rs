//! Times of the capture of probes, which are not part of a frame's times.

use crate::{
    passes::named,
    pipeline::{pass::PassGroup, recorder::PassTimes},
};

/// Times of the capture of probes, milliseconds.
#[derive(Clone, Copy, Debug, Default)]
pub struct CaptureTimes {
    /// GPU time, or wall time of passes that were waited for.
    pub passes_ms: f64,
    /// CPU time where it is known, else the same.
    pub cost_ms: f64,
}

/// Splits the times of a frame into its own and the times of its capture.
pub fn without_capture(times: PassTimes) -> (PassTimes, CaptureTimes) {
    let is_capture = |name: &str| named(name).is_some_and(|p| p.group == PassGroup::Capture);
    let split = |times: Vec<(String, f64)>| {
        let (capture, frame): (Vec<_>, Vec<_>) =
            times.into_iter().partition(|(name, _)| is_capture(name));
        (frame, capture.iter().map(|(_, ms)| ms).sum::<f64>())
    };
    let has_processor = !times.processor_ms.is_empty();
    let (passes_ms, passes) = split(times.passes_ms);
    let (processor_ms, processor) = split(times.processor_ms);
    let captured = CaptureTimes {
        passes_ms: passes,
        cost_ms: if has_processor { processor } else { passes },
    };
    let frame = PassTimes {
        passes_ms,
        processor_ms,
    };
    (frame, captured)
}
