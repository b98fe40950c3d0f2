//! Runs of the program.

use std::{
    path::Path,
    process::{Child, Command, Output, Stdio},
};

/// Arguments of a command line: the words of a line, or a list.
pub trait Arguments {
    /// The arguments, each alone.
    fn list(&self) -> Vec<&str>;
}

impl Arguments for str {
    fn list(&self) -> Vec<&str> {
        self.split_whitespace().collect()
    }
}

impl Arguments for String {
    fn list(&self) -> Vec<&str> {
        self.as_str().list()
    }
}

impl Arguments for [&str] {
    fn list(&self) -> Vec<&str> {
        self.to_vec()
    }
}

impl<const N: usize> Arguments for [&str; N] {
    fn list(&self) -> Vec<&str> {
        self.to_vec()
    }
}

impl Arguments for Vec<&str> {
    fn list(&self) -> Vec<&str> {
        self.clone()
    }
}

impl<A: Arguments + ?Sized> Arguments for &A {
    fn list(&self) -> Vec<&str> {
        (**self).list()
    }
}

/// The program in a folder, without standard input.
pub fn reflet(folder: &Path, arguments: impl Arguments) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_reflet"));
    command
        .current_dir(folder)
        .args(arguments.list())
        // Mesa's device-select layer writes to standard error where there is no desktop.
        .env("NODEVICE_SELECT", "1")
        .env_remove("REFLET_ASSETS")
        .stdin(Stdio::null());
    command
}

/// Standard output and standard error of a command that has ended.
pub fn texts(output: &Output) -> [String; 2] {
    [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned())
}

/// Runs a command to its end, checks the exit code, and returns standard output and standard error.
#[track_caller]
pub fn ends(command: &mut Command, code: i32) -> [String; 2] {
    let output = command.output().expect("the program starts");
    let texts = texts(&output);
    assert_eq!(output.status.code(), Some(code), "{command:?}: {texts:?}");
    assert!(!texts[1].contains("panicked"), "{}", texts[1]);
    texts
}

/// Runs the program to its end, as [`ends`] does.
#[track_caller]
pub fn exits(folder: &Path, arguments: impl Arguments, code: i32) -> [String; 2] {
    ends(&mut reflet(folder, arguments), code)
}

/// Sends a signal to a child, such as `-TERM`.
pub fn signal(child: &Child, name: &str) {
    let id = child.id().to_string();
    let sent = Command::new("kill").args([name, &id]).status();
    assert!(sent.is_ok(), "there is a kill command");
}
