//! `mcp`: a server of the Model Context Protocol, by which agents check, ask and render scenes, on standard input and
//! output. Each call is a command in a process of its own, which ends with its time; its memory and its crashes too.

mod call;
mod tools;

use std::{
    fs,
    path::{Path, PathBuf},
    sync::Arc,
    time::{Duration, Instant},
};

use clap::{Args, Command};
use rmcp::{
    ErrorData, RoleServer, ServerHandler, ServiceExt as _, model,
    model::{CallToolResult, ContentBlock},
    service::{RequestContext, ServerInitializeError},
    transport::stdio,
};
use serde_json::{Value, json};
use tokio::{runtime::Builder, sync::Semaphore, task::spawn_blocking, time::timeout};

use self::tools::{Tool, tools};
use super::{args::parse_time, error::AppError, shutdown};
use crate::{
    files::{Goal, write_new},
    scene::{project::find, reach::lexical},
};

/// Number of calls that run at a time; others wait.
const MOST_CALLS: usize = 2;
/// Interval in which ends of processes, and requests to end, are noticed.
const TICK: Duration = Duration::from_millis(10);
const OUTPUT: &str = "output";

/// Arguments of `mcp`.
#[derive(Clone, Debug, Args)]
pub struct McpArgs {
    /// Folder of the project, outside of which no call names a file; without it the current folder
    #[arg(default_value = ".", hide_default_value = true)]
    pub folder: PathBuf,
    /// Folder below which calls may write pictures; without it nothing is written
    #[arg(long, value_name = "DIR", value_hint = clap::ValueHint::DirPath)]
    pub write: Option<PathBuf>,
    /// Time after which a call is given up, such as 90s or 2m
    #[arg(long, value_name = "TIME", default_value = "60s", value_parser = parse_time)]
    pub timeout: Duration,
}

/// Serves one client until it closes its pipe; `program` has the commands that it calls.
///
/// # Errors
/// [`AppError::Usage`] for folders that are not there and a client of another protocol.
pub fn mcp(args: &McpArgs, program: &Command) -> Result<(), AppError> {
    let real = |folder: &Path| {
        let found = folder.read_dir().and_then(|_| folder.canonicalize());
        found.map_err(|error| AppError::Usage(format!("{}: {error}", folder.display())))
    };
    if let Some(write) = args.write.as_ref().filter(|write| !write.exists()) {
        let made = fs::create_dir_all(write);
        made.map_err(|error| AppError::unwritten(write, &error))?;
    }
    let server = Server(Arc::new(Served {
        tools: tools(program),
        folder: real(&args.folder)?,
        write: args.write.as_deref().map(real).transpose()?,
        timeout: args.timeout,
        turns: Semaphore::new(MOST_CALLS),
    }));
    let runtime = Builder::new_current_thread().enable_all().build();
    let runtime = runtime.map_err(|error| AppError::Internal(error.to_string()))?;
    shutdown::listen();
    let served = runtime.block_on(async {
        let mut served = Box::pin(async {
            match server.serve(stdio()).await {
                Err(ServerInitializeError::ConnectionClosed(_)) => {
                    reflet_base::error_line!("the client of `mcp` left before it began a session");
                    Ok(())
                }
                Err(error) => Err(AppError::Usage(format!("the client of `mcp`: {error}"))),
                Ok(running) => {
                    let _ = running.waiting().await; // a panic was reported
                    Ok(())
                }
            }
        });
        loop {
            match timeout(TICK, &mut served).await {
                Ok(served) => return served,
                Err(_) if shutdown::is_requested() => {
                    return Err(AppError::Interrupted("stopped".to_owned()));
                }
                Err(_) => {}
            }
        }
    });
    // A thread that waits for standard input does not end.
    runtime.shutdown_timeout(Duration::from_secs(1));
    served
}

/// The server of one client.
struct Server(Arc<Served>);

struct Served {
    tools: Vec<Tool>,
    /// Canonical folder of the project.
    folder: PathBuf,
    /// Canonical folder of written pictures.
    write: Option<PathBuf>,
    timeout: Duration,
    turns: Semaphore,
}

impl ServerHandler for Server {
    fn get_info(&self) -> model::ServerConfig {
        let name = model::Implementation::new("reflet", env!("CARGO_PKG_VERSION"));
        let tools = model::ServerCapabilities::builder().enable_tools().build();
        let text = format!(
            "Reflet renders scenes that are written as TOML. Write scenes below {} with your own tools, `check` them, whose \
             messages say what to write instead, look at a small picture by `render`, and verify it by `query`. `manual` \
             explains tables and keys.",
            self.0.folder.display()
        );
        model::ServerConfig::new(tools)
            .with_server_info(name)
            .with_instructions(text)
    }

    async fn list_tools(
        &self,
        _: Option<model::PaginatedRequestParams>,
        _: RequestContext<RoleServer>,
    ) -> Result<model::ListToolsResult, ErrorData> {
        let tools = self.0.tools.iter().map(|tool| {
            let mut schema = tool.schema();
            if self.0.writes(tool) {
                let text = "Name of a new .png file in the folder of pictures, to write the picture there too";
                schema["properties"][OUTPUT] = json!({ "type": "string", "description": text });
            }
            let hints = model::ToolAnnotations::new().read_only(!self.0.writes(tool));
            model::Tool::new(tool.name.clone(), tool.about.clone(), schema).with_annotations(hints)
        });
        Ok(model::ListToolsResult::with_all_items(tools.collect()))
    }

    async fn call_tool(
        &self,
        request: model::CallToolRequestParams,
        context: RequestContext<RoleServer>,
    ) -> Result<model::CallToolResponse, ErrorData> {
        let (served, until) = (Arc::clone(&self.0), Instant::now() + self.0.timeout);
        let done = match timeout(served.timeout, self.0.turns.acquire()).await {
            Ok(_turn) => {
                let is_stopped = move || context.ct.is_cancelled() || shutdown::is_requested();
                let answer = spawn_blocking(move || served.answer(request, until, &is_stopped));
                answer.await.unwrap_or_else(|panic| Err(panic.to_string()))
            }
            Err(_) => Err("other calls took all of the time; call again".to_owned()),
        };
        let failed = |error| CallToolResult::error(vec![ContentBlock::text(error)]);
        Ok(done.unwrap_or_else(failed).into())
    }
}

impl Served {
    /// Whether a tool makes pictures that may be written.
    fn writes(&self, tool: &Tool) -> bool {
        self.write.is_some() && tool.picture.as_deref() == Some("--output")
    }

    fn answer(
        &self,
        request: model::CallToolRequestParams,
        until: Instant,
        is_stopped: &dyn Fn() -> bool,
    ) -> Result<CallToolResult, String> {
        let mut arguments = request.arguments.unwrap_or_default();
        let tool = self.tools.iter().find(|tool| tool.name == request.name);
        let tool = tool.ok_or_else(|| format!("there is no tool `{}`", request.name))?;
        let output = self.write.as_ref().filter(|_| self.writes(tool));
        let output = output.and_then(|folder| Some((folder, arguments.remove(OUTPUT)?)));
        let output = output
            .map(|(folder, name)| goal(folder, &name))
            .transpose()?;
        let words = tool.words(&arguments, &|name| self.path(name))?;
        let (mut answer, picture) = call::make(tool, &words, &self.folder, until, is_stopped)?;
        if let (Some(goal), Some(picture)) = (output, picture) {
            let path = goal.display();
            let made = goal.make_folders().and_then(|_| write_new(&goal, &picture));
            made.map_err(|error| format!("{path}: {error}; choose another name"))?;
            answer
                .content
                .push(ContentBlock::text(format!("wrote {path}")));
        }
        Ok(answer)
    }

    /// A path of a call from the folder of the project, after links.
    fn path(&self, name: &str) -> Result<String, String> {
        let is_inside = |path: &Path| {
            let mut roots = self.write.iter().chain([&self.folder]);
            roots.any(|root| path.starts_with(root))
        };
        let path = self.folder.join(name).canonicalize().ok();
        // Commands that walk a folder would follow its links to files.
        let path = path.filter(|path| is_inside(path) && path.is_file());
        let path = path.ok_or_else(|| {
            let folder = self.folder.display();
            format!("{name}: there is no such file below {folder}, the folder of this server")
        })?;
        // A project lets its scenes read all of its folder.
        let project = path.parent().and_then(find);
        let outer = project.as_deref().and_then(Path::parent);
        if let Some(outer) = outer.filter(|outer| !is_inside(outer)) {
            let outer = outer.display();
            return Err(format!(
                "{name} is of the project {outer}, of which this server may read a part alone: start `reflet mcp {outer}`"
            ));
        }
        let path = path.strip_prefix(&self.folder).unwrap_or(&path);
        Ok(path.to_string_lossy().into_owned())
    }
}

/// Place of a new picture below a folder.
fn goal(folder: &Path, name: &Value) -> Result<Goal, String> {
    let refuse = |why: &str| format!("`{OUTPUT}` {name}: {why}");
    let path = name
        .as_str()
        .filter(|name| name.ends_with(".png") && !name.contains(['#', '{']));
    let path = path.and_then(|name| lexical(folder, Path::new(name)));
    let path = path.filter(|path| path.starts_with(folder));
    let why = "write the name of a .png below the folder of pictures, without #### and {camera}";
    let path = path.ok_or_else(|| refuse(why))?;
    match path.symlink_metadata() {
        Ok(_) => Err(refuse("there is such a file; choose another name")),
        Err(_) => Ok(Goal::within(folder, path)),
    }
}
