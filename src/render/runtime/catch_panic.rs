//! Panic boundary of reading and posing: a panic becomes a diagnostic about the scene, and the last
//! good scene stays.

use std::{
    any::Any,
    panic::{AssertUnwindSafe, catch_unwind},
    path::Path,
};

use reflet_scene::diagnostic::Diagnostic;

/// Result of `work`; a panic becomes a diagnostic about this file.
///
/// # Errors
/// Errors of `work`, and a panic.
pub fn catch_panic<T>(
    file: &Path,
    work: impl FnOnce() -> Result<T, Vec<Diagnostic>>,
) -> Result<T, Vec<Diagnostic>> {
    // Unwind safe: after a panic all its data is dropped.
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let text = format!("this is a bug in Reflet: {}", panic_message(&*panic));
        let help = "please report this with the scene and its scripts";
        Err(vec![Diagnostic::in_file("internal", file, text).help(help)])
    })
}

/// Message of a panic.
fn panic_message(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied())
        .unwrap_or("it panicked")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panic_becomes_a_diagnostic_of_the_file() {
        let path = Path::new("scenes/a.toml");
        let wrong = catch_panic::<()>(path, || panic!("the count is {}", 3)).expect_err("panics");
        assert_eq!(wrong[0].file.as_deref(), Some(path));
        assert_eq!(wrong[0].message, "this is a bug in Reflet: the count is 3");
        assert_eq!(catch_panic(path, || Ok(5)), Ok(5));
    }
}
