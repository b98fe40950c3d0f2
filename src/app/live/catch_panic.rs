//! The last guard around reading and posing: a panic ends as a message about the scene, and what is
//! shown stays.

use std::{
    any::Any,
    panic::{AssertUnwindSafe, catch_unwind},
    path::Path,
};

use crate::scene::diagnostic::Diagnostic;

/// What the work on this file gives, or that it panicked.
pub(super) fn catch_panic<T>(
    file: &Path,
    work: impl FnOnce() -> Result<T, Vec<Diagnostic>>,
) -> Result<T, Vec<Diagnostic>> {
    // What it works on is given up with it.
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let text = format!("this is a bug in Reflet: {}", words(&*panic));
        let help = "another text may work; please report this with the scene and its scripts";
        Err(vec![Diagnostic::in_file("internal", file, text).help(help)])
    })
}

/// What a panic says.
fn words(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied())
        .unwrap_or("it panicked")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_a_message_about_the_file() {
        let path = Path::new("scenes/a.toml");
        let wrong = catch_panic::<()>(path, || panic!("the count is {}", 3)).expect_err("panics");
        assert_eq!(wrong[0].file.as_deref(), Some(path));
        assert_eq!(wrong[0].message, "this is a bug in Reflet: the count is 3");
        assert_eq!(catch_panic(path, || Ok(5)), Ok(5));
    }
}
