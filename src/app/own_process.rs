//! Processes of this program that end with the process that started them.

use std::{
    env, io,
    process::{self, Command},
};

/// Environment variable of such a process: the number of the process that started it.
const PARENT: &str = "REFLET_PARENT";

/// A process of this program, without arguments; the thread that starts it must wait for it.
///
/// # Errors
/// The file of the program is not known.
pub fn own_process() -> io::Result<Command> {
    // By this name a program still runs whose file was replaced meanwhile.
    let mut command = match cfg!(target_os = "linux") {
        true => Command::new("/proc/self/exe"),
        false => Command::new(env::current_exe()?),
    };
    #[cfg(unix)]
    std::os::unix::process::CommandExt::arg0(&mut command, "reflet");
    command.env(PARENT, process::id().to_string());
    Ok(command)
}

/// Has this process end with the process that started it by [`own_process`], even if that is killed (on Linux).
pub fn end_with_parent() {
    #[cfg(target_os = "linux")]
    if let Ok(starter) = env::var(PARENT) {
        let signal = rustix::process::Signal::KILL;
        let _ = rustix::process::set_parent_process_death_signal(Some(signal));
        let parent = rustix::process::getppid().map(|parent| parent.to_string());
        if parent != Some(starter) {
            process::exit(1); // it ended before
        }
    }
}
