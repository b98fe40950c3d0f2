//! Requests to the page's port: token, host, origin, and texts that are no requests.

use std::{
    io::{Read as _, Write as _},
    net::{Shutdown, TcpListener, TcpStream},
    thread,
};

use super::{hub::Hub, *};

const SOCKET: &str = "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n\
                      Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";

fn access() -> Access {
    Access {
        token: "0123456789abcdef".to_owned(),
        host: Some("render.example".to_owned()),
    }
}

/// First line of the answer to a request, empty if there is none.
fn answer_to(request: &str) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let mut client = TcpStream::connect(listener.local_addr().expect("bound")).expect("connects");
    let (mut server, _) = listener.accept().expect("accepts");
    let meets = thread::spawn(move || {
        let (events, _kept) = std::sync::mpsc::channel();
        let _ = meet(&mut server, &access(), &Hub::default(), &events);
    });
    // Refused before it is sent whole, perhaps.
    let _ = client.write_all(request.as_bytes());
    let _ = client.shutdown(Shutdown::Write);
    let mut answer = Vec::new();
    let _ = client.read_to_end(&mut answer);
    meets.join().expect("no panic");
    let answer = String::from_utf8_lossy(&answer).into_owned();
    answer.lines().next().unwrap_or_default().to_owned()
}

fn get(path: &str, host: &str, more: &str) -> String {
    answer_to(&format!(
        "GET {path} HTTP/1.1\r\nHost: {host}\r\n{more}\r\n"
    ))
}

#[test]
fn only_the_token_opens_the_page() {
    for file in ["", "page.js", "style.css"] {
        let path = format!("/0123456789abcdef/{file}");
        assert_eq!(get(&path, "127.0.0.1:1", ""), "HTTP/1.1 200 OK", "{path}");
    }
    for path in [
        "/",
        "/0123456789abcdee/",
        "/0123456789abcdef0/",
        "/0123456789abcde/",
        "/0123456789ABCDEF/socket",
    ] {
        let more = format!("{SOCKET}Origin: http://127.0.0.1:1\r\n");
        assert_eq!(
            get(path, "127.0.0.1:1", &more),
            "HTTP/1.1 403 Forbidden",
            "{path}"
        );
    }
    let path = "/0123456789abcdef/other";
    assert_eq!(get(path, "localhost", ""), "HTTP/1.1 404 Not Found");
}

#[test]
fn names_of_strangers_are_refused() {
    let page = "/0123456789abcdef/";
    for host in [
        "localhost:9000",
        "[::1]:80",
        "192.0.2.7",
        "render.example:80",
        "LOCALHOST",
    ] {
        assert_eq!(get(page, host, ""), "HTTP/1.1 200 OK", "{host}");
    }
    for host in [
        "evil.example",
        "127.0.0.1.evil.example:80",
        "localhost.evil.example",
        "",
    ] {
        assert_eq!(get(page, host, ""), "HTTP/1.1 403 Forbidden", "{host}");
    }
    let twice = "Host: localhost\r\n";
    assert_eq!(get(page, "localhost", twice), "HTTP/1.1 403 Forbidden");
}

#[test]
fn the_socket_is_for_the_own_page_alone() {
    let socket = "/0123456789abcdef/socket";
    let with = |origin: &str| get(socket, "localhost:9000", &format!("{SOCKET}{origin}"));
    assert_eq!(
        with("Origin: http://localhost:9000\r\n"),
        "HTTP/1.1 101 Switching Protocols"
    );
    for origin in [
        "",
        "Origin: null\r\n",
        "Origin: http://localhost:9001\r\n",
        "Origin: https://localhost:9000\r\n",
    ] {
        assert_eq!(with(origin), "HTTP/1.1 403 Forbidden", "{origin}");
    }
    let plain = get(
        socket,
        "localhost:9000",
        "Origin: http://localhost:9000\r\n",
    );
    assert_eq!(plain, "HTTP/1.1 400 Bad Request");
}

#[test]
fn what_is_no_request_is_not_answered() {
    let long = format!("GET /{} HTTP/1.1\r\n", "a".repeat(20_000));
    for text in [
        "",
        "hello\r\n\r\n",
        "\u{0}\u{1}\u{2}\r\n\r\n",
        "GET / HTTP/1.1\r\nHost",
        long.as_str(),
    ] {
        assert_eq!(answer_to(text), "", "{:.40}", text);
    }
    let post = answer_to("POST /0123456789abcdef/ HTTP/1.1\r\nHost: localhost\r\n\r\n");
    assert_eq!(post, "HTTP/1.1 405 Method Not Allowed");
}

#[test]
fn messages_without_meaning_are_no_input() {
    let read = |text: &str| serde_json::from_str::<Input>(text).ok();
    assert_eq!(
        read("{\"do\":\"orbit\",\"by\":[0.5,-1]}"),
        Some(Input::Orbit { by: [0.5, -1.0] })
    );
    for text in [
        "",
        "7",
        "{}",
        "{\"do\":\"end\"}",
        "{\"do\":\"orbit\"}",
        "{\"do\":\"step\",\"by\":1e99}",
        "[[[[",
    ] {
        assert_eq!(read(text), None, "{text}");
    }
}

#[test]
fn the_newest_picture_waits_until_the_one_before_is_shown() {
    let hub = Hub::default();
    let outbox = hub.join().expect("the first");
    let picture = |byte: u8| [Some(Arc::from(vec![byte])), None];
    hub.pictures(picture(1));
    let taken = |outbox: &hub::Outbox| match outbox.next() {
        Some(Parcel::Pictures([Some(bytes), None])) => bytes[0],
        _ => panic!("a picture waits"),
    };
    assert_eq!(taken(&outbox), 1);
    hub.pictures(picture(2));
    hub.pictures(picture(3));
    hub.text("view", "first");
    hub.text("view", "second");
    assert!(matches!(outbox.next(), Some(Parcel::Text(text)) if &*text == "second"));
    outbox.shown();
    assert_eq!(taken(&outbox), 3, "2 was replaced");
    let others: Vec<_> = std::iter::from_fn(|| hub.join()).take(20).collect();
    assert_eq!(others.len(), 7, "8 viewers at most");
    assert!(matches!(others[0].next(), Some(Parcel::Text(text)) if &*text == "second"));
    assert_eq!(taken(&others[0]), 3, "a new viewer sees what is shown");
    hub.leave(&outbox);
    assert!(outbox.next().is_none() && hub.join().is_some());
}
