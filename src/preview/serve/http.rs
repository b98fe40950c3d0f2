//! Requests of browsers: read with limits, and checked before anything is answered.

use std::{
    io::{self, Read, Write},
    net::{IpAddr, TcpStream},
    time::{Duration, Instant},
};

use reflet_write_back::page;
use subtle::ConstantTimeEq;
use tungstenite::http::{self, HeaderMap};

/// Most bytes of a request, and the time in which it has to come.
const MOST_BYTES: usize = 8 * 1024;
const MOST_WAIT: Duration = Duration::from_secs(5);
const MOST_HEADERS: usize = 64;

/// Policy of the page: its own files and its own socket alone, in no frame of another page.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src blob:; \
                      connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// Files of the page's own, each with its name below the token and its text; the panels are of both pages.
const FILES: [(&str, &str); 2] = [
    ("", include_str!("page/index.html")),
    ("page.js", include_str!("page/page.js")),
];

/// Token and host name that a request must have.
#[derive(Clone, Debug)]
pub(super) struct Access {
    /// First part of every path.
    pub(super) token: String,
    /// Name of the host that the user wrote, if it was no address.
    pub(super) host: Option<String>,
}

/// Answer to a request.
#[derive(Debug)]
pub(super) enum Route {
    /// A file of the page: its type and its text.
    File(&'static str, &'static str),
    /// The picture as a PNG file, with the line of a wipe at this place, 0 to 1.
    Picture(f32),
    /// The socket.
    Socket,
    /// Refused: status and reason.
    Refused(u16, &'static str),
}

/// Reads a request, and the bytes after it.
pub(super) fn read(stream: &mut TcpStream) -> io::Result<(http::Request<()>, Vec<u8>)> {
    let invalid = || io::Error::from(io::ErrorKind::InvalidData);
    let until = Instant::now() + MOST_WAIT;
    let (mut bytes, mut part) = (Vec::new(), [0; 1024]);
    loop {
        let left = until.saturating_duration_since(Instant::now());
        if left.is_zero() || bytes.len() > MOST_BYTES {
            return Err(invalid());
        }
        stream.set_read_timeout(Some(left))?;
        let count = stream.read(&mut part)?;
        if count == 0 {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        bytes.extend_from_slice(&part[..count]);
        let mut headers = [httparse::EMPTY_HEADER; MOST_HEADERS];
        let mut parsed = httparse::Request::new(&mut headers);
        let status = parsed.parse(&bytes).map_err(|_| invalid())?;
        let httparse::Status::Complete(end) = status else {
            continue;
        };
        let mut request = http::Request::builder()
            .method(parsed.method.unwrap_or_default())
            .uri(parsed.path.unwrap_or_default())
            .version(http::Version::HTTP_11);
        for header in parsed.headers.iter() {
            request = request.header(header.name, header.value);
        }
        let request = request.body(()).map_err(|_| invalid())?;
        return Ok((request, bytes[end..].to_vec()));
    }
}

/// The only value of a header.
fn only<'a>(headers: &'a HeaderMap, name: &str) -> Option<&'a str> {
    let mut all = headers.get_all(name).iter();
    let value = all.next()?.to_str().ok()?;
    all.next().is_none().then_some(value)
}

impl Access {
    /// Whether a `Host` is an address, `localhost` or the name that the user wrote: a name that a stranger's page
    /// resolves to this machine is refused (DNS rebinding). The port may be a tunnel's.
    fn knows(&self, host: &str) -> bool {
        let is_port = |port: &str| port.bytes().all(|byte| byte.is_ascii_digit());
        let name = match host.rsplit_once(':') {
            Some((name, port)) if is_port(port) && !port.is_empty() => name,
            _ => host,
        };
        let address = name.trim_start_matches('[').trim_end_matches(']');
        name.eq_ignore_ascii_case("localhost")
            || address.parse::<IpAddr>().is_ok()
            || (self.host.as_ref()).is_some_and(|own| own.eq_ignore_ascii_case(name))
    }

    /// Decides about a request.
    pub(super) fn route(&self, request: &http::Request<()>) -> Route {
        let headers = request.headers();
        let Some(host) = only(headers, "host").filter(|host| self.knows(host)) else {
            return Route::Refused(403, "this host name is not one of the preview");
        };
        let path = request.uri().path().trim_start_matches('/');
        let (token, file) = path.split_once('/').unwrap_or((path, "-"));
        if !bool::from(token.as_bytes().ct_eq(self.token.as_bytes())) {
            return Route::Refused(
                403,
                "open the address that the preview has printed, with its token",
            );
        }
        if request.method() != http::Method::GET {
            return Route::Refused(405, "only GET is answered");
        }
        if file == "-" {
            return Route::Refused(404, "the address of the page ends with `/`");
        }
        if file == "socket" {
            let own = format!("http://{host}");
            return match only(headers, "origin").is_some_and(|origin| origin == own) {
                true => Route::Socket,
                false => Route::Refused(403, "the socket is for the preview's own page"),
            };
        }
        if file == "picture.png" {
            let at = request
                .uri()
                .query()
                .and_then(|query| query.strip_prefix("wipe="));
            let at = at
                .and_then(|at| at.parse().ok())
                .filter(|at| (0.0..=1.0).contains(at));
            return Route::Picture(at.unwrap_or(0.5));
        }
        let found = FILES
            .iter()
            .chain(&page::FILES)
            .find(|(name, _)| *name == file);
        found.map_or(
            Route::Refused(404, "there is no such file"),
            |(name, text)| {
                let kind = match name.rsplit_once('.') {
                    Some((_, "js")) => "text/javascript",
                    Some((_, "css")) => "text/css",
                    _ => "text/html",
                };
                Route::File(kind, text)
            },
        )
    }
}

/// Answers with a text.
pub(super) fn answer(
    stream: &mut TcpStream,
    status: u16,
    kind: &str,
    text: &str,
) -> io::Result<()> {
    let kind = format!("{kind}; charset=utf-8");
    answer_bytes(stream, status, &kind, text.as_bytes())
}

/// Answers with bytes.
pub(super) fn answer_bytes(
    stream: &mut TcpStream,
    status: u16,
    kind: &str,
    bytes: &[u8],
) -> io::Result<()> {
    let status = http::StatusCode::from_u16(status).unwrap_or_default();
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\n\
         Content-Security-Policy: {POLICY}\r\nX-Content-Type-Options: nosniff\r\n\
         Referrer-Policy: no-referrer\r\nCross-Origin-Resource-Policy: same-origin\r\n\
         Cache-Control: no-store\r\nConnection: close\r\n\r\n",
        bytes.len(),
    )?;
    stream.write_all(bytes)?;
    stream.flush()
}
