//! Frames of a film, posed within a time, for whoever asks about all of them.

use std::{ops::RangeInclusive, time::Duration};

use reflet_base::{clock::Instant, math::Bounds};
use reflet_scene::{
    diagnostic::Diagnostic,
    stages::{Animator, Scene},
};
use reflet_world::World;

/// Poses frames within the time budget, at least the first and the last unless a script exceeds a
/// limit; returns their number. `visit` is called with each posed world, its frame and the lines that the script printed there.
///
/// # Errors
/// All errors of the frames, each once, in the order of the frames.
pub fn pose_all(
    animator: &Animator,
    world: &mut World,
    frames: RangeInclusive<u32>,
    posing: Duration,
    visit: &mut dyn FnMut(&World, u32, Vec<String>),
) -> Result<u32, Vec<Diagnostic>> {
    let started = Instant::now();
    let (first, last) = (*frames.start(), *frames.end());
    let mut wrong: Vec<(u32, Diagnostic)> = Vec::new();
    let mut posed = 0;
    for frame in spread(first, last) {
        let is_end = frame == first || frame == last;
        // A frame that exceeded a limit may have taken very long, and the last frame would too.
        let met_limit = wrong.iter().any(|(_, e)| e.name == "script-limit");
        if met_limit || (!is_end && started.elapsed() > posing) {
            break;
        }
        posed += 1;
        let done = animator.pose(frame).and_then(|state| {
            world.apply(&state)?;
            visit(world, frame, state.log);
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
        false => Err(wrong.into_iter().map(|(_, e)| e).collect()),
    }
}

/// Frames of the timeline; without one, the only frame.
pub fn frames_of(scene: &Scene) -> RangeInclusive<u32> {
    let first = scene.first_frame();
    first..=scene.timeline.as_ref().map_or(first, |t| t.end)
}

/// Bounds of each instance over its motion, and the number of frames that were posed within the time, spread over all;
/// `world` is left in some pose.
///
/// # Errors
/// Same errors as [`pose_all`].
pub fn motion_bounds(
    scene: &Scene,
    world: &mut World,
    posing: Duration,
) -> Result<(Vec<Bounds>, u32), Vec<Diagnostic>> {
    let mut all = vec![Bounds::EMPTY; world.instances.len()];
    let mut add = |world: &World, _, _| {
        for (bounds, instance) in all.iter_mut().zip(&world.instances) {
            *bounds = bounds.union(world.bounds_of(instance));
        }
    };
    let posed = match scene.is_still() {
        true => {
            add(world, 0, Vec::new());
            1
        }
        false => pose_all(
            &Animator::new(scene),
            world,
            frames_of(scene),
            posing,
            &mut add,
        )?,
    };
    Ok((all, posed))
}

/// Frame numbers: both ends, then successively finer steps between them; each frame once.
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
    use super::spread;

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
