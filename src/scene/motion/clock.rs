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

    /// Speed, start and repeat of an animation of 2 s; then scene times, each with the expected animation time.
    const CASES: &str = "
        1 0 once: 0>0 1.5>1.5 2>2 9>2
        1 0 looped: 0>0 1.5>1.5 2>0 9.5>1.5
        1 0 back: 0>0 2>2 2.5>1.5 4.5>0.5
        2 1 once: 0.5>0 1>0 1.5>1 3>2
        1 -0.5 looped: 0>0.5 1>1.5 1.5>0 2>0.5
        -1 1 once: 0>2 1>2 2.5>0.5 9>0
        -1 0 looped: 0>2 0.5>1.5 1.5>0.5 2.5>1.5
        -1 0 back: 0>2 0.5>1.5 2>0 2.5>0.5
        0 0 looped: 0>0 1>0 2>0 3>0";

    #[test]
    fn clock_applies_speed_offset_and_repeat() {
        let number = |text: &str| text.parse::<f64>().expect("a number");
        for case in CASES.trim_start().lines() {
            let (settings, times) = case.split_once(": ").expect("times");
            let settings: Vec<&str> = settings.split_whitespace().collect();
            let desc = AnimationDesc {
                speed: number(settings[0]) as f32,
                start_s: number(settings[1]) as f32,
                repeat: match settings[2] {
                    "once" => Playback::Once,
                    "looped" => Playback::Loop,
                    _ => Playback::PingPong,
                },
                ..AnimationDesc::endless(Vec::new())
            };
            for pair in times.split(' ') {
                let (time, expected) = pair.split_once('>').expect("a pair");
                let got = desc.local_s(number(time), 2.0);
                assert!(
                    (got - number(expected)).abs() < 1e-12,
                    "{case}, {time}: {got}"
                );
            }
            assert_eq!(desc.local_s(3.0, 0.0), 0.0);
        }
    }
}
