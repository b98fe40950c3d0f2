//! Messages of the client, each with a header that says its length, as the protocol frames them. Lengths are
//! limited before memory is taken for them.

use std::{
    io::{self, BufRead, Read as _},
    thread,
};

use lsp_server::{Connection, Message};

/// Largest message, bytes: a scene text of the largest size with escapes.
const MOST_BYTES: usize = 64 << 20;
/// Largest header of a message, bytes.
const MOST_HEADER_BYTES: u64 = 4096;

/// Threads that pass messages between a connection and the standard input and output.
pub struct Threads {
    reader: thread::JoinHandle<io::Result<()>>,
    writer: thread::JoinHandle<io::Result<()>>,
}

impl Threads {
    /// Waits for the end of both, which comes when the client says `exit` or closes its pipe and the connection is
    /// dropped.
    ///
    /// # Errors
    /// A message that is invalid or too long, and a pipe that breaks.
    pub fn join(self) -> io::Result<()> {
        let ended = |thread: thread::JoinHandle<_>| {
            let ended = thread.join();
            ended.unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        };
        ended(self.reader)?;
        ended(self.writer)
    }
}

/// A connection over the standard input and output.
pub fn stdio() -> (Connection, Threads) {
    let (server, Connection { sender, receiver }) = Connection::memory();
    let reader = thread::spawn(move || {
        let mut input = io::stdin().lock();
        while let Some(message) = read(&mut input)? {
            let is_exit = matches!(&message, Message::Notification(n) if n.method == "exit");
            if sender.send(message).is_err() || is_exit {
                break;
            }
        }
        Ok(())
    });
    let writer = thread::spawn(move || {
        let mut output = io::stdout().lock();
        receiver
            .iter()
            .try_for_each(|message| message.write(&mut output))
    });
    (server, Threads { reader, writer })
}

/// The next message; `None` at the end of the input.
///
/// # Errors
/// A message that is invalid or longer than [`MOST_BYTES`].
fn read(input: &mut impl BufRead) -> io::Result<Option<Message>> {
    let invalid = |text: String| io::Error::new(io::ErrorKind::InvalidData, text);
    let mut header = Vec::new();
    let mut limited = input.take(MOST_HEADER_BYTES);
    loop {
        let start = header.len();
        if limited.read_until(b'\n', &mut header)? == 0 {
            return match limited.limit() {
                0 => Err(invalid(format!(
                    "its header has more than {MOST_HEADER_BYTES} bytes"
                ))),
                _ => Ok(None),
            };
        }
        let line = String::from_utf8_lossy(&header[start..]);
        let line = line.trim_end();
        if line.is_empty() {
            break;
        }
        let length = line.split_once(": ");
        let length = length.filter(|(name, _)| name.eq_ignore_ascii_case("Content-Length"));
        if let Some((_, length)) = length
            && length
                .parse::<usize>()
                .is_ok_and(|length| length > MOST_BYTES)
        {
            let most = MOST_BYTES >> 20;
            return Err(invalid(format!(
                "it has {length} bytes, and at most {most} MiB are read"
            )));
        }
    }
    Message::read(&mut header.as_slice().chain(input))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_text(text: &str) -> Result<Option<String>, String> {
        let message = read(&mut text.as_bytes()).map_err(|error| error.to_string())?;
        Ok(message.map(|message| format!("{message:?}")))
    }

    #[test]
    fn messages_are_read_one_after_another() {
        let one = "Content-Length: 33\r\n\r\n{\"jsonrpc\":\"2.0\",\"method\":\"exit\"}";
        let mut input = one.repeat(2);
        input.push_str("Content-Length: 33\r\n");
        let mut input = input.as_bytes();
        for _ in 0..2 {
            assert!(
                matches!(read(&mut input), Ok(Some(Message::Notification(n))) if n.method == "exit")
            );
        }
        assert!(matches!(read(&mut input), Ok(None)));
        assert_eq!(read_text(""), Ok(None));
    }

    /// The length is refused before the text is waited for.
    #[test]
    fn lengths_beyond_the_limit_are_refused() {
        for (text, says) in [
            (
                format!("Content-Length: {}\r\n\r\n", MOST_BYTES + 1),
                "at most 64 MiB",
            ),
            (
                format!("content-length: {}\r\n\r\n", usize::MAX),
                "at most 64 MiB",
            ),
            (format!("X: {}\r\n\r\n{{}}", "a".repeat(5000)), "4096 bytes"),
            ("a".repeat(100_000), "4096 bytes"),
        ] {
            let error = read_text(&text).expect_err("it is too long");
            assert!(error.contains(says), "{error}");
        }
        for text in [
            "Content-Length: -1\r\n\r\n",
            "Content-Length: 3\r\n\r\n{}",
            "\r\n",
            "x\r\n\r\n",
        ] {
            assert!(read_text(text).is_err(), "{text:?}");
        }
        let many = format!("Content-Length: {}9999\r\n\r\n", usize::MAX);
        assert!(read_text(&many).is_err());
    }
}
