//! An agent: a client of `reflet mcp` by the library of the protocol.

use std::{process::Child, time::Duration};

use rmcp::{
    RoleClient, ServiceExt as _,
    model::{CallToolRequestParams, CallToolResult, ContentBlock},
    service::{RunningService, ServiceError},
};
use tokio::{
    net::unix::pipe::{Receiver, Sender},
    runtime::{Builder, Runtime},
    task::JoinHandle,
};

use super::*;

/// A client with its server, which ends with it.
pub struct Agent {
    runtime: Runtime,
    client: Option<RunningService<RoleClient, ()>>,
    server: Child,
    is_killed: bool,
}

impl Agent {
    pub fn start(folder: &Path, arguments: &str) -> Self {
        let mut command = reflet(folder, format!("mcp {arguments}"));
        let command = command.stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut server = command.spawn().expect("the program starts");
        let pipes = (server.stdin.take(), server.stdout.take());
        let runtime = Builder::new_current_thread().enable_all().build();
        let runtime = runtime.expect("a runtime");
        let client = runtime.block_on(async {
            let input = Sender::from_owned_fd(pipes.0.expect("piped").into());
            let output = Receiver::from_owned_fd(pipes.1.expect("piped").into());
            let pipes = (output.expect("a pipe"), input.expect("a pipe"));
            let client = ().serve(pipes).await.expect("it answers");
            let tools = client.list_all_tools().await.expect("a list");
            for tool in tools {
                let arguments = tool.input_schema["properties"].as_object();
                let mut arguments = arguments.expect("a table").values();
                assert!(arguments.all(|arg| arg["description"].is_string()));
                assert!(tool.description.is_some_and(|about| about.len() > 50));
            }
            client
        });
        let client = Some(client);
        Self {
            runtime,
            client,
            server,
            is_killed: false,
        }
    }

    /// Begins a call; its answer is read while another one is waited for.
    fn begin(
        &self,
        tool: &str,
        arguments: &str,
    ) -> JoinHandle<Result<CallToolResult, ServiceError>> {
        let arguments = serde_json::from_str(arguments).expect(arguments);
        let call = CallToolRequestParams::new(tool.to_owned()).with_arguments(arguments);
        let peer = self.client.as_ref().expect("it runs").peer().clone();
        self.runtime
            .spawn(async move { peer.call_tool(call).await })
    }

    /// Number of errors of as many calls at a time, and the words of the answers, with sizes of pictures.
    pub fn call(&self, (tool, arguments): (&str, &str), count: usize) -> (usize, String) {
        let calls: Vec<_> = (0..count).map(|_| self.begin(tool, arguments)).collect();
        let answers = calls.into_iter().map(|call| self.runtime.block_on(call));
        let answers: Vec<_> = answers
            .map(|a| a.expect("it ends").expect("an answer"))
            .collect();
        let blocks = answers.iter().flat_map(|answer| &answer.content);
        let words = blocks.map(|block| match block {
            ContentBlock::Text(text) => text.text.clone(),
            ContentBlock::Image(image) => {
                let png = data_encoding::BASE64.decode(image.data.as_bytes());
                let picture = image::load_from_memory(&png.expect("base64"));
                let picture = picture.expect("a picture");
                format!("picture of {} x {}", picture.width(), picture.height())
            }
            block => panic!("{block:?}"),
        });
        let words = words.collect::<Vec<_>>().join("\n");
        let is_error = |answer: &&CallToolResult| answer.is_error == Some(true);
        (answers.iter().filter(is_error).count(), words)
    }
}

impl Drop for Agent {
    fn drop(&mut self) {
        let client = self.client.take().expect("it runs");
        let _ = self.runtime.block_on(client.cancel());
        let ended = self.server.wait().expect("it ends");
        assert!(
            ended.success() || self.is_killed || std::thread::panicking(),
            "{ended}"
        );
    }
}

/// A call, which would render for an hour, ends with a server that is killed.
#[cfg(target_os = "linux")]
#[test]
fn a_call_ends_with_a_server_that_is_killed() {
    or_skip!(gpu_or_skip());
    let mut agent = Agent::start(&folder("killed-server"), "");
    let call = r#"{"scene": "scene.toml", "size": "2000x2000", "samples": 4096}"#;
    let _call = agent.begin("render", call);
    // State and parent of a process; none of one that has ended.
    let stat = |pid: u32| {
        let stat = fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
        let mut words = stat.rsplit_once(") ")?.1.split(' ');
        Some((words.next()? == "Z", words.next()?.parse::<u32>().ok()?))
    };
    let poll = |agent: &Agent| {
        let wait = async { tokio::time::sleep(Duration::from_millis(50)).await };
        agent.runtime.block_on(wait); // the client sends meanwhile
    };
    let is_call = |pid: &u32| stat(*pid).is_some_and(|(_, parent)| parent == agent.server.id());
    let call = (0..1200).find_map(|_| {
        poll(&agent);
        let all = names(Path::new("/proc")).into_iter();
        all.filter_map(|name| name.parse().ok()).find(is_call)
    });
    let call = call.expect("it begins within a minute");
    agent.server.kill().expect("it runs");
    agent.is_killed = true;
    agent.server.wait().expect("it ends");
    // An orphan that nobody waits for stays as a zombie.
    let ended = (0..1200).any(|_| {
        poll(&agent);
        stat(call).is_none_or(|(is_zombie, _)| is_zombie)
    });
    assert!(ended, "within a minute");
}
