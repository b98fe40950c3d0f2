//! `check`: reads a scene, loads what it refers to and poses its frames.

use std::{
    ops::RangeInclusive,
    time::{Duration, Instant},
};

use super::{args::CheckArgs, error::AppError, print_out, scene::load_scene};
use crate::{
    scene::{
        diagnostic::{Diagnostic, printable},
        stages::Animator,
    },
    world::World,
};

/// Time budget for posing frames; most errors of scripts and tracks show in a few frames.
const POSING: Duration = Duration::from_secs(2);
/// Maximum number of displayed lines printed by a script in its frames.
const MOST_LINES: usize = 100;

/// Reports every problem of a scene.
///
/// # Errors
/// [`AppError::Scene`] with them.
pub fn check(args: &CheckArgs) -> Result<(), AppError> {
    let mut loaded = load_scene(Some(&args.scene), &args.from, &[])?;
    let animator = Animator::new(&loaded.scene);
    let first = loaded.scene.first_frame();
    let last = loaded.scene.timeline.as_ref().map_or(first, |t| t.end);
    let mut log = Log::default();
    let posed = pose_all(&animator, &mut loaded.world, first..=last, &mut log);
    log.print();
    let posed = posed?;
    let all = last - first + 1;
    let frames = match posed {
        _ if all == 1 => String::new(),
        posed if posed == all => format!(", {all} frames"),
        posed => format!(
            ", {posed} of {all} frames in {} s, spread over all",
            POSING.as_secs()
        ),
    };
    let warnings = match loaded.warnings.len() {
        0 => String::new(),
        1 => ", 1 warning".to_owned(),
        n => format!(", {n} warnings"),
    };
    print_out(&format!("{}: ok{frames}{warnings}\n", loaded.name))
}

/// Output of the script in the first frames, truncated.
#[derive(Default)]
struct Log {
    lines: Vec<(u32, String)>,
    num_more: usize,
}

impl Log {
    fn add(&mut self, frame: u32, lines: Vec<String>) {
        let lines = lines.into_iter().map(|line| (frame, line));
        self.lines.extend(lines);
        self.lines.sort_by_key(|(frame, _)| *frame);
        self.num_more += self.lines.len().saturating_sub(MOST_LINES);
        self.lines.truncate(MOST_LINES);
    }

    fn print(&self) {
        for (frame, line) in &self.lines {
            eprintln!("frame {frame}: {}", printable(line));
        }
        if self.num_more > 0 {
            eprintln!("and {} more lines of the script", self.num_more);
        }
    }
}

/// Poses frames within the time budget, at least the first and the last unless a script exceeds a
/// limit; returns their number. Script output is added to `log`.
fn pose_all(
    animator: &Animator,
    world: &mut World,
    frames: RangeInclusive<u32>,
    log: &mut Log,
) -> Result<u32, AppError> {
    let started = Instant::now();
    let (first, last) = (*frames.start(), *frames.end());
    let mut wrong: Vec<(u32, Diagnostic)> = Vec::new();
    let mut posed = 0;
    for frame in spread(first, last) {
        let is_end = frame == first || frame == last;
        // A frame that exceeded a limit may have used all its time; the last one would too.
        let met_limit = wrong.iter().any(|(_, e)| e.name == "script-limit");
        if met_limit || (!is_end && started.elapsed() > POSING) {
            break;
        }
        posed += 1;
        let done = animator.pose(frame).and_then(|state| {
            world.apply(&state)?;
            log.add(frame, state.log);
            Ok(())
        });
        for error in done.err().into_iter().flatten() {
            let same = wrong
                .iter_mut()
                .find(|(_, known)| known.name == error.name && known.span == error.span);
            match same {
                Some(known) if known.0 <= frame => {}
                Some(known) => *known = (frame, error),
                None => wrong.push((frame, error)),
            }
        }
    }
    wrong.sort_by_key(|(frame, _)| *frame);
    match wrong.is_empty() {
        true => Ok(posed),
        false => Err(AppError::Scene(wrong.into_iter().map(|(_, e)| e).collect())),
    }
}

/// Both ends, then successively finer steps between them; each frame once.
fn spread(first: u32, last: u32) -> impl Iterator<Item = u32> {
    let length = last - first;
    let most = u32::BITS - length.leading_zeros();
    let steps = (0..most).rev().map(|bit| 1_u32 << bit);
    let between = steps.flat_map(move |step| {
        let odd = (u64::from(step)..u64::from(length)).step_by(2 * step as usize);
        odd.map(move |offset| first + offset as u32)
    });
    let ends = [Some(first), (last > first).then_some(last)];
    ends.into_iter().flatten().chain(between)
}

#[cfg(test)]
mod tests {
    use super::{Log, MOST_LINES, spread};

    #[test]
    fn script_log_keeps_only_shown_lines() {
        let mut log = Log::default();
        for frame in [9, 0, 5, 3] {
            log.add(frame, vec!["line".to_owned(); 60]);
        }
        assert_eq!((log.lines.len(), log.num_more), (MOST_LINES, 140));
        let frames = log.lines.iter().map(|(frame, _)| *frame);
        let expected = [0; 60].into_iter().chain([3; 40]);
        assert!(frames.eq(expected));
    }

    #[test]
    fn check_order_has_each_frame_once_and_both_ends_first() {
        for (first, last) in [(0, 0), (3, 4), (0, 5), (7, 23), (0, 64), (1, 949)] {
            let mut frames: Vec<_> = spread(first, last).collect();
            assert_eq!(frames[0], first);
            assert_eq!(frames[frames.len().min(2) - 1], last);
            frames.sort_unstable();
            assert_eq!(frames, (first..=last).collect::<Vec<_>>());
        }
    }
}
