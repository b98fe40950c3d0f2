//! Shell completions and manual pages, from the definition of the command line.

use clap::CommandFactory as _;
use clap_complete::Shell;

use super::{cli::Cli, error::AppError};

/// Completions of all commands and options, as a script of the shell.
pub fn completions(shell: Shell) -> String {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "reflet", &mut script);
    String::from_utf8_lossy(&script).into_owned()
}

/// The manual page (roff) of a command, given by its words; without any, of the program.
///
/// # Errors
/// [`AppError::Usage`] for a command that does not exist.
pub fn man_page(words: &[String]) -> Result<String, AppError> {
    let mut command = Cli::command();
    // Gives the usage lines of subcommands their full names, and their pages names such as `reflet-render`.
    command.build();
    for word in words {
        let shown = command.get_subcommands().filter(|c| !c.is_hide_set());
        let (names, found): (Vec<_>, Vec<_>) = shown
            .map(|c| (c.get_name().to_owned(), c))
            .map(|(name, c)| (name.clone(), (name == *word).then(|| c.clone())))
            .unzip();
        let found = found.into_iter().flatten().next();
        command = found.ok_or_else(|| {
            let of = command.get_bin_name().unwrap_or("reflet");
            AppError::Usage(match names.is_empty() {
                true => format!("man: {of} has no commands of its own, so no `{word}`"),
                false => format!(
                    "man: {of} has no command `{word}`; choose from {}",
                    names.join(", ")
                ),
            })
        })?;
    }
    let mut page = Vec::new();
    clap_mangen::Man::new(command)
        .render(&mut page)
        .map_err(|error| AppError::Internal(format!("man: {error}")))?;
    Ok(String::from_utf8_lossy(&page).into_owned())
}

#[cfg(test)]
mod tests {
    use std::{
        io::Write as _,
        process::{Command, Stdio},
    };

    use clap::ValueEnum as _;

    use super::*;

    #[test]
    fn every_command_has_completions_and_a_page() {
        let program = man_page(&[]).expect("a page");
        let scripts = Shell::value_variants().iter().copied().map(completions);
        let texts: Vec<_> = scripts.chain([program]).collect();
        for command in Cli::command()
            .get_subcommands()
            .filter(|c| !c.is_hide_set())
        {
            let name = command.get_name();
            man_page(&[name.to_owned()]).expect(name);
            assert!(texts.iter().all(|text| text.contains(name)), "{name}");
        }
    }

    #[test]
    fn bash_reads_its_completions() {
        let bash = Command::new("bash").arg("-n").stdin(Stdio::piped()).spawn();
        let Ok(mut bash) = bash else {
            eprintln!("SKIPPED: there is no bash");
            return;
        };
        let mut input = bash.stdin.take().expect("a pipe");
        let script = completions(Shell::Bash);
        input.write_all(script.as_bytes()).expect("it reads");
        drop(input);
        assert!(bash.wait().expect("it ends").success());
    }
}
