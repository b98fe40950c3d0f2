//! Queue of views and tasks for the rendering thread, filled by the window and the file watcher.

use std::{
    collections::VecDeque,
    sync::{
        Arc, Condvar, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::Instant,
};

use super::protocol::{Task, View};

#[derive(Default)]
struct Inbox {
    view: Option<View>,
    tasks: VecDeque<Task>,
    wakes: bool,
    ends: bool,
    /// Whether a view, a task or the end waits; read without the lock while a picture is rendered.
    has_news: Arc<AtomicBool>,
}

/// Queue for the rendering thread.
#[derive(Clone, Default)]
pub struct Mailbox(Arc<(Mutex<Inbox>, Condvar)>);

impl Mailbox {
    fn change(&self, change: impl FnOnce(&mut Inbox)) {
        let mut inbox = self.0.0.lock().unwrap_or_else(PoisonError::into_inner);
        change(&mut inbox);
        let has_news = inbox.ends || inbox.view.is_some() || !inbox.tasks.is_empty();
        inbox.has_news.store(has_news, Ordering::Relaxed);
        drop(inbox);
        self.0.1.notify_one();
    }

    /// Signal that is set while a view, a task or the end waits.
    pub fn news(&self) -> Arc<AtomicBool> {
        let inbox = self.0.0.lock().unwrap_or_else(PoisonError::into_inner);
        Arc::clone(&inbox.has_news)
    }

    /// Requests a view; it replaces a pending one.
    pub fn post_view(&self, view: View) {
        self.change(|inbox| inbox.view = Some(view));
    }

    /// Posts a task. A new edit of the same material, new parameters and the next step of a drag each replace a
    /// pending one.
    pub fn post(&self, task: Task) {
        self.change(|inbox| {
            inbox.tasks.retain(|old| match (old, &task) {
                (Task::Edit(old), Task::Edit(new)) => old.material != new.material,
                (Task::Drag(..), Task::Drag(..))
                | (Task::SetParameters(_), Task::SetParameters(_)) => false,
                _ => true,
            });
            inbox.tasks.push_back(task);
        });
    }

    /// Posts a shutdown request; pending tasks are dropped.
    pub fn end(&self) {
        self.change(|inbox| inbox.ends = true);
    }

    /// Wakes the render thread.
    pub fn wake(&self) {
        self.change(|inbox| inbox.wakes = true);
    }

    /// Waits for a view, a task, a wake-up or the deadline; `None` after a shutdown request.
    pub fn take(&self, until: Option<Instant>) -> Option<(Option<View>, VecDeque<Task>)> {
        let mut inbox = self.0.0.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            if inbox.ends {
                return None;
            }
            let left = until.map(|until| until.saturating_duration_since(Instant::now()));
            let is_time = left.is_some_and(|left| left.is_zero());
            let on_report = std::mem::take(&mut inbox.wakes) || is_time;
            if on_report || inbox.view.is_some() || !inbox.tasks.is_empty() {
                inbox.has_news.store(false, Ordering::Relaxed);
                return Some((inbox.view.take(), std::mem::take(&mut inbox.tasks)));
            }
            let waits = &self.0.1;
            inbox = match left {
                None => waits.wait(inbox).unwrap_or_else(PoisonError::into_inner),
                Some(left) => {
                    let waited = waits.wait_timeout(inbox, left);
                    waited.unwrap_or_else(PoisonError::into_inner).0
                }
            };
        }
    }

    /// Whether no view and no task is pending.
    pub fn is_empty(&self) -> bool {
        let inbox = self.0.0.lock().unwrap_or_else(PoisonError::into_inner);
        inbox.view.is_none() && inbox.tasks.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use glam::Vec3;

    use super::*;
    use crate::{live::Edit, watch::Change};
    use reflet_render::runtime::parameters::ParameterOverrides;
    use reflet_scene::desc::ParamValue;

    #[test]
    fn mailbox_keeps_the_last_edit_of_a_material_and_all_other_tasks() {
        let mailbox = Mailbox::default();
        let edit = |material, roughness| {
            let mut edit = Edit::new(material);
            edit.values[2] = Some(Vec3::splat(roughness));
            Task::Edit(Box::new(edit))
        };
        mailbox.post(Task::Reload([Change::Scene].into(), Instant::now()));
        for roughness in [0.1, 0.2, 0.3] {
            mailbox.post(edit(4, roughness));
            mailbox.post(edit(5, 1.0 - roughness));
        }
        mailbox.post(Task::Unpick);
        for count in [5, 6, 7] {
            let mut overrides = ParameterOverrides::default();
            overrides.set("count", ParamValue::Integer(count), &ParamValue::Integer(0));
            mailbox.post(Task::SetParameters(overrides));
        }
        let news = mailbox.news();
        assert!(news.load(Ordering::Relaxed), "a picture is given up");
        let (view, tasks) = mailbox.take(None).expect("something to do");
        assert!(!news.load(Ordering::Relaxed));
        assert!(view.is_none() && mailbox.is_empty());
        let left: Vec<String> = tasks.iter().map(|task| format!("{task:?}")).collect();
        assert_eq!(left.len(), 5, "{left:?}");
        assert!(left[0].starts_with("Reload") && left[3].starts_with("Unpick"));
        assert!(left[1].contains("0.3") && left[2].contains("0.7"));
        assert!(left[4].contains("Integer(7)"), "{left:?}");
        // A wake-up or the deadline returns without a view or task.
        mailbox.wake();
        for until in [None, Some(Instant::now())] {
            let (view, tasks) = mailbox.take(until).expect("not the end");
            assert!(view.is_none() && tasks.is_empty());
        }
        mailbox.end();
        assert!(mailbox.take(None).is_none());
    }
}
