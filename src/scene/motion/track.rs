//! Value of one track at one time: keys, curves, easing, orbit, rate and oscillation, as pure functions.

use glam::{Affine3A, DQuat, DVec3, Vec3};

use crate::desc::{CurveKind, Ease, KeyDesc, OrbitDesc, TrackDesc};
use reflet_base::math::spline::{
    ArcLength, bezier, catmull_rom, centripetal, ease_in, ease_in_out, ease_out,
};

/// Number of chords that approximate the length of one piece between two keys.
const CHORDS: usize = 256;

/// A track prepared for evaluation: lengths measured, names resolved.
#[derive(Clone, Debug)]
pub struct Track<'a> {
    desc: &'a TrackDesc,
    /// Arc lengths along the keys, for constant speed.
    arc: Option<ArcLength>,
    /// Index of the node that it follows.
    follow: Option<usize>,
}

/// Value of the keys of a track at a time, seconds, without added noise or waves; 0 without keys.
pub fn key_value(desc: &TrackDesc, time_s: f64) -> Vec3 {
    if desc.keys.is_empty() {
        return Vec3::ZERO;
    }
    let track = Track::new(desc, |_| None);
    Keys(desc).value_at(time_s, track.arc.as_ref()).as_vec3()
}

impl<'a> Track<'a> {
    /// Prepares a track; `find` gives the index of the node of a name.
    pub fn new(desc: &'a TrackDesc, find: impl Fn(&str) -> Option<usize>) -> Self {
        let keys = Keys(desc);
        let arc = (desc.constant_speed && desc.keys.len() > 1).then(|| {
            ArcLength::measure(CHORDS * keys.pieces(), |share| {
                keys.on_curve(share * keys.pieces() as f64)
            })
        });
        let follow = desc.follow.as_ref().and_then(|f| find(&f.instance.value));
        Self { desc, arc, follow }
    }

    /// Whether the track's value replaces the thing's own, instead of being added to it.
    pub fn is_absolute(&self) -> bool {
        !self.desc.keys.is_empty()
    }

    /// Index of the instance or group whose position the track takes.
    pub fn followed(&self) -> Option<usize> {
        self.follow
    }

    /// Value at a time, seconds; `base` is the value in the thing's own table, `followed` is the pose of the
    /// followed node at that time.
    pub fn value_at(&self, time_s: f64, base: Vec3, followed: Option<Affine3A>) -> Vec3 {
        let desc = self.desc;
        let mut value = base.as_dvec3();
        if !desc.keys.is_empty() {
            value = Keys(desc).value_at(time_s, self.arc.as_ref());
        } else if let (Some(followed), Some(follow)) = (followed, &desc.follow) {
            value = followed.transform_point3(follow.offset).as_dvec3();
        }
        if let Some(orbit) = &desc.orbit {
            value = on_orbit(orbit, value, time_s);
        }
        if let Some(rate) = desc.rate {
            value += rate.as_dvec3() * time_s;
        }
        if let Some(swing) = &desc.oscillate {
            let turns = time_s / f64::from(swing.period_s) + f64::from(swing.phase);
            value += swing.amplitude.as_dvec3() * (std::f64::consts::TAU * turns.fract()).sin();
        }
        value.as_vec3()
    }
}

fn on_orbit(orbit: &OrbitDesc, position: DVec3, time_s: f64) -> DVec3 {
    let center = orbit.center.as_dvec3();
    let turns = time_s / f64::from(orbit.period_s) + f64::from(orbit.phase);
    let axis = orbit.axis.as_dvec3().normalize();
    let turn = DQuat::from_axis_angle(axis, std::f64::consts::TAU * turns.fract());
    center + turn * (position - center)
}

fn eased(ease: Ease, u: f64) -> f64 {
    match ease {
        Ease::None => u,
        Ease::In => ease_in(u),
        Ease::Out => ease_out(u),
        Ease::InOut => ease_in_out(u),
    }
}

/// The keys of a track; there is at least one.
struct Keys<'a>(&'a TrackDesc);

impl Keys<'_> {
    /// Number of pieces between keys, including the piece that closes a loop.
    fn pieces(&self) -> usize {
        let count = self.0.keys.len();
        if self.0.loop_s.is_some() && count > 1 {
            count
        } else {
            count - 1
        }
    }

    /// Key at an index, which wraps around a loop, or is clamped to the first and last key of an open path.
    fn key(&self, index: isize) -> &KeyDesc {
        let count = self.0.keys.len() as isize;
        let index = if self.0.loop_s.is_some() {
            index.rem_euclid(count)
        } else {
            index.clamp(0, count - 1)
        };
        &self.0.keys[index as usize]
    }

    fn point(&self, index: isize) -> DVec3 {
        self.key(index).value.as_dvec3()
    }

    /// Time of a key, seconds; beyond the last key the end of the loop.
    fn time(&self, index: usize) -> f64 {
        let keys = &self.0.keys;
        match (keys.get(index), self.0.loop_s) {
            (Some(key), _) => f64::from(key.at_s),
            (None, Some(loop_s)) => f64::from(keys[0].at_s) + f64::from(loop_s),
            (None, None) => f64::from(keys[keys.len() - 1].at_s),
        }
    }

    fn value_at(&self, time_s: f64, arc: Option<&ArcLength>) -> DVec3 {
        let pieces = self.pieces();
        if pieces == 0 {
            return self.point(0);
        }
        let (start, end) = (self.time(0), self.time(pieces));
        let share = match self.0.loop_s {
            Some(_) => ((time_s - start) / (end - start)).rem_euclid(1.0),
            None => ((time_s - start) / (end - start)).clamp(0.0, 1.0),
        };
        let share = eased(self.0.ease, share);
        if let Some(arc) = arc {
            return self.on_curve(arc.parameter(share) * pieces as f64);
        }
        let time = start + share * (end - start);
        let after = (1..pieces).find(|i| time < self.time(*i)).unwrap_or(pieces);
        let (a, b) = (self.time(after - 1), self.time(after));
        let u = ((time - a) / (b - a)).clamp(0.0, 1.0);
        self.on_piece(after - 1, eased(self.0.keys[after - 1].ease, u))
    }

    /// Point at a parameter whose whole part is the piece and whose fraction is the place in it.
    fn on_curve(&self, parameter: f64) -> DVec3 {
        let last = self.pieces() - 1;
        let piece = (parameter.max(0.0) as usize).min(last);
        self.on_piece(piece, parameter - piece as f64)
    }

    fn on_piece(&self, piece: usize, u: f64) -> DVec3 {
        let i = piece as isize;
        let (a, b) = (self.point(i), self.point(i + 1));
        match self.0.curve {
            CurveKind::Step if u < 1.0 => a,
            CurveKind::Step => b,
            CurveKind::Linear => a.lerp(b, u),
            CurveKind::CatmullRom => catmull_rom(self.neighbors(i), self.times(i), u),
            CurveKind::Centripetal => centripetal(self.neighbors(i), u),
            CurveKind::Bezier => {
                let third = (b - a) / 3.0;
                let out = self.key(i).handle_out.map_or(third, |h| h.as_dvec3());
                let into = self.key(i + 1).handle_in.map_or(-third, |h| h.as_dvec3());
                bezier([a, a + out, b + into, b], u)
            }
        }
    }

    /// Durations of the pieces before, at and after a piece: its own again beyond the ends of an open path, and
    /// all equal if the speed is constant whatever the times of keys.
    fn times(&self, i: isize) -> [f64; 3] {
        let count = self.pieces() as isize;
        let is_loop = self.0.loop_s.is_some();
        [i - 1, i, i + 1].map(|piece| {
            let piece = match is_loop {
                true => piece.rem_euclid(count),
                false if (0..count).contains(&piece) => piece,
                false => i,
            } as usize;
            if self.0.constant_speed {
                1.0
            } else {
                self.time(piece + 1) - self.time(piece)
            }
        })
    }

    /// The four points around a piece; beyond the ends of an open path the missing one continues it straight.
    fn neighbors(&self, i: isize) -> [DVec3; 4] {
        let (a, b) = (self.point(i), self.point(i + 1));
        let (mut before, mut after) = (self.point(i - 1), self.point(i + 2));
        if self.0.loop_s.is_none() {
            if i == 0 {
                before = a * 2.0 - b;
            }
            if i + 2 >= self.0.keys.len() as isize {
                after = b * 2.0 - a;
            }
        }
        [before, a, b, after]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::Scene;

    /// Seconds over which a speed is measured.
    const STEP_S: f64 = 1e-3;

    #[test]
    fn tracks_have_their_values_and_speeds() {
        let cases = include_str!("track_cases.txt").lines();
        let cases: Vec<_> = cases
            .filter(|l| !l.is_empty() && !l.starts_with('#'))
            .collect();
        assert_eq!(cases.len(), 27);
        for case in cases {
            let (track, outcomes) = case.split_once(" => ").expect(case);
            let numbers = |text: &str| -> Vec<f64> {
                let words = text.split([' ', ',']);
                words.map(|word| word.parse().expect(case)).collect()
            };
            let (track, base) = track.split_once(" @ ").unwrap_or((track, "0 0 0"));
            let base = DVec3::from_slice(&numbers(base)).as_vec3();
            let text = format!("version = 1\n[camera.a]\n[motion.camera.a]\neye = {{ {track} }}\n");
            let read = Scene::from_text(&text, "a.toml".as_ref(), &[]);
            let (scene, _) = read.unwrap_or_else(|mistakes| panic!("{case}: {mistakes:?}"));
            let (_, desc) = &scene.motion.cameras[0].value.tracks[0];
            let track = Track::new(desc, |_| None);
            let at = |time_s: f64| track.value_at(time_s, base, None).as_dvec3();
            for outcome in outcomes.split(' ') {
                let sign = outcome.find([':', '~', '/']).expect(case);
                let (time, rest) = (numbers(&outcome[..sign])[0], &outcome[sign + 1..]);
                let speed = |from: f64| (at(from + STEP_S).x - at(from).x) / STEP_S;
                let [before, after] = [time - STEP_S, time].map(speed);
                let is_right = match (&outcome[sign..=sign], rest) {
                    ("/", "+") => before > 0.0 && after > 0.0,
                    ("/", rest) => {
                        let expected = numbers(rest)[0];
                        (before - expected).abs().max((after - expected).abs()) < 0.01
                    }
                    ("~", rest) => at(time).distance(at(numbers(rest)[0])) < 1e-4,
                    (_, rest) => {
                        let expected = numbers(rest).into_iter();
                        let found = at(time).to_array().into_iter();
                        found.zip(expected).all(|(a, b)| (a - b).abs() < 1e-5)
                    }
                };
                assert!(
                    is_right,
                    "{outcome}, found {}, {before}, {after}: {case}",
                    at(time)
                );
            }
        }
    }
}
