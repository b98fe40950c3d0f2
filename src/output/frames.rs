//! Frame lists: `--frames`, `--timeline` and `--shard`.

use std::{
    borrow::Cow,
    collections::HashSet,
    num::{IntErrorKind, ParseIntError},
};

use crate::error::OutputError;
use reflet_scene::desc::TimelineDesc;

/// The frames of a command, in the order in which they are rendered.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameList(pub Vec<u32>);

/// Maximum length of an argument quoted in a message, characters.
const REPEATED: usize = 60;

/// `--shard i/n`: every n-th frame, from the i-th.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Number of the part, from 1.
    pub index: u32,
    /// Number of parts.
    pub count: u32,
}

impl FrameList {
    /// Parses the value of `option`: `all`, or comma-separated numbers and ranges such as `0-949`,
    /// `1-20:2` or `1,3,5-9`, within the timeline.
    ///
    /// # Errors
    /// [`OutputError::Usage`] with the invalid part.
    pub fn parse(option: &str, text: &str, timeline: &TimelineDesc) -> Result<Self, OutputError> {
        let usage = |why: String| OutputError::Usage(format!("{option} {}: {why}", clipped(text)));
        let mut frames = Vec::new();
        if text.trim() == "all" {
            frames.extend(timeline.start..=timeline.end);
            return Ok(Self(frames));
        }
        let mut known = HashSet::new();
        for part in text.split(',') {
            let [first, last, step] = range(part.trim()).map_err(usage)?;
            for frame in [first, last] {
                if !(timeline.start..=timeline.end).contains(&frame) {
                    return Err(usage(format!(
                        "frame {frame} is not in the timeline, which has {} to {}; name others, or write `{} = {}` in \
                         `[timeline]`",
                        timeline.start,
                        timeline.end,
                        if frame < timeline.start {
                            "start"
                        } else {
                            "end"
                        },
                        if frame < timeline.start {
                            first
                        } else {
                            first.max(last)
                        },
                    )));
                }
            }
            // The first repeated frame is an error, so a list never exceeds the timeline.
            for frame in (first..=last).step_by(step as usize) {
                if !known.insert(frame) {
                    return Err(usage(format!("frame {frame} is listed twice")));
                }
                frames.push(frame);
            }
        }
        Ok(Self(frames))
    }

    /// Frames of one shard.
    pub fn shard(self, shard: Option<Shard>) -> Self {
        let Some(Shard { index, count }) = shard else {
            return self;
        };
        let own = self.0.into_iter().skip(index as usize - 1);
        Self(own.step_by(count as usize).collect())
    }
}

/// An argument shortened for a message.
pub fn clipped(text: &str) -> Cow<'_, str> {
    match text.char_indices().nth(REPEATED) {
        Some((end, _)) => format!("{}…", &text[..end]).into(),
        None => text.into(),
    }
}

/// First frame, last frame and step of one part.
fn range(part: &str) -> Result<[u32; 3], String> {
    let number = |text: &str| {
        let text = text.trim();
        text.parse::<u32>().map_err(|e| match e.kind() {
            IntErrorKind::Empty if part.is_empty() => {
                "frames are missing; write all, or such as 0-47, 1-20:2 or 1,3,5-9".to_owned()
            }
            IntErrorKind::Empty => format!("a number is missing in \"{}\"", clipped(part)),
            IntErrorKind::PosOverflow => {
                format!("\"{}\" is too large for a frame number", clipped(text))
            }
            _ => format!(
                "\"{}\" is not a frame number, which is 0 or more",
                clipped(text)
            ),
        })
    };
    let (frames, step) = part
        .split_once(':')
        .map_or((part, None), |(f, s)| (f, Some(s)));
    let step = match step {
        Some(step) => step.trim().parse().map_err(|e: ParseIntError| {
            let should = match e.kind() {
                IntErrorKind::PosOverflow => "is too large",
                _ => "must be 1 or more",
            };
            format!("the step \"{}\" {should}", clipped(step))
        })?,
        None => 1,
    };
    let ends = frames.split_once("..").or_else(|| {
        // A leading minus is a negative number, not a range.
        let dash = frames.get(1..).and_then(|rest| rest.find('-'))? + 1;
        Some((&frames[..dash], &frames[dash + 1..]))
    });
    let (first, last) = match ends {
        Some((first, last)) => (number(first)?, number(last)?),
        None if part.contains(':') => return Err("a step needs a range, as in 0-47:2".to_owned()),
        None => (number(frames)?, number(frames)?),
    };
    if step == 0 {
        return Err("the step \"0\" must be 1 or more".to_owned());
    }
    if last < first {
        return Err(format!(
            "\"{}\" ends before it begins; write {last}-{first}",
            clipped(part)
        ));
    }
    Ok([first, last, step])
}

/// Ascending frame numbers in the syntax of `--frames`, such as `1,3,5-9`.
pub fn spans(frames: &[u32]) -> String {
    let follows = |a: &u32, b: &u32| a + 1 == *b;
    let part = |run: &[u32]| match run {
        [] => String::new(),
        [only] => only.to_string(),
        [first, .., last] => format!("{first}-{last}"),
    };
    let parts: Vec<_> = frames.chunk_by(follows).map(part).collect();
    parts.join(",")
}

/// Parses `--shard`.
///
/// # Errors
/// Message that names the expected form.
pub fn parse_shard(text: &str) -> Result<Shard, String> {
    let parts = text.split_once('/');
    let pair = parts.and_then(|(i, n)| Some((i.trim().parse().ok()?, n.trim().parse().ok()?)));
    match pair {
        Some((index, count)) if (1..=count).contains(&index) => Ok(Shard { index, count }),
        Some(_) => Err("the part must be 1 to the number of parts".to_owned()),
        None => Err("expected PART/PARTS, such as 1/4".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TIMELINE: TimelineDesc = TimelineDesc {
        fps: 24.0,
        start: 0,
        end: 20,
    };

    fn frames(text: &str) -> Vec<u32> {
        let list = FrameList::parse("--frames", text, &TIMELINE);
        list.unwrap_or_else(|e| panic!("{text}: {e:?}")).0
    }

    #[test]
    fn frame_lists_round_trip() {
        let timeline = TimelineDesc {
            fps: 24.0,
            start: 0,
            end: 99,
        };
        for (frames, text) in [
            (vec![7], "7"),
            (vec![0, 1, 2, 5, 7, 8], "0-2,5,7-8"),
            (vec![1, 3, 5], "1,3,5"),
        ] {
            assert_eq!(spans(&frames), text);
            let read = FrameList::parse("--frames", text, &timeline).expect("is right");
            assert_eq!(read, FrameList(frames));
        }
    }

    #[test]
    fn lists_are_ranges_steps_and_numbers() {
        assert_eq!(frames("3"), [3]);
        assert_eq!(frames("1-4"), [1, 2, 3, 4]);
        assert_eq!(frames("1..4"), [1, 2, 3, 4]);
        assert_eq!(frames("1-20:6"), [1, 7, 13, 19]);
        assert_eq!(frames("9, 1,3,5-7"), [9, 1, 3, 5, 6, 7]);
        assert_eq!(frames("all").len(), 21);
    }

    /// The expanded list would take 48 GB.
    #[test]
    fn the_first_repeated_frame_ends_a_list() {
        let timeline = TimelineDesc {
            fps: 24.0,
            start: 0,
            end: 1_000_000,
        };
        let list = vec!["0-1000000"; 12_000].join(",");
        match FrameList::parse("--frames", &list, &timeline) {
            Err(OutputError::Usage(text)) => {
                assert!(text.ends_with("…: frame 0 is listed twice"), "{text}");
                assert!(text.len() < 200, "{text}");
            }
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn shards_cover_every_frame_once() {
        let all = FrameList(vec![4, 8, 15, 16, 20]);
        let part = |index| all.clone().shard(Some(Shard { index, count: 3 })).0;
        assert_eq!(
            [part(1), part(2), part(3)],
            [vec![4, 16], vec![8, 20], vec![15]]
        );
        assert_eq!(parse_shard("2/3"), Ok(Shard { index: 2, count: 3 }));
        for bad in ["0/3", "4/3", "1", "a/b", "1/0", "-1/2"] {
            assert!(parse_shard(bad).is_err(), "{bad}");
        }
    }
}
