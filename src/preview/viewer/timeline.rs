//! The timeline: the current frame. While playing it follows the wall clock, so that slow
//! frames are skipped and time keeps its pace.

use std::collections::VecDeque;

use reflet_scene::desc::TimelineDesc;

/// Window of the frame rate measurement, seconds.
const COUNTED_S: f64 = 2.0;
/// Below this fraction of the scene's rate, skipped frames are reported.
const KEEPS_UP: f64 = 0.9;

/// Current frame and playback state.
#[derive(Clone, Debug)]
pub struct Timeline {
    desc: TimelineDesc,
    frame: u32,
    /// Start time of playback, seconds, and its first frame; `None` while paused.
    since: Option<(f64, u32)>,
    /// Whether playback loops.
    pub repeats: bool,
    /// Times at which frames of this playback were shown, seconds.
    shown: VecDeque<f64>,
}

impl Timeline {
    /// Paused at the first frame.
    pub fn new(desc: &TimelineDesc) -> Self {
        Self {
            desc: desc.clone(),
            frame: desc.start,
            since: None,
            repeats: true,
            shown: VecDeque::new(),
        }
    }

    /// Adopts the timeline of a reloaded scene; frame, pause and loop stay.
    pub fn replace(&mut self, desc: &TimelineDesc, now_s: f64) {
        if self.desc != *desc {
            self.desc = desc.clone();
            self.seek(self.frame, now_s);
        }
    }

    /// Adopts the timeline after a scene without one: continues where it was.
    fn resume(&mut self, desc: &TimelineDesc, now_s: f64) {
        self.desc = desc.clone();
        self.seek(self.frame, now_s);
    }

    /// Current frame.
    pub fn frame(&self) -> u32 {
        self.frame
    }

    /// Whether it is playing.
    pub fn is_playing(&self) -> bool {
        self.since.is_some()
    }

    /// Duration of a frame, seconds.
    pub fn frame_s(&self) -> f64 {
        1.0 / f64::from(self.desc.fps)
    }

    /// Plays or pauses; at the end it plays from the start.
    pub fn toggle(&mut self, now_s: f64) {
        self.shown.clear();
        if self.since.take().is_none() {
            if self.frame == self.desc.end && !self.repeats {
                self.frame = self.desc.start;
            }
            self.since = Some((now_s, self.frame));
        }
    }

    /// Seeks to a frame; playback continues from there.
    pub fn seek(&mut self, frame: u32, now_s: f64) {
        self.frame = frame.clamp(self.desc.start, self.desc.end);
        self.shown.clear();
        self.since = self.since.map(|_| (now_s, self.frame));
    }

    /// Pauses and steps by frames; wraps around with loop.
    pub fn step(&mut self, by: i64) {
        self.since = None;
        self.frame = self.after(self.frame, by).0;
    }

    /// First frame.
    pub fn start(&self) -> u32 {
        self.desc.start
    }

    /// Last frame.
    pub fn end(&self) -> u32 {
        self.desc.end
    }

    /// The frame `by` frames after another, and whether the end was passed without loop.
    pub(crate) fn after(&self, frame: u32, by: i64) -> (u32, bool) {
        let [start, end] = [self.desc.start, self.desc.end].map(i64::from);
        let frame = i64::from(frame) + by;
        if self.repeats {
            let around = (frame - start).rem_euclid(end - start + 1);
            ((start + around) as u32, false)
        } else {
            (frame.clamp(start, end) as u32, frame > end)
        }
    }

    /// Advances to the clock; returns the seconds until the next frame, `None` while paused.
    pub fn tick(&mut self, now_s: f64) -> Option<f64> {
        let (since_s, from) = self.since?;
        let frames = (now_s - since_s).max(0.0) * f64::from(self.desc.fps);
        let (frame, is_over) = self.after(from, frames as i64);
        self.frame = frame;
        if is_over {
            self.since = None;
            return None;
        }
        Some((1.0 - frames.fract()) * self.frame_s())
    }

    /// Counts a frame that was shown.
    pub fn count(&mut self, now_s: f64) {
        if self.is_playing() {
            self.shown.push_back(now_s);
            while self.shown.front().is_some_and(|t| now_s - t > COUNTED_S) {
                self.shown.pop_front();
            }
        }
    }

    /// Shown frames per second, once it has played long enough to measure.
    pub fn rate(&self, now_s: f64) -> Option<f64> {
        let played_s = now_s - self.since?.0;
        let lately = self.shown.iter().filter(|t| now_s - **t < COUNTED_S);
        (played_s >= COUNTED_S).then(|| lately.count() as f64 / COUNTED_S)
    }

    /// The rate as text.
    pub fn pace(&self, now_s: f64) -> String {
        let fps = self.desc.fps;
        match self.rate(now_s) {
            Some(rate) if rate < KEEPS_UP * f64::from(fps) => {
                format!("{rate:.1} of {fps} fps: frames are dropped")
            }
            _ => format!("{fps} fps"),
        }
    }
}

/// Follows a reloaded scene: the timeline is stored while the scene has none, so that time,
/// pause and loop are restored when it comes back.
pub fn follow(
    shown: &mut Option<Timeline>,
    hidden_timeline: &mut Option<Timeline>,
    desc: Option<&TimelineDesc>,
    now_s: f64,
) {
    match (desc, &mut *shown) {
        (Some(desc), Some(timeline)) => timeline.replace(desc, now_s),
        (Some(desc), None) => {
            let mut timeline = hidden_timeline
                .take()
                .unwrap_or_else(|| Timeline::new(desc));
            timeline.resume(desc, now_s);
            *shown = Some(timeline);
        }
        (None, Some(_)) => *hidden_timeline = shown.take(),
        (None, None) => {}
    }
}
