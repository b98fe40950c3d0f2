//! Requests to the page's port: token, host, origin, and texts that are no requests.

use std::{
    io::{Read as _, Write as _},
    net::{Shutdown, TcpListener, TcpStream},
    thread,
};

use super::{hub::Hub, *};
use crate::write_back::presses::KeyAction;

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

#[test]
fn requests_have_their_status() {
    let cases = include_str!("tests/requests.txt").lines();
    let cases: Vec<_> = cases
        .filter(|l| !l.is_empty() && !l.starts_with('#'))
        .collect();
    assert_eq!(cases.len(), 26);
    for line in cases {
        let mut words = line.split(' ');
        let [status, path, host] = [(); 3].map(|()| words.next().expect(line));
        let headers = words.map(|word| match word {
            "socket" => SOCKET.to_owned(),
            header => format!("{header}\r\n"),
        });
        let path = path.replace("{token}", "/0123456789abcdef");
        let (host, headers) = (host.trim_matches('-'), headers.collect::<String>());
        let request = format!("GET {path} HTTP/1.1\r\nHost: {host}\r\n{headers}\r\n");
        let answer = answer_to(&request);
        let expected = format!("HTTP/1.1 {status} ");
        assert!(answer.starts_with(&expected), "{line}: {answer}");
    }
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
    for text in include_str!("tests/no_input.txt").lines() {
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

type Client = WebSocket<TcpStream>;

/// Viewers on sockets of the page, and the events of the session that they share.
struct Viewers {
    hub: Hub,
    events: std::sync::mpsc::Receiver<Event>,
    sender: Sender<Event>,
}

impl Viewers {
    fn new() -> Self {
        let (sender, events) = std::sync::mpsc::channel();
        Self {
            hub: Hub::default(),
            events,
            sender,
        }
    }

    fn join(&self) -> (Client, thread::JoinHandle<()>) {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let at = listener.local_addr().expect("bound");
        let stream = TcpStream::connect(at).expect("connects");
        let (mut server, _) = listener.accept().expect("accepts");
        let (hub, sender) = (self.hub.clone(), self.sender.clone());
        let meets = thread::spawn(move || drop(meet(&mut server, &access(), &hub, &sender)));
        let request = tungstenite::http::Request::builder()
            .uri(format!("ws://{at}/0123456789abcdef/socket"))
            .header("Host", at.to_string())
            .header("Origin", format!("http://{at}"))
            .header("Upgrade", "websocket")
            .header("Connection", "Upgrade")
            .header("Sec-WebSocket-Version", "13")
            .header("Sec-WebSocket-Key", "dGhlIHNhbXBsZSBub25jZQ==")
            .body(())
            .expect("a request");
        let (client, _) = tungstenite::client(request, stream).expect("it is the own page");
        (client, meets)
    }

    /// The next input of a viewer.
    fn input(&self) -> Input {
        loop {
            match self.events.recv_timeout(Duration::from_secs(60)) {
                Ok(Event::Input(input)) => return input,
                Ok(_) => {}
                Err(error) => panic!("no input came: {error}"),
            }
        }
    }
}

#[test]
fn two_viewers_that_drag_at_once_are_both_heard_and_both_see_it() {
    let viewers = Viewers::new();
    let (mut one, first) = viewers.join();
    let (mut other, second) = viewers.join();
    let drag = |by: i32| Message::text(format!("{{\"do\":\"orbit\",\"by\":[{by},0]}}"));
    let mut heard = Vec::new();
    for by in 0..4 {
        one.send(drag(by)).expect("sent");
        other.send(drag(10 + by)).expect("sent");
        heard.extend([viewers.input(), viewers.input()]);
    }
    let orbit = |by: i32| Input::Orbit {
        by: [by as f32, 0.0],
    };
    assert!((0..4).all(|by| heard.contains(&orbit(by)) && heard.contains(&orbit(10 + by))));
    viewers.hub.text("view", "where both have moved it");
    for client in [&mut one, &mut other] {
        let told = client.read().expect("told");
        assert_eq!(told.to_text().expect("a text"), "where both have moved it");
    }
    drop((one, other));
    for viewer in [first, second] {
        viewer.join().expect("no panic");
    }
    assert!(viewers.hub.is_empty(), "both have left");
}

#[test]
fn who_leaves_in_a_drag_is_told_apart() {
    for line in include_str!("tests/drags.txt").lines().skip(1) {
        let (says, want) = line.split_once(" => ").expect(line);
        let viewers = Viewers::new();
        let (mut client, ends) = viewers.join();
        for text in says.split_terminator(' ') {
            client.send(Message::text(text)).expect("sent");
        }
        drop(client);
        ends.join().expect("no panic");
        let left = viewers.events.try_iter().find_map(|event| match event {
            Event::Left(unfinished) => Some(format!("{unfinished:?}")),
            _ => None,
        });
        assert_eq!(left.as_deref(), Some(want), "{says}");
    }
}

#[test]
fn garbage_and_long_messages_end_a_connection_and_nothing_else() {
    let viewers = Viewers::new();
    let (mut other, stays) = viewers.join();
    let (mut client, ends) = viewers.join();
    for text in ["{\"do\":\"explode\"}", "7", "", "\u{1f600}"]
        .iter()
        .cycle()
        .take(MOST_GARBAGE as usize)
    {
        // The last ones may meet a closed connection.
        let _ = client.send(Message::text(*text));
    }
    ends.join().expect("no panic");
    while client.read().is_ok() {}
    let (mut client, ends) = viewers.join();
    let _ = client.send(Message::text("x".repeat(MOST_MESSAGE + 1)));
    ends.join().expect("no panic");
    let (mut client, ends) = viewers.join();
    client.send(Message::binary(vec![0; 100])).expect("sent");
    drop(client);
    ends.join().expect("no panic");
    other
        .send(Message::text("{\"do\":\"press\",\"action\":\"wipe\"}"))
        .expect("sent");
    assert_eq!(
        viewers.input(),
        Input::Press {
            action: KeyAction::Wipe
        },
        "the first that means something"
    );
    drop(other);
    stays.join().expect("no panic");
}

#[test]
fn messages_of_a_second_and_connections_are_counted() {
    let start = Instant::now();
    let mut rate = Rate::starting(start);
    assert!((0..MOST_RATE).all(|_| rate.allows(start)));
    assert!(!rate.allows(start + Duration::from_millis(999)));
    assert!(rate.allows(start + Duration::from_secs(1)));
    let count = Arc::new(AtomicUsize::new(0));
    let slots: Vec<_> = (0..MOST_CONNECTIONS).map(|_| Slot::take(&count)).collect();
    assert!(slots.iter().all(Option::is_some) && Slot::take(&count).is_none());
    drop(slots);
    assert!(Slot::take(&count).is_some());
}

#[test]
fn a_port_without_a_host_is_told_how_to_write_it() {
    let Err(ServeError::Address(why)) = Port::listen(Some("8040")) else {
        panic!("it is no host");
    };
    assert!(why.contains("write `:8040`"), "{why}");
    // Where the machine has no such address, it cannot be listened at, which is another message.
    if let Err(ServeError::Address(why)) = Port::listen(Some("[::1]")) {
        assert!(why.contains("cannot listen at ::1:0"), "{why}");
    }
}

#[test]
fn a_thousand_wrong_tokens_open_nothing() {
    let access = access();
    for wrong in 0..1000 {
        let request = tungstenite::http::Request::builder()
            .uri(format!("/{wrong:016x}/"))
            .header("Host", "localhost")
            .body(())
            .expect("a request");
        assert!(
            matches!(access.route(&request), Route::Refused(403, _)),
            "{wrong}"
        );
    }
}
