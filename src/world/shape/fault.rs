//! Mistakes in shapes.

use reflet_scene::diagnostic::Span;

/// An error about a shape; the caller knows its model.
#[derive(Clone, Debug)]
pub struct Fault {
    /// Kebab-case name of the kind of error.
    pub name: &'static str,
    /// Message.
    pub message: String,
    /// Advice.
    pub help: Option<String>,
    /// Place in the scene text; `None` for the model as a whole.
    pub at: Option<Span>,
}

impl Fault {
    /// An error without help.
    pub fn new(name: &'static str, message: impl Into<String>) -> Self {
        Self {
            name,
            message: message.into(),
            help: None,
            at: None,
        }
    }

    /// Adds help.
    pub fn help(self, help: impl Into<String>) -> Self {
        let help = Some(help.into());
        Self { help, ..self }
    }

    /// Adds a place, unless one is known.
    pub fn placed(self, at: Span) -> Self {
        let at = self.at.or(Some(at));
        Self { at, ..self }
    }
}
