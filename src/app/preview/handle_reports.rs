//! What the window does with what the rendering thread says.

use std::sync::mpsc::TryRecvError;

use super::{
    charts::HISTORY,
    protocol::{Report, SceneSummary, Shown},
    timeline,
    window::Window,
};

impl Window {
    /// Takes over everything that was said since the last time.
    pub(super) fn receive(&mut self, now_s: f64) {
        loop {
            match self.worker.reports.try_recv() {
                Ok(Report::SceneSummary(facts)) => self.take_facts(*facts, now_s),
                Ok(Report::Script(since)) => self.script = since,
                Ok(Report::Shown(shown)) => self.take_shown(*shown, now_s),
                Ok(Report::ParameterOverrides(reload)) => {
                    let ms = reload.took.as_secs_f64() * 1e3;
                    self.note.say(if reload.ok {
                        self.judged = None;
                        self.edits += 1;
                        format!("the parameters took {ms:.0} ms")
                    } else {
                        "the parameters wait for the scene to be mended".to_owned()
                    });
                }
                Ok(Report::Refused(refusal)) => {
                    self.note.say("refused; see the script parameters");
                    self.parameters.refuse(*refusal, &self.facts.declared);
                }
                Ok(Report::Reloaded(reload, ms)) => {
                    let cpu = reload.took.as_secs_f64() * 1e3;
                    self.note.say(if reload.ok {
                        // Its map would hide what the save has changed.
                        self.judged = None;
                        self.edits += 1;
                        format!(
                            "reloaded in {ms:.0} ms from the save to the picture; {cpu:.0} ms to get ready"
                        )
                    } else {
                        "not taken over; see the list over the picture".to_owned()
                    });
                }
                Ok(Report::Judged(judged)) => {
                    if judged.edits == self.edits {
                        self.judged = Some(*judged);
                        self.choice.heat = true;
                    } else {
                        (self.note).say("the scene has changed meanwhile; compare again");
                    }
                }
                Ok(Report::Picked(picked)) => self.take_picked(picked),
                Ok(Report::Unpicked) => self.picked = None,
                Ok(Report::Note(note)) => self.note.say(note),
                Ok(Report::Unwatched(why)) => self.unwatched = why,
                Ok(Report::Idle) => self.is_busy = false,
                Err(TryRecvError::Empty) => return,
                Err(TryRecvError::Disconnected) => {
                    let text = "the renderer stopped; start the preview again";
                    self.note.say_for_good(text);
                    return;
                }
            }
        }
    }

    fn take_shown(&mut self, shown: Shown, now_s: f64) {
        if self.choice.through.is_some() {
            // The scene's camera may move with time; who takes it over starts from there.
            self.navigator.camera = shown.camera.clone();
        }
        let stats = shown.sides.first().map(|side| side.stats.clone());
        self.history.extend(stats);
        if self.history.len() > HISTORY {
            self.history.pop_front();
        }
        let is_next = self.shown.as_ref().is_none_or(|s| s.frame != shown.frame);
        if let (Some(timeline), true) = (&mut self.timeline, is_next) {
            timeline.count(now_s);
        }
        self.picked.clone_from(&shown.picked);
        self.shown = Some(shown);
    }

    /// Takes over a scene that was read again: camera, time and selection stay, by name.
    fn take_facts(&mut self, facts: SceneSummary, now_s: f64) {
        timeline::follow(
            &mut self.timeline,
            &mut self.put_away,
            facts.timeline.as_ref(),
            now_s,
        );
        self.parameters.keep_what_fits(&facts.declared);
        let material = self
            .choice
            .material
            .and_then(|i| self.facts.materials.get(i));
        self.choice.material =
            material.and_then(|old| facts.materials.iter().position(|new| new.name == old.name));
        let camera = self.choice.through.and_then(|i| self.facts.cameras.get(i));
        let camera =
            camera.and_then(|(old, _)| facts.cameras.iter().position(|(new, _)| new == old));
        // Before the first scene without mistakes there is nothing.
        let is_first = self.facts.materials.is_empty() && !facts.cameras.is_empty();
        let home = self.facts.cameras.get(self.choice.home);
        let home = home.and_then(|(old, _)| facts.cameras.iter().position(|(new, _)| new == old));
        self.choice.home = home.unwrap_or(0);
        let camera = camera.or(is_first.then_some(self.choice.home));
        self.choice.through = camera;
        if let Some(index) = camera {
            // One that was not moved by hand follows the scene.
            self.navigator.camera = facts.cameras[index].1.clone();
        }
        self.navigator.rescale(&facts.bounds);
        for side in [&mut self.choice.a, &mut self.choice.b] {
            side.look = side.look.after(&self.facts.casters, &facts.casters);
        }
        if facts.method != self.facts.method {
            self.choice.a.method = facts.method;
        }
        self.facts = facts;
    }
}
