//! Reader of the timeline and its cuts.

use crate::declared::{Described, TypeDoc};
use crate::table::{Keys, Section, Table};
use crate::{
    desc::{CutDesc, TimelineDesc},
    diagnostic::Diagnostic,
};

/// `[timeline]`, with its cuts.
pub struct Film {
    pub timeline: TimelineDesc,
    pub cuts: Vec<CutDesc>,
}

fn cuts(t: &mut Table) -> Vec<CutDesc> {
    let cuts: Vec<CutDesc> = t.list("cuts");
    for pair in cuts.windows(2) {
        if pair[1].frame <= pair[0].frame {
            let before = pair[0].frame;
            let message =
                format!("`frame` must be after that of the cut before, which is {before}");
            let at = pair[1].camera.at.clone();
            let error = Diagnostic::new("key-order", at, message);
            t.report
                .push(error.related(pair[0].camera.at.clone(), "the cut before is here"));
        }
    }
    cuts
}

/// Warns of cuts after the last frame, which no frame shows.
fn warn_of_late_cuts(t: &mut Table, cuts: &[CutDesc], end: u32) {
    for cut in cuts.iter().filter(|cut| cut.frame > end) {
        let message = format!(
            "the cut at frame {} is never shown: the last frame is {end}",
            cut.frame
        );
        let warning = Diagnostic::new("late-cut", cut.camera.at.clone(), message);
        let help = "remove the cut, or move `end`";
        t.report.push(warning.help(help).warning());
    }
}

impl Described for Film {
    const DOC: &'static TypeDoc = TimelineDesc::DOC;
}

impl Section for Film {
    const HEADING: &'static str = "[timeline]";

    fn read(t: &mut Table) -> Option<Self> {
        let timeline: Option<TimelineDesc> = Keys::read_keys(t);
        if let Some(TimelineDesc { start, end, .. }) = timeline
            && t.clean()
            && end < start
        {
            let message = format!("`end` must not be before `start`, which is {start}");
            t.refuse(
                "empty-timeline",
                "end",
                &message,
                &format!("write `end = {start}` or more: the frames from `start` to `end` are shown, both included"),
            );
        }
        let cuts = cuts(t);
        let timeline = timeline?;
        warn_of_late_cuts(t, &cuts, timeline.end);
        Some(Self { timeline, cuts })
    }
}
