//! Conversion from the scene's time to the time inside an animation.

use crate::desc::{AnimationDesc, Playback};

impl AnimationDesc {
    /// Time inside an animation of length `duration_s` at the scene time `time_s`, both seconds.
    pub fn local_s(&self, time_s: f64, duration_s: f64) -> f64 {
        let elapsed = (time_s - f64::from(self.start_s)).max(0.0);
        let speed = f64::from(self.speed);
        let start = if speed < 0.0 { duration_s } else { 0.0 };
        let run = start + elapsed * speed;
        match self.repeat {
            _ if duration_s <= 0.0 => 0.0,
            Playback::Once => run.clamp(0.0, duration_s),
            // The end and the start of a loop are one moment; at first show the start.
            Playback::Loop if elapsed == 0.0 => start,
            Playback::Loop => run.rem_euclid(duration_s),
            Playback::PingPong => {
                let there_and_back = run.rem_euclid(2.0 * duration_s);
                there_and_back.min(2.0 * duration_s - there_and_back)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clock_applies_speed_offset_and_repeat() {
        let (once, looped, back) = (Playback::Once, Playback::Loop, Playback::PingPong);
        // Speed, start, repeat; then scene times and expected animation times, for an animation of 2 s.
        for (speed, start_s, repeat, times) in [
            (
                1.0,
                0.0,
                once,
                [(0.0, 0.0), (1.5, 1.5), (2.0, 2.0), (9.0, 2.0)],
            ),
            (
                1.0,
                0.0,
                looped,
                [(0.0, 0.0), (1.5, 1.5), (2.0, 0.0), (9.5, 1.5)],
            ),
            (
                1.0,
                0.0,
                back,
                [(0.0, 0.0), (2.0, 2.0), (2.5, 1.5), (4.5, 0.5)],
            ),
            (
                2.0,
                1.0,
                once,
                [(0.5, 0.0), (1.0, 0.0), (1.5, 1.0), (3.0, 2.0)],
            ),
            (
                1.0,
                -0.5,
                looped,
                [(0.0, 0.5), (1.0, 1.5), (1.5, 0.0), (2.0, 0.5)],
            ),
            (
                -1.0,
                1.0,
                once,
                [(0.0, 2.0), (1.0, 2.0), (2.5, 0.5), (9.0, 0.0)],
            ),
            (
                -1.0,
                0.0,
                looped,
                [(0.0, 2.0), (0.5, 1.5), (1.5, 0.5), (2.5, 1.5)],
            ),
            (
                -1.0,
                0.0,
                back,
                [(0.0, 2.0), (0.5, 1.5), (2.0, 0.0), (2.5, 0.5)],
            ),
            (
                0.0,
                0.0,
                looped,
                [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (3.0, 0.0)],
            ),
        ] {
            let desc = AnimationDesc {
                speed,
                start_s,
                repeat,
                ..AnimationDesc::endless(Vec::new())
            };
            for (time, expected) in times {
                let got = desc.local_s(time, 2.0);
                assert!((got - expected).abs() < 1e-12, "{desc:?} {time}: {got}");
            }
            assert_eq!(desc.local_s(3.0, 0.0), 0.0);
        }
    }
}
