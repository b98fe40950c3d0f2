//! Entry point: passes the arguments to [`app`] and returns its exit code (0; 1 internal, 2 usage, 3 scene,
//! 4 no usable GPU, 5 some frames failed, 6 a comparison crossed a threshold, 130 or 143 interrupted).

use std::{env, panic, process::ExitCode};

use reflet::{app, gpu};

/// Sets environment variables of the graphics driver.
#[expect(
    unsafe_code,
    reason = "the environment is changed before any other thread exists"
)]
fn set_driver_variables() {
    for (name, value) in gpu::driver::driver_variables() {
        // SAFETY: this is the first call in `main`, while no other thread exists.
        unsafe { env::set_var(name, value) };
    }
}

fn main() -> ExitCode {
    set_driver_variables();
    panic::set_hook(Box::new(|panic| {
        if reflet_base::guard::is_guarded() {
            return;
        }
        reflet_base::error_line!(
            "internal error: {panic}\nThis is a bug in Reflet {}. Please report it with these \
             lines, the command and the scene.",
            env!("CARGO_PKG_VERSION")
        );
    }));
    match panic::catch_unwind(|| app::run(env::args_os())) {
        Ok(Ok(())) => ExitCode::SUCCESS,
        Ok(Err(error)) => {
            error.print();
            ExitCode::from(error.exit_code())
        }
        Err(_) => ExitCode::FAILURE,
    }
}
