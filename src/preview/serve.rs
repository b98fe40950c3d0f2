//! A page with a scene that follows its files: the render thread of the window, shown by browsers over one port.

use std::{
    io::{self, Read, Write},
    net::{IpAddr, SocketAddr, TcpListener, TcpStream, ToSocketAddrs},
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
        mpsc::{self, Sender},
    },
    thread,
    time::{Duration, Instant},
};

use tungstenite::{
    Message, WebSocket,
    handshake::server::{create_response, write_response},
    protocol::{Role, WebSocketConfig},
};

use crate::{
    viewer::opening::ViewerOptions,
    write_back::input::{Input, Unfinished},
};
use reflet_gpu::Gpu;
use reflet_render::runtime::SessionError;

mod actions;
pub mod client;
mod handles;
mod http;
mod hub;
mod session;
mod state;

use http::{Access, Route};
use hub::{Hub, Outbox, Parcel};
use session::Event;

#[cfg(test)]
mod tests;

/// Most connections at a time, also before they are viewers.
const MOST_CONNECTIONS: usize = 32;
/// Most bytes of a message from a page.
const MOST_MESSAGE: usize = 16 * 1024;
/// Most messages of a page in a second; more are dropped.
const MOST_RATE: u32 = 240;
/// Messages without meaning after which a page is sent away.
const MOST_GARBAGE: u32 = 20;
/// Longest wait for a connection that takes no bytes.
const WRITE_WAIT: Duration = Duration::from_secs(20);
/// Longest wait for a picture as a file.
const PICTURE_WAIT: Duration = Duration::from_secs(600);
/// Interval in which connections and the end are noticed.
const POLL: Duration = Duration::from_millis(20);

/// Error that keeps the page from being served.
#[derive(Debug)]
pub enum ServeError {
    /// The scene cannot be opened, or lacks the camera.
    Session(SessionError),
    /// The address cannot be listened at, with what to do.
    Address(String),
}

impl From<SessionError> for ServeError {
    fn from(error: SessionError) -> Self {
        Self::Session(error)
    }
}

/// A port that is listened at.
#[derive(Debug)]
pub struct Port {
    listener: TcpListener,
    access: Access,
    /// Address of the page, with the token: whoever knows it may look and change the scene.
    pub url: String,
    /// Whether other machines can reach it.
    pub is_open: bool,
}

impl Port {
    /// Listens at an address, `HOST:PORT`, `HOST` or `:PORT`; without one, at a free port of 127.0.0.1.
    ///
    /// # Errors
    /// An address that is none, or is in use.
    pub fn listen(address: Option<&str>) -> Result<Self, ServeError> {
        let given = address.unwrap_or_default();
        if given.parse::<u16>().is_ok() {
            let text = format!("`{given}` is a port without a host: write `:{given}`");
            return Err(ServeError::Address(text));
        }
        let is_bare =
            given.parse::<IpAddr>().is_ok() || !given.contains(':') || given.ends_with(']');
        let host = match (given.is_empty(), is_bare, given.rsplit_once(':')) {
            (true, ..) => "127.0.0.1",
            (_, false, Some(("", _))) => "127.0.0.1",
            (_, false, Some((host, _))) => host,
            _ => given,
        };
        let host = host.trim_start_matches('[').trim_end_matches(']');
        let port = match given.rsplit_once(':').filter(|_| !is_bare) {
            Some((_, port)) => port.parse::<u16>().map_err(|_| {
                ServeError::Address(format!("`{port}` is not a port: write 0 to 65535"))
            })?,
            None => 0,
        };
        let refused = |error: io::Error| {
            let text = format!("cannot listen at {host}:{port}: {error}; name another address");
            ServeError::Address(text)
        };
        let found = (host, port).to_socket_addrs().map_err(refused)?;
        let found: Vec<SocketAddr> = found.collect();
        let listener = TcpListener::bind(found.as_slice()).map_err(refused)?;
        listener.set_nonblocking(true).map_err(refused)?;
        let at = listener.local_addr().map_err(refused)?;
        let mut random = [0_u8; 16];
        getrandom::fill(&mut random)
            .map_err(|error| ServeError::Address(format!("the system gives no token: {error}")))?;
        let token: String = random.iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(Self {
            listener,
            url: format!("http://{at}/{token}/"),
            is_open: !at.ip().is_loopback(),
            access: Access {
                token,
                host: host.parse::<IpAddr>().is_err().then(|| host.to_owned()),
            },
        })
    }
}

/// Serves the page until `is_over`, which is asked some 50 times a second.
///
/// # Errors
/// A missing scene, or a camera that the scene does not have.
pub fn serve(
    gpu: Arc<Gpu>,
    options: &ViewerOptions,
    port: Port,
    is_over: &dyn Fn() -> bool,
) -> Result<(), ServeError> {
    let hub = Hub::default();
    let (events, thread) = session::start(gpu, options, hub.clone())?;
    let count = Arc::new(AtomicUsize::new(0));
    while !is_over() && !thread.is_finished() {
        let Ok((mut stream, _)) = port.listener.accept() else {
            thread::sleep(POLL);
            continue;
        };
        let (hub, events, access) = (hub.clone(), events.clone(), port.access.clone());
        let slot = Slot::take(&count);
        let body = move || {
            let done = match &slot {
                Some(_) => meet(&mut stream, &access, &hub, &events),
                None => http::answer(&mut stream, 503, "text/plain", "too many connections\n"),
            };
            // A broken connection concerns its browser alone.
            drop((done, slot));
        };
        // Without a free thread the browser asks again.
        let _ = thread::Builder::new().name("viewer".into()).spawn(body);
    }
    let _ = events.send(Event::End);
    hub.close();
    let _ = thread.join();
    Ok(())
}

/// One of the connections at a time.
struct Slot(Arc<AtomicUsize>);

impl Slot {
    fn take(count: &Arc<AtomicUsize>) -> Option<Self> {
        let slot = Self(count.clone());
        (count.fetch_add(1, Ordering::SeqCst) < MOST_CONNECTIONS).then_some(slot)
    }
}

impl Drop for Slot {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::SeqCst);
    }
}

/// Answers a connection.
fn meet(
    stream: &mut TcpStream,
    access: &Access,
    hub: &Hub,
    events: &Sender<Event>,
) -> io::Result<()> {
    stream.set_nonblocking(false)?;
    stream.set_nodelay(true)?;
    stream.set_write_timeout(Some(WRITE_WAIT))?;
    let (request, rest) = http::read(stream)?;
    match access.route(&request) {
        Route::File(kind, text) => http::answer(stream, 200, kind, text),
        Route::Picture(wipe_at) => {
            let (reply, picture) = mpsc::channel();
            let _ = events.send(Event::Picture(wipe_at, reply));
            match picture.recv_timeout(PICTURE_WAIT) {
                Ok(Ok(png)) => http::answer_bytes(stream, 200, "image/png", &png),
                Ok(Err(why)) => http::answer(stream, 503, "text/plain", &why),
                Err(_) => http::answer(stream, 503, "text/plain", "there is no picture\n"),
            }
        }
        Route::Refused(status, why) => http::answer(stream, status, "text/plain", why),
        Route::Socket => {
            let Ok(response) = create_response(&request) else {
                return http::answer(stream, 400, "text/plain", "not a WebSocket request\n");
            };
            let Some(outbox) = hub.join() else {
                return http::answer(stream, 503, "text/plain", "too many viewers\n");
            };
            let done = write_response(&mut *stream, &response).map_err(io::Error::other);
            let done = done.and_then(|()| talk(stream, rest, &outbox, events));
            hub.leave(&outbox);
            done
        }
    }
}

/// Messages of a page in the current second.
struct Rate {
    since: Instant,
    count: u32,
}

impl Rate {
    fn starting(now: Instant) -> Self {
        Self {
            since: now,
            count: 0,
        }
    }

    /// Counts a message, and tells whether its second has not had too many.
    fn allows(&mut self, now: Instant) -> bool {
        if now.saturating_duration_since(self.since) >= Duration::from_secs(1) {
            *self = Self::starting(now);
        }
        self.count += 1;
        self.count <= MOST_RATE
    }
}

/// The reading half of a connection: the protocol's answers go to the writing half.
struct ReadHalf {
    stream: TcpStream,
    outbox: Outbox,
}

impl Read for ReadHalf {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.stream.read(bytes)
    }
}

impl Write for ReadHalf {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.outbox.answer(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Sends what waits, and reads what the page says, until either ends.
fn talk(
    stream: &TcpStream,
    rest: Vec<u8>,
    outbox: &Outbox,
    events: &Sender<Event>,
) -> io::Result<()> {
    stream.set_read_timeout(None)?;
    let (to, from) = (stream.try_clone()?, stream.try_clone()?);
    let sent = outbox.clone();
    let writer = thread::spawn(move || {
        write_all(&to, &sent);
        // The reading half ends too.
        let _ = to.shutdown(std::net::Shutdown::Both);
    });
    // The first picture is rendered once someone looks.
    let _ = events.send(Event::Joined);
    let half = ReadHalf {
        stream: from,
        outbox: outbox.clone(),
    };
    let limits = WebSocketConfig::default()
        .max_message_size(Some(MOST_MESSAGE))
        .max_frame_size(Some(MOST_MESSAGE));
    let mut socket = WebSocket::from_partially_read(half, rest, Role::Server, Some(limits));
    let (mut rate, mut garbage) = (Rate::starting(Instant::now()), 0);
    let mut unfinished = Unfinished::default();
    while let Ok(message) = socket.read() {
        let is_slow = rate.allows(Instant::now());
        let input = match &message {
            Message::Text(text) => serde_json::from_str(text).ok(),
            Message::Close(_) => break,
            Message::Ping(_) | Message::Pong(_) => continue,
            _ => None,
        };
        match input {
            Some(Input::Shown) => outbox.shown(),
            Some(_) if !is_slow => {}
            Some(input) => {
                unfinished.hear(&input);
                let _ = events.send(Event::Input(input));
            }
            None => {
                garbage += 1;
                outbox.text(
                    "refused",
                    state::message("the page sent what is no message").into(),
                );
                if garbage >= MOST_GARBAGE {
                    break;
                }
            }
        }
    }
    let _ = events.send(Event::Left(unfinished));
    outbox.close();
    let _ = writer.join();
    Ok(())
}

/// The writing half.
fn write_all(mut stream: &TcpStream, outbox: &Outbox) {
    let mut socket = WebSocket::from_raw_socket(stream, Role::Server, None);
    while let Some(parcel) = outbox.next() {
        let is_sent = match parcel {
            Parcel::Answers(bytes) => stream.write_all(&bytes).is_ok(),
            Parcel::Text(text) => socket.send(Message::text(&*text)).is_ok(),
            Parcel::Pictures(sides) => (sides.into_iter().flatten())
                .all(|side| socket.send(Message::binary(side.to_vec())).is_ok()),
        };
        if !is_sent {
            break;
        }
    }
    outbox.close();
}
