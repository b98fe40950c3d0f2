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

    fn key(at_s: f32, x: f32) -> KeyDesc {
        KeyDesc {
            at_s,
            value: Vec3::new(x, 0.0, 0.0),
            ease: Ease::None,
            handle_in: None,
            handle_out: None,
            at: Default::default(),
        }
    }

    fn x(desc: &TrackDesc, time_s: f64) -> f32 {
        Track::new(desc, |_| None)
            .value_at(time_s, Vec3::ZERO, None)
            .x
    }

    fn with(keys: Vec<KeyDesc>, curve: CurveKind) -> TrackDesc {
        TrackDesc {
            keys,
            curve,
            ..TrackDesc::default()
        }
    }

    const CURVES: [CurveKind; 5] = [
        CurveKind::Step,
        CurveKind::Linear,
        CurveKind::CatmullRom,
        CurveKind::Centripetal,
        CurveKind::Bezier,
    ];

    #[test]
    fn every_curve_meets_its_keys_and_holds_the_ends() {
        for curve in CURVES {
            for loop_s in [None, Some(5.0)] {
                let track = TrackDesc {
                    loop_s,
                    ..with(vec![key(1.0, 2.0), key(2.0, 5.0), key(4.0, -1.0)], curve)
                };
                for (time, value) in [(1.0, 2.0), (2.0, 5.0), (4.0, -1.0)] {
                    let got = x(&track, time);
                    assert!((got - value).abs() < 1e-5, "{curve:?} {time}: {got}");
                }
                if loop_s.is_none() {
                    assert_eq!((x(&track, -9.0), x(&track, 99.0)), (2.0, -1.0));
                } else {
                    for time in [0.5, 1.7, 4.5] {
                        let (a, b) = (x(&track, time), x(&track, time + 15.0));
                        assert!((a - b).abs() < 1e-4, "{curve:?} {time}: {a} {b}");
                    }
                }
            }
        }
    }

    #[test]
    fn smooth_loops_have_no_corner_where_they_close() {
        for curve in [CurveKind::CatmullRom, CurveKind::Centripetal] {
            let track = TrackDesc {
                loop_s: Some(4.0),
                ..with(
                    vec![key(0.0, 0.0), key(1.0, 1.0), key(2.0, 0.5), key(3.0, -1.0)],
                    curve,
                )
            };
            let step = 1e-3;
            let before = f64::from(x(&track, 4.0) - x(&track, 4.0 - step)) / step;
            let after = f64::from(x(&track, 4.0 + step) - x(&track, 4.0)) / step;
            // The centripetal tangent keeps its direction; its length follows the pieces.
            assert!(before > 0.0 && after > 0.0, "{curve:?} {before} {after}");
            if curve == CurveKind::CatmullRom {
                assert!((before - after).abs() < 0.01, "{before} {after}");
            }
        }
    }

    #[test]
    fn uneven_keys_make_no_jump_of_the_speed() {
        let keys = || vec![key(0.0, 0.0), key(1.0, 1.0), key(5.0, 2.0), key(6.0, 3.0)];
        for loop_s in [None, Some(9.0)] {
            let track = TrackDesc {
                loop_s,
                ..with(keys(), CurveKind::CatmullRom)
            };
            let step = 1e-3;
            for time in [1.0, 5.0] {
                let before = f64::from(x(&track, time) - x(&track, time - step)) / step;
                let after = f64::from(x(&track, time + step) - x(&track, time)) / step;
                // The mean speed from key to key: 2 m in 5 s.
                assert!((before - 0.4).abs() < 0.01, "{time}: {before}");
                assert!((after - 0.4).abs() < 0.01, "{time}: {after}");
            }
        }
    }

    #[test]
    fn constant_speed_ignores_the_times_between() {
        let track = TrackDesc {
            constant_speed: true,
            ..with(
                vec![key(0.0, 0.0), key(0.1, 1.0), key(10.0, 10.0)],
                CurveKind::Linear,
            )
        };
        for time in [0.0, 2.5, 5.0, 7.5, 10.0] {
            assert!((f64::from(x(&track, time)) - time).abs() < 1e-5);
        }
    }

    #[test]
    fn easing_keeps_the_ends_and_bends_the_middle() {
        for (ease, quarter) in [
            (Ease::None, 0.25),
            (Ease::In, 0.0625),
            (Ease::Out, 0.4375),
            (Ease::InOut, 0.15625),
        ] {
            let whole = TrackDesc {
                ease,
                ..with(vec![key(0.0, 0.0), key(1.0, 1.0)], CurveKind::Linear)
            };
            let mut one = whole.clone();
            one.ease = Ease::None;
            one.keys[0].ease = ease;
            for track in [whole, one] {
                assert_eq!((x(&track, 0.0), x(&track, 1.0)), (0.0, 1.0));
                assert!((x(&track, 0.25) - quarter).abs() < 1e-6, "{ease:?}");
            }
        }
    }

    #[test]
    fn bezier_handles_bend_the_way() {
        let mut track = with(vec![key(0.0, 0.0), key(1.0, 1.0)], CurveKind::Bezier);
        assert!((x(&track, 0.3) - 0.3).abs() < 1e-6, "straight by default");
        track.keys[0].handle_out = Some(Vec3::ZERO);
        track.keys[1].handle_in = Some(Vec3::ZERO);
        // 3u² − 2u³ at 0.25.
        assert!((x(&track, 0.25) - 0.15625).abs() < 1e-6);
    }

    #[test]
    fn helpers_add_to_the_base() {
        let orbit = OrbitDesc {
            center: Vec3::new(1.0, 0.0, 0.0),
            axis: Vec3::Y,
            period_s: 4.0,
            phase: 0.0,
        };
        let track = TrackDesc {
            orbit: Some(orbit),
            ..TrackDesc::default()
        };
        let at = Track::new(&track, |_| None).value_at(1.0, Vec3::new(3.0, 5.0, 0.0), None);
        // A quarter turn, counterclockwise seen from above: +X goes to −Z.
        assert!(at.distance(Vec3::new(1.0, 5.0, -2.0)) < 1e-5, "{at}");
        let track = TrackDesc {
            rate: Some(Vec3::X),
            oscillate: Some(crate::desc::OscillateDesc {
                amplitude: Vec3::new(0.5, 0.0, 0.0),
                period_s: 2.0,
                phase: 0.25,
            }),
            ..TrackDesc::default()
        };
        let at = Track::new(&track, |_| None).value_at(2.0, Vec3::new(10.0, 0.0, 0.0), None);
        assert!((at.x - 12.5).abs() < 1e-6, "{at}");
    }
}
