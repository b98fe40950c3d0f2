//! `lsp`: the language server of `reflet-lsp` on standard input and output.

mod frames;

use std::sync::Arc;

use lsp_server::{Connection, Message};
use reflet_lsp::{Server, capabilities};
use serde_json::{from_value, to_value};

use super::{args::SceneArgs, check::messages, error::AppError, project::check_output};
use crate::scene::{
    dependencies::Dependencies,
    diagnostic::{Diagnostic, Source},
    parse::tables::is_project,
    project::Project,
    reach::UnsavedTexts,
};

/// Serves one client until it says `exit` or closes its pipe.
///
/// # Errors
/// [`AppError::Usage`] if the client sends an invalid message.
pub fn lsp() -> Result<(), AppError> {
    let (connection, threads) = frames::stdio();
    let served = serve(&connection);
    drop(connection); // otherwise its writer thread waits for messages
    let refuse = |error: String| {
        AppError::Usage(format!(
            "the client of `lsp` sent an invalid message: {error}"
        ))
    };
    threads.join().map_err(|error| refuse(error.to_string()))?;
    served.map_err(refuse)
}

fn serve(connection: &Connection) -> Result<(), String> {
    let client = connection
        .initialize(capabilities())
        .map_err(|error| error.to_string())?;
    let mut server = Server::new(&client);
    let send = |message| {
        if let Ok(message) = from_value(message) {
            let _ = connection.sender.send(message); // a lost client is noticed when reading
        }
    };
    for message in &connection.receiver {
        if let Message::Request(request) = &message
            && (connection.handle_shutdown(request)).map_err(|error| error.to_string())?
        {
            return Ok(());
        }
        let message = to_value(message).map_err(|error| error.to_string())?;
        server.handle(&message).into_iter().for_each(send);
        if connection.receiver.is_empty() {
            server.check_changed(whole_check).into_iter().for_each(send);
        }
    }
    Ok(())
}

/// Everything that `check` says about a scene, or all messages about the text of a project.
fn whole_check(
    file: &Arc<Source>,
    unsaved: &UnsavedTexts,
    files: &Dependencies,
) -> Vec<Diagnostic> {
    if !is_project(&file.path) {
        return messages(file, &SceneArgs::default(), unsaved.clone(), files);
    }
    let project = match Project::from_source(file) {
        Ok(project) => project,
        Err(messages) => return messages,
    };
    let output = project.desc.output.as_ref();
    let error = output.and_then(|output| check_output(output).err());
    let error = error.map(|error| *error);
    project.warnings.into_iter().chain(error).collect()
}
