//! A viewer without a browser, which measures when pictures come.

use std::{
    io::{ErrorKind, Read, Write},
    net::TcpStream,
    time::{Duration, Instant},
};

use serde::Deserialize;
use tungstenite::{Error, Message, WebSocket, client::ClientRequestBuilder, http::Uri};

/// A viewer of a page.
pub struct Client {
    socket: WebSocket<TcpStream>,
    /// Number of the newest picture, and when it came.
    picture: Option<(u64, Instant)>,
    statistics: Option<Statistics>,
    idle: Option<u64>,
    /// Mistakes of the scene.
    problems: Vec<String>,
}

/// A picture that has come whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// When its last byte was read.
    pub at: Instant,
    /// Number of saves since the start of the preview that it shows.
    pub saves: u64,
    /// Time of rendering it, milliseconds.
    pub frame_ms: f64,
    /// Time of reading it back and encoding it, milliseconds.
    pub encode_ms: f64,
}

#[derive(Clone, Debug, Deserialize)]
struct Statistics {
    picture: u64,
    saves: u64,
    encode_ms: f64,
    sides: Vec<Side>,
}

#[derive(Clone, Debug, Deserialize)]
struct Side {
    ms: f64,
}

/// Contents of a text of the page, as far as they are used.
#[derive(Debug, Deserialize)]
struct Told {
    statistics: Option<Statistics>,
    idle: Option<u64>,
    scene: Option<Scene>,
}

#[derive(Debug, Deserialize)]
struct Scene {
    problems: Vec<String>,
}

impl Client {
    /// Joins the page at the address that the preview prints.
    ///
    /// # Errors
    /// Sentence with the reason why it cannot be joined.
    pub fn join(url: &str) -> Result<Self, String> {
        let failed = |error: &dyn std::fmt::Display| format!("cannot join {url}: {error}");
        let host = url
            .strip_prefix("http://")
            .and_then(|r| r.split('/').next());
        let host = host.ok_or_else(|| failed(&"it is no address of a page"))?;
        let socket: Uri = format!("{}socket", url.replacen("http:", "ws:", 1))
            .parse()
            .map_err(|error| failed(&error))?;
        let stream = TcpStream::connect(host).map_err(|error| failed(&error))?;
        stream.set_nodelay(true).map_err(|error| failed(&error))?;
        let request =
            ClientRequestBuilder::new(socket).with_header("Origin", format!("http://{host}"));
        let (socket, _) = tungstenite::client(request, stream).map_err(|error| failed(&error))?;
        Ok(Self {
            socket,
            picture: None,
            statistics: None,
            idle: None,
            problems: Vec::new(),
        })
    }

    /// Waits for the first picture that shows at least this many saves.
    ///
    /// # Errors
    /// Sentence with the reason: none came in time, with the mistakes of the scene, or the page has ended.
    pub fn wait_for(&mut self, saves: u64, patience: Duration) -> Result<Arrival, String> {
        let until = Instant::now() + patience;
        loop {
            if let Some(arrival) = self.newest().filter(|newest| newest.saves >= saves) {
                return Ok(arrival);
            }
            if !self.read(until)? {
                let mistakes = self.problems.join("\n");
                return Err(format!("no picture came in {patience:?}; {mistakes}"));
            }
        }
    }

    /// Waits until the newest picture has come and nothing is left to draw.
    ///
    /// # Errors
    /// Same errors as [`Client::wait_for`].
    pub fn wait_for_rest(&mut self, patience: Duration) -> Result<Arrival, String> {
        let until = Instant::now() + patience;
        loop {
            let is_over = self.picture.map(|(number, _)| number) == self.idle;
            if let Some(newest) = self.newest().filter(|_| is_over) {
                return Ok(newest);
            }
            if !self.read(until)? {
                return Err(format!("pictures still come after {patience:?}"));
            }
        }
    }

    /// The newest picture, once its statistics have come too.
    fn newest(&self) -> Option<Arrival> {
        let ((number, at), statistics) = (self.picture?, self.statistics.as_ref()?);
        (statistics.picture == number).then(|| Arrival {
            at,
            saves: statistics.saves,
            frame_ms: statistics.sides.iter().map(|side| side.ms).sum(),
            encode_ms: statistics.encode_ms,
        })
    }

    /// Reads a message; returns whether one came in time.
    fn read(&mut self, until: Instant) -> Result<bool, String> {
        let ended = |error: Error| format!("the page has ended: {error}");
        let left = until.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Ok(false);
        }
        let stream = self.socket.get_ref();
        (stream.set_read_timeout(Some(left))).map_err(|error| ended(error.into()))?;
        match next(&mut self.socket).map_err(ended)? {
            Next::Late => return Ok(false),
            Next::Message(Message::Binary(bytes)) => {
                // A side, and the number of its picture.
                if let Some((&0, rest)) = bytes.split_first()
                    && let Some((number, _)) = rest.split_first_chunk()
                {
                    self.picture = Some((u64::from_le_bytes(*number), Instant::now()));
                    let shown = Message::text("{\"do\":\"shown\"}");
                    self.socket.send(shown).map_err(ended)?;
                }
            }
            Next::Message(Message::Text(text)) => {
                let told: Told = serde_json::from_str(&text)
                    .map_err(|error| format!("the page says what is unknown: {error}"))?;
                self.statistics = told.statistics.or(self.statistics.take());
                self.idle = told.idle.or(self.idle);
                if let Some(scene) = told.scene {
                    self.problems = scene.problems;
                }
            }
            Next::Message(_) | Next::Interrupted => {}
        }
        Ok(true)
    }
}

/// Result of a read of a socket with a time limit.
#[derive(Debug, PartialEq)]
enum Next {
    Message(Message),
    /// Nothing before the limit.
    Late,
    /// Nothing yet: the process was stopped for a moment, and reads on.
    Interrupted,
}

fn next<S: Read + Write>(socket: &mut WebSocket<S>) -> Result<Next, Error> {
    match socket.read() {
        Ok(message) => Ok(Next::Message(message)),
        Err(Error::Io(error)) => match error.kind() {
            ErrorKind::TimedOut | ErrorKind::WouldBlock => Ok(Next::Late),
            ErrorKind::Interrupted => Ok(Next::Interrupted),
            _ => Err(Error::Io(error)),
        },
        Err(error) => Err(error),
    }
}

#[cfg(test)]
mod tests {
    use std::io;

    use tungstenite::protocol::Role;

    use super::*;

    /// A stream that fails between the two halves of a message.
    struct Halting {
        parts: Vec<Result<Vec<u8>, ErrorKind>>,
    }

    impl Read for Halting {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            match self.parts.pop() {
                Some(Ok(bytes)) => {
                    buffer[..bytes.len()].copy_from_slice(&bytes);
                    Ok(bytes.len())
                }
                Some(Err(kind)) => Err(kind.into()),
                None => Ok(0),
            }
        }
    }

    impl Write for Halting {
        fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
            Ok(buffer.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_message_whose_reading_is_interrupted_comes_whole() {
        let mut parts = vec![
            Ok(vec![0x81, 5, b'h']),
            Err(ErrorKind::Interrupted),
            Ok(vec![b'e', b'l', b'l']),
            Err(ErrorKind::WouldBlock),
            Ok(vec![b'o']),
        ];
        parts.reverse();
        let mut socket = WebSocket::from_raw_socket(Halting { parts }, Role::Client, None);
        let mut read = || next(&mut socket);
        assert_eq!(read().expect("it reads on"), Next::Interrupted);
        assert_eq!(read().expect("it reads on"), Next::Late);
        let whole = Next::Message(Message::text("hello"));
        assert_eq!(read().expect("all has come"), whole);
        assert!(read().is_err(), "the other end has closed it");
    }
}
