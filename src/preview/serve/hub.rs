//! Viewers, with the messages that wait to be sent to each. A newer text of a kind replaces an older one, and a newer
//! picture an older one, so that a slow connection shows the newest and holds nobody up.

use std::{
    collections::BTreeMap,
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
};

/// Most viewers at a time.
const MOST_VIEWERS: usize = 8;
/// Most bytes of answers that wait; a viewer that asks for more without reading them is sent away.
const MOST_ANSWERS: usize = 64 * 1024;

#[derive(Default)]
struct Waiting {
    texts: BTreeMap<&'static str, Arc<str>>,
    pictures: [Option<Arc<[u8]>>; 2],
    /// Answers of the reading half, such as pongs: whole frames of the protocol.
    answers: Vec<u8>,
    /// Whether a picture was sent that the page has not shown yet.
    is_showing: bool,
    is_closed: bool,
}

/// Next part to send to a viewer.
pub(super) enum Parcel {
    /// Bytes of whole frames.
    Answers(Vec<u8>),
    Text(Arc<str>),
    /// The left side of a picture, and the right side of a wipe.
    Pictures([Option<Arc<[u8]>>; 2]),
}

/// Queue of one viewer.
#[derive(Clone, Default)]
pub(super) struct Outbox(Arc<(Mutex<Waiting>, Condvar)>);

impl Outbox {
    fn change(&self, change: impl FnOnce(&mut Waiting)) {
        change(&mut self.0.0.lock().unwrap_or_else(PoisonError::into_inner));
        self.0.1.notify_all();
    }

    pub(super) fn close(&self) {
        self.change(|waiting| waiting.is_closed = true);
    }

    /// The page has shown the last picture.
    pub(super) fn shown(&self) {
        self.change(|waiting| waiting.is_showing = false);
    }

    pub(super) fn answer(&self, bytes: &[u8]) {
        self.change(|waiting| {
            waiting.answers.extend_from_slice(bytes);
            waiting.is_closed |= waiting.answers.len() > MOST_ANSWERS;
        });
    }

    pub(super) fn text(&self, kind: &'static str, text: Arc<str>) {
        self.change(|waiting| drop(waiting.texts.insert(kind, text)));
    }

    /// Waits for the next message to send; `None` once it is closed.
    pub(super) fn next(&self) -> Option<Parcel> {
        let mut waiting = self.0.0.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            if waiting.is_closed {
                return None;
            }
            if !waiting.answers.is_empty() {
                return Some(Parcel::Answers(std::mem::take(&mut waiting.answers)));
            }
            if let Some((_, text)) = waiting.texts.pop_first() {
                return Some(Parcel::Text(text));
            }
            if !waiting.is_showing && waiting.pictures[0].is_some() {
                waiting.is_showing = true;
                return Some(Parcel::Pictures(std::mem::take(&mut waiting.pictures)));
            }
            waiting = self
                .0
                .1
                .wait(waiting)
                .unwrap_or_else(PoisonError::into_inner);
        }
    }
}

/// All viewers, and the first messages for a new one.
#[derive(Clone, Default)]
pub(super) struct Hub(Arc<Mutex<Shown>>);

#[derive(Default)]
struct Shown {
    viewers: Vec<Outbox>,
    texts: BTreeMap<&'static str, Arc<str>>,
    pictures: [Option<Arc<[u8]>>; 2],
}

impl Hub {
    fn lock(&self) -> MutexGuard<'_, Shown> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds a viewer; `None` if there are too many.
    pub(super) fn join(&self) -> Option<Outbox> {
        let mut shown = self.lock();
        if shown.viewers.len() >= MOST_VIEWERS {
            return None;
        }
        let outbox = Outbox::default();
        outbox.change(|waiting| {
            waiting.texts.clone_from(&shown.texts);
            waiting.pictures.clone_from(&shown.pictures);
        });
        shown.viewers.push(outbox.clone());
        Some(outbox)
    }

    pub(super) fn leave(&self, outbox: &Outbox) {
        outbox.close();
        self.lock()
            .viewers
            .retain(|other| !Arc::ptr_eq(&other.0, &outbox.0));
    }

    /// Sends a text to all viewers, if it differs from the last of its kind.
    pub(super) fn text(&self, kind: &'static str, text: &str) {
        let text: Arc<str> = text.into();
        let mut shown = self.lock();
        if shown.texts.get(kind) == Some(&text) {
            return;
        }
        shown.texts.insert(kind, text.clone());
        for viewer in &shown.viewers {
            viewer.text(kind, text.clone());
        }
    }

    /// Sends the sides of a picture to all viewers.
    pub(super) fn pictures(&self, pictures: [Option<Arc<[u8]>>; 2]) {
        let mut shown = self.lock();
        for viewer in &shown.viewers {
            viewer.change(|waiting| waiting.pictures.clone_from(&pictures));
        }
        shown.pictures = pictures;
    }

    /// Sends all viewers away.
    pub(super) fn close(&self) {
        self.lock().viewers.iter().for_each(Outbox::close);
    }

    /// Whether anyone looks.
    pub(super) fn is_empty(&self) -> bool {
        self.lock().viewers.is_empty()
    }
}
