//! The library that was built beside this test is a module of Python: the interpreter loads it, as the version of this
//! package.

use std::{env, fs, path::PathBuf, process::Command};

/// Folder of the libraries of this build; the test stands among them.
fn libraries() -> PathBuf {
    let test = env::current_exe().expect("it runs");
    test.parent().expect("in a folder").to_owned()
}

#[test]
fn python_loads_the_library() {
    let temporary = tempfile::tempdir().expect("a folder");
    let package = temporary.path();
    let (prefix, suffix) = (env::consts::DLL_PREFIX, env::consts::DLL_SUFFIX);
    let library = libraries().join(format!("{prefix}reflet_python{suffix}"));
    let ending = if cfg!(windows) { "pyd" } else { "abi3.so" };
    fs::copy(&library, package.join(format!("_reflet.{ending}"))).expect("it was built");
    let is_new = Command::new("python3")
        .args(["-c", "import sys; sys.exit(sys.version_info < (3, 11))"])
        .status();
    if !is_new.is_ok_and(|status| status.success()) {
        reflet_base::error_line!("SKIPPED: there is no python3 of version 3.11 or later");
        return;
    }
    let run = Command::new("python3")
        .args(["-c", "import _reflet; print(_reflet.__version__)"])
        .env("PYTHONPATH", package)
        .output()
        .expect("there is a python3");
    let said = String::from_utf8_lossy(&run.stdout);
    let wrong = String::from_utf8_lossy(&run.stderr);
    assert_eq!(said.trim(), env!("CARGO_PKG_VERSION"), "{wrong}");
}
