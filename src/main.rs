//! Entry point: arguments in, exit code out (0; 1 internal, 2 usage, 3 scene,
//! 4 no usable GPU, 5 some frames failed, 6 a comparison crossed a threshold).

use std::{env, panic, process::ExitCode};

use reflet::app;

fn main() -> ExitCode {
    panic::set_hook(Box::new(|panic| {
        eprintln!(
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
