// The page: texts of a scene beside its picture. Files are kept here, and handed to the worker, which is made anew where it
// ends or loses its device.
"use strict";

import * as language from "./language.js";
import * as orbit from "./orbit.js";
import { fromFragment, toFragment } from "./share.js";

const TEXT_FILE = /\.(toml|rhai)$/i;
const MOST_BYTES = 512 * 2 ** 20;
const TYPING_MS = 300;
const EXAMPLE = "mirrors.toml";

const get = (id) => document.getElementById(id);
const [text, lines, messages, status, canvas] = ["text", "lines", "messages", "status", "picture"].map(get);
// Why the address that was opened holds no scene, until the text changes.
let refusal = "";
const tell = (words) => { status.textContent = refusal + words; };

// Content by name: texts are strings, all else is bytes.
const files = new Map();
let tab = "";
let scene = "";
let worker = null;
let isReady = false;
let lacking = null;
let restarts = 0;
let timer = 0;

const file_message = (name) => {
  const content = files.get(name);
  return { file: name, bytes: typeof content === "string" ? new TextEncoder().encode(content) : content };
};

// The camera while it is dragged, `camera` and `eye`, and whether the drag has ended; and the camera that is shown.
let dragged = null;
let isLetGo = false;
let shown_camera = null;

// Another frame of the same text has no other messages.
const run = (checks = true) => {
  if (isReady && scene) {
    if (!lacking) tell("rendering");
    const [width, frame] = ["width", "frame"].map((id) => Number(get(id).value));
    worker.postMessage({ scene, text: files.get(scene), width, frame, checks, ...dragged });
  }
};

// Messages at their lines, in the shown file or, by a click, in their own.
let listed = "";
const list = (found) => {
  const count = text.value.split("\n").length;
  const now = JSON.stringify([tab, count, found]);
  if (now === listed) return;
  listed = now;
  const worst = new Map();
  messages.replaceChildren(...found.map((message) => {
    const item = document.createElement("li");
    const button = document.createElement("button");
    item.className = message.severity;
    button.textContent = message.text.trim();
    if (message.range) button.onclick = () => go_to(message.file, message.range.start, message.range.end);
    item.append(button);
    const line = message.file === tab ? message.range?.start.line : undefined;
    if (worst.get(line) !== "error") worst.set(line, message.severity);
    return item;
  }));
  messages.found = found;
  lines.replaceChildren(...Array.from({ length: count }, (_, at) => {
    const line = document.createElement("span");
    line.className = worst.get(at) ?? "";
    line.textContent = `${at + 1}\n`;
    return line;
  }));
  lines.scrollTop = text.scrollTop;
};

// Goes to a range of lines and columns of UTF-16 units, from 0.
const go_to = (file, start, end) => {
  if (typeof files.get(file) !== "string") tell(`${file} is no text`);
  if (file !== tab && typeof files.get(file) === "string") open(file);
  if (file !== tab) return;
  text.focus();
  text.setSelectionRange(language.offset_of(text.value, start), language.offset_of(text.value, end));
  text.scrollTop = (start.line - 3) * 18;
};

const show_tabs = () => {
  get("tabs").replaceChildren(...[...files.keys()].map((name) => {
    const button = document.createElement("button");
    button.textContent = name;
    button.setAttribute("aria-pressed", String(name === tab));
    button.disabled = typeof files.get(name) !== "string";
    button.onclick = () => open(name);
    return button;
  }));
};

// A scene begins at its first frame, and does not play.
const choose_scene = (name) => {
  if (name === scene) return;
  scene = name;
  [dragged, isLetGo, shown_camera] = [null, false, null];
  stop();
  Object.assign(get("frame"), { min: 0, max: 0 });
};

const open = (name) => {
  tab = name;
  if (/\.toml$/i.test(name)) choose_scene(name);
  text.value = files.get(name);
  show_tabs();
  list(messages.found ?? []);
  run();
};

const put = (name, content) => {
  files.set(name, content);
  if (isReady) worker.postMessage(file_message(name));
  language.hand(file_message(name));
};

// Other texts take the place of all files.
const replace = (all) => {
  files.clear();
  language.restart();
  scene = "";
  for (const [name, content] of Object.entries(all)) put(name, content);
  open(Object.keys(all)[0]);
};

const draw = ({ width, height }, pixels) => {
  [canvas.width, canvas.height] = [width, height];
  canvas.getContext("2d").putImageData(new ImageData(new Uint8ClampedArray(pixels.buffer), width, height), 0, 0);
  canvas.dataset.shown = scene;
  get("save").disabled = false;
};

// The timeline of the shown scene. While it plays, each picture asks for the next.
let plays = false;
const stop = () => {
  plays = false;
  get("play").textContent = "play";
};
const show_time = ({ timeline, frame }) => {
  get("time").hidden = !timeline;
  const [start, end, fps] = timeline ?? [0, 0, 1];
  if (start === end) stop();
  if (!timeline) return;
  Object.assign(get("frame"), { min: start, max: end });
  get("told").textContent = `${frame} of ${end}, ${(frame / fps).toFixed(2)} s`;
  if (!plays) return;
  get("frame").value = frame < end ? frame + 1 : start;
  run(false);
};

const answers = {
  state: (data) => {
    isReady = true;
    lacking = data.lacks;
    for (const name of files.keys()) worker.postMessage(file_message(name));
    tell(lacking ? `messages only: this browser lacks ${lacking}` : "ready");
    run();
  },
  check: ({ check }) => list(check),
  part: ({ part, pixels }) => {
    draw(part, pixels);
    tell(`sample ${part.done} of ${part.samples}`);
  },
  shown: ({ shown, pixels }) => {
    const prints = (shown.log ?? []).map((line) => ({ severity: "print", text: line }));
    if (shown.messages) list([...shown.messages, ...prints]);
    if (pixels) {
      draw(shown, pixels);
      restarts = 0;
      tell(`${shown.width} × ${shown.height} in ${shown.seconds.toFixed(1)} s on ${shown.adapter || "the browser's adapter"}`);
      show_time(shown);
      shown_camera = shown.camera;
      if (isLetGo) worker.postMessage({ put: [dragged.camera, dragged.eye] });
      isLetGo = false;
    } else {
      stop();
    }
    if (shown.lost) {
      restart(`the device was lost (${shown.error})`);
    } else if (!pixels) {
      tell(shown.error ?? "the scene has mistakes");
    }
  },
  put: ({ put: { file, before, after, error } }) => {
    dragged = null;
    // What was typed meanwhile stays.
    if (error || files.get(file) !== before) refusal = `the camera is not written (${error ?? "the text has changed meanwhile"}): `;
    else if (file === tab) language.replace_all(after);
    else put(file, after);
    run();
  },
  png: ({ png }) => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([png], { type: "image/png" }));
    link.download = canvas.dataset.shown.replace(/\.toml$/i, ".png");
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
  },
  ended: ({ ended }) => restart(`the renderer ended (${ended})`),
};

// One program, compiled once for all workers.
const load = () => fetch("reflet_web_bg.wasm");
const program = WebAssembly.compileStreaming(load()).catch(async () => WebAssembly.compile(await (await load()).arrayBuffer()));
const work = (hear) => {
  const made = new Worker("worker.js", { type: "module" });
  const fail = (error) => tell(`the renderer cannot be loaded: ${error.message ?? "a file is missing"}`);
  made.onmessage = ({ data }) => hear(data);
  made.onerror = fail;
  program.then((module) => made.postMessage({ module }), fail);
  return made;
};
const start = () => {
  isReady = false;
  worker = work((data) => answers[Object.keys(answers).find((key) => key in data)](data));
};
orbit.follow(canvas, {
  camera: () => {
    if (!shown_camera) return tell("motion, a script or a parent places this camera: change it in the text");
    const [name, eye, target, up] = shown_camera;
    return { name, eye, target, up };
  },
  show: (camera, eye) => {
    [dragged, isLetGo] = [{ camera, eye }, false];
    run(false);
  },
  write: () => {
    isLetGo = Boolean(dragged);
    if (isLetGo) run(false);
  },
});
language.begin({ files, tab: () => tab, work, file_message, put, go_to, tell });

// A renderer that ends again before it has made a picture waits for a change of the text.
const restart = (why) => {
  worker.terminate();
  restarts += 1;
  if (restarts < 3) {
    start();
    tell(`${why}; it is made anew`);
  } else {
    isReady = false;
    tell(`${why}, again and again; a change of the text starts it anew`);
  }
};

const add = async (dropped) => {
  for (const file of dropped) {
    const held = [...files.values()].reduce((sum, content) => sum + (content.byteLength ?? content.length), 0);
    if (held + file.size > MOST_BYTES) {
      tell(`${file.name} does not fit: all files together may have ${MOST_BYTES / 2 ** 20} MiB`);
      return;
    }
    const bytes = new Uint8Array(await file.arrayBuffer());
    put(file.name, TEXT_FILE.test(file.name) ? new TextDecoder().decode(bytes) : bytes);
    if (/\.toml$/i.test(file.name)) choose_scene(tab = file.name);
  }
  open(tab);
};

// A scene of this folder with the files that it names, and those that these name.
const fetch_example = async (name, known) => {
  const all = {};
  const wanted = [name];
  for (const file of wanted) {
    const found = await fetch(`scenes/${file}`);
    if (!found.ok) throw new Error(`scenes/${file}: ${found.statusText}`);
    const bytes = new Uint8Array(await found.arrayBuffer());
    all[file] = TEXT_FILE.test(file) ? new TextDecoder().decode(bytes) : bytes;
    if (typeof all[file] === "string") {
      wanted.push(...known.filter((other) => !wanted.includes(other) && all[file].includes(`"${other}"`)));
    }
  }
  return all;
};

const begin = async () => {
  start();
  const known = await (await fetch("scenes/names.json")).json();
  const names = known.filter((name) => name.endsWith(".toml"));
  get("examples").append(...names.map((name) => new Option(name, name)));
  const choose = async (name) => replace(await fetch_example(name, known));
  get("examples").onchange = ({ target }) => target.value && choose(target.value);
  const arrive = async () => {
    refusal = "";
    if (location.hash.length < 2) return choose(EXAMPLE);
    try {
      replace(await fromFragment(location.hash.slice(1)));
    } catch (error) {
      refusal = `the address holds no scene: ${error.message}; this is ${EXAMPLE}: `;
      await choose(EXAMPLE);
    }
  };
  addEventListener("hashchange", arrive);
  await arrive();
};

text.oninput = () => {
  refusal = "";
  put(tab, text.value);
  list([]);
  clearTimeout(timer);
  timer = setTimeout(() => {
    if (isReady) run();
    else if (restarts >= 3) { restarts = 0; start(); }
  }, TYPING_MS);
};
text.onscroll = () => { lines.scrollTop = text.scrollTop; };
get("width").onchange = () => run();
get("frame").oninput = () => run(false);
get("play").onclick = () => {
  plays = !plays;
  get("play").textContent = plays ? "pause" : "play";
  run(false);
};
get("save").onclick = () => worker.postMessage({ png: true });
get("files").onchange = ({ target }) => add(target.files);
get("share").onclick = async () => {
  const texts = [...files].filter(([, content]) => typeof content === "string");
  // The shown scene comes first.
  texts.sort(([a], [b]) => (b === scene) - (a === scene));
  history.replaceState(null, "", `#${await toFragment(Object.fromEntries(texts))}`);
  await navigator.clipboard?.writeText(location.href).catch(() => {});
  const left = files.size - texts.length;
  tell(`the address holds ${texts.length} text${texts.length === 1 ? "" : "s"}${left ? `, and not the ${left} other files` : ""}: copy it`);
};
addEventListener("dragover", (event) => { event.preventDefault(); document.body.classList.add("dropping"); });
addEventListener("dragleave", () => document.body.classList.remove("dropping"));
addEventListener("drop", (event) => {
  event.preventDefault();
  document.body.classList.remove("dropping");
  add(event.dataTransfer.files);
});

begin().catch((error) => tell(`the page cannot be loaded: ${error.message}`));
