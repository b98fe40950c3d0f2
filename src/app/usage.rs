//! Mistakes in command lines, with the command or the argument to write instead.

use std::{path::Path, process};

use clap::error::{ContextKind, ContextValue};

/// Commands of other programs, and what to write instead.
const COMMANDS: &[(&[&str], &str)] = &[
    (
        &[
            "watch", "view", "show", "open", "gui", "window", "live", "edit", "serve",
        ],
        "`reflet preview scene.toml` shows a scene and every save of its files, with `--serve` in a browser",
    ),
    (
        &["convert", "import", "export", "transcode"],
        "glTF and USD are read as they are: `reflet render chair.usd -o chair.png`, or `file = \"chair.usd\"` in a scene",
    ),
    (
        &[
            "run", "build", "make", "image", "picture", "film", "video", "animate", "trace",
            "still",
        ],
        "`reflet render scene.toml -o picture.png` renders a picture, `-o film.mp4` a film",
    ),
    (
        &["validate", "verify", "test", "fmt", "format"],
        "`reflet check scene.toml` reports every mistake",
    ),
    (
        &["init", "create", "start"],
        "`reflet new NAME` writes a project that renders",
    ),
    (
        &["diff", "metric", "psnr", "ssim", "flip"],
        "`reflet compare A.png B.png` tells how two pictures differ",
    ),
    (
        &["docs", "doc", "keys", "reference"],
        "`reflet manual` prints all tables and keys of scenes",
    ),
    (&["version"], "`reflet --version` prints it"),
    (
        &["thumbnails", "contact", "grid", "montage"],
        "`reflet sheet scene.toml -o sheet.png` shows cameras and variants side by side",
    ),
    (
        &["benchmark", "time", "profile"],
        "`reflet bench` measures; `reflet render --stats text` tells what a picture took",
    ),
    (
        &["zip", "bundle", "archive", "package"],
        "`reflet pack` writes a scene with all its files into one",
    ),
];

/// Arguments of other programs, and what to write instead.
const ARGUMENTS: &[(&[&str], &str)] = &[
    (
        &[
            "--width",
            "--height",
            "--resolution",
            "--res",
            "-w",
            "-W",
            "-H",
            "--dimensions",
        ],
        "write `--size 1280x720`, width and height in pixels",
    ),
    (
        &[
            "--spp",
            "--quality",
            "-s",
            "-n",
            "--passes",
            "--rays",
            "--sample",
        ],
        "write `--samples 64`",
    ),
    (&["--noise", "--denoiser", "--clean"], "write `--denoise`"),
    (
        &["--out", "--file", "--outfile", "--out-file", "--save"],
        "write `-o picture.png`",
    ),
    (
        &["--frame", "-f", "--start", "--end", "--range"],
        "write `--frames 12`, or `--frames 0-47`",
    ),
    (
        &["--fps", "--framerate"],
        "write `fps = 24` below `[timeline]` of the scene, or `--set timeline.fps=24`",
    ),
    (&["--exposure", "--ev"], "write `--set image.exposure_ev=1`"),
    (
        &["--background", "--transparent", "--alpha"],
        "write `--set image.alpha=true` for a transparent background",
    ),
    (
        &["--gpu", "--device", "--backend"],
        "write `--adapter NAME`, as `reflet info` lists them",
    ),
    (
        &["--threads", "-j", "--jobs", "--cores"],
        "pictures are rendered by the GPU; several machines share a film by `--shard 1/4`",
    ),
    (
        &["--bounces", "--max-bounces", "--depth"],
        "write `--set reflection.bounces=2`, or `--method path` for all light",
    ),
    (
        &["--integrator", "--renderer", "--engine", "--mode", "-m"],
        "write `--method path`, or another of its words",
    ),
    (&["--cam", "--view", "-c"], "write `--camera NAME`"),
    (
        &["--define", "-D", "--param", "--var", "-p"],
        "write `--set params.NAME=VALUE`",
    ),
    (
        &["--format", "--type"],
        "the ending of the file says it: `-o picture.exr`",
    ),
    (
        &["--quiet", "-q", "--silent"],
        "write `2> /dev/null`; without a terminal there is no bar",
    ),
    (
        &["--verbose", "-v", "--log", "--debug"],
        "write `--stats text`, or `--progress lines`",
    ),
    (
        &["--force", "-y", "--overwrite", "--yes"],
        "leave it out: files are replaced without a question",
    ),
    (
        &[
            "--headless",
            "--no-window",
            "--offscreen",
            "--background-mode",
        ],
        "leave it out: `render` opens no window",
    ),
    (
        &["--browser", "--web", "--port", "--http"],
        "write `--serve`, as in `reflet preview scene.toml --serve`",
    ),
];

/// Prints the mistake in a command line with advice, and ends the process.
pub fn exit(mut error: clap::Error) -> ! {
    let Some(help) = advice(&error) else {
        error.exit();
    };
    // Suggestions by spelling alone would say something else.
    error.remove(ContextKind::SuggestedArg);
    error.remove(ContextKind::SuggestedSubcommand);
    error.remove(ContextKind::Suggested);
    reflet_base::error_line!("{error}\n{help}");
    process::exit(error.exit_code())
}

/// Advice on what to write instead.
fn advice(error: &clap::Error) -> Option<String> {
    let find = |all: &[(&[&str], &str)], typed: &str| {
        let meant = all.iter().find(|(words, _)| words.contains(&typed));
        meant.map(|(_, help)| (*help).to_owned())
    };
    if let Some(ContextValue::String(typed)) = error.get(ContextKind::InvalidSubcommand) {
        let file = Path::new(typed);
        return find(COMMANDS, typed).or_else(|| {
            (file.is_file() || file.extension().is_some_and(|e| e == "toml")).then(|| {
                format!("`{typed}` is a file: `reflet render {typed} -o picture.png` renders it, `reflet preview {typed}` shows it")
            })
        });
    }
    let Some(ContextValue::String(typed)) = error.get(ContextKind::InvalidArg) else {
        let is_output = |value: &ContextValue| value.to_string().contains("--output");
        let lacks_output = error.get(ContextKind::InvalidArg).is_some_and(is_output);
        return lacks_output.then(|| "write `-o sheet.png`, the file to make".to_owned());
    };
    let name = typed.split(['=', ' ']).next().unwrap_or(typed);
    let is_written = [
        ".png", ".exr", ".jpg", ".jpeg", ".mp4", ".webm", ".mov", ".gif",
    ];
    let is_picture = is_written.iter().any(|ending| typed.ends_with(ending));
    find(ARGUMENTS, name)
        .or_else(|| is_picture.then(|| format!("write `-o {typed}` for the file to make")))
}
