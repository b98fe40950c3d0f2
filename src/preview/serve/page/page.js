// The page shows what the server sends, and sends what the viewer does; it keeps no state of the scene.
import { begin_handles, is_inside, place_in } from "./handles.js";
import { begin_keys, is_field } from "./keys.js";
import { element, get as $, options, SAMPLES } from "./numbers.js";
import { begin_panels } from "./panels.js";

const canvas = $("picture");
const sides = [null, null];
let wipes = false;
let scene = null;
let view = null;
let socket = null;

// Messages of a viewer who is faster than the connection.
let unsent = [];

const send = (message) => {
  const text = JSON.stringify(message);
  if (!socket || socket.readyState === WebSocket.CONNECTING) unsent.push(text);
  else if (socket.readyState === WebSocket.OPEN) socket.send(text);
};

function paint() {
  const [left, right] = sides;
  if (!left) return;
  if (canvas.width !== left.width || canvas.height !== left.height) {
    [canvas.width, canvas.height] = [left.width, left.height];
    handles.paint();
  }
  const { width, height } = canvas;
  const context = canvas.getContext("2d");
  context.drawImage(left, 0, 0);
  if (!wipes || !right) return;
  const x = Math.round($("line").value * width);
  context.save();
  context.beginPath();
  context.rect(x, 0, width - x, height);
  context.clip();
  context.drawImage(right, 0, 0, width, height);
  context.restore();
  context.fillStyle = "#fff";
  context.fillRect(x - 1, 0, 2, height);
}

// A picture: side, number (8 bytes), JPEG or PNG.
async function show(bytes) {
  const side = new Uint8Array(bytes, 0, 1)[0];
  const number = new DataView(bytes).getBigUint64(1, true);
  const is_png = new Uint8Array(bytes, 9, 1)[0] === 0x89;
  try {
    const blob = new Blob([bytes.slice(9)], { type: is_png ? "image/png" : "image/jpeg" });
    sides[side] = await createImageBitmap(blob);
    paint();
    canvas.dataset.number = String(number);
    canvas.dataset.kind = is_png ? "png" : "jpeg";
  } finally {
    if (side === 0) send({ do: "shown" });
  }
}

// Link to a place of a file, which an editor opens; a place without a file is copied by a click.
function link([place, file, line, column]) {
  if (file) {
    const path = file.split(/[\\/]/).map(encodeURIComponent).join("/").replace(/^\//, "");
    return element("a", { href: `vscode://file/${path}:${line}:${column}`, textContent: place, title: "open in VS Code" });
  }
  const button = element("button", { className: "place", textContent: place, title: "copy" });
  button.addEventListener("click", () => {
    getSelection().selectAllChildren(button);
    void navigator.clipboard?.writeText(place);
  });
  return button;
}

// Parts of a text of messages, in which the places that it names are links. A place may begin like a longer one.
const linked = (text) => scene.places.toSorted(([a], [b]) => b.length - a.length).reduce(
  (parts, place) => parts.flatMap((part) => typeof part !== "string" ? [part]
    : part.split(place[0]).flatMap((own, at) => at ? [link(place), own] : [own])),
  [text]);

function show_scene(next) {
  scene = next;
  document.title = `${scene.name} \u2013 Reflet`;
  $("help").firstElementChild.replaceChildren(...scene.help.map((row) =>
    element("tr", {}, ...row.map((textContent) => element("td", { textContent })))));
  const problems = $("problems");
  problems.replaceChildren(...scene.problems.map((text) => element("li", {}, ...linked(text))));
  problems.hidden = scene.problems.length === 0;
  panels.scene(scene);
  $("screenshot").download = `${scene.name}.png`;
  $("time").hidden = !scene.timeline;
  keys_of_tracks.paint();
  if (scene.timeline) [$("frame").min, $("frame").max] = scene.timeline;
  $("log").replaceChildren(...linked(scene.log.concat(scene.warnings).join("\n")));
  $("log-panel").hidden = scene.log.length + scene.warnings.length === 0;
  if (view) show_view(view);
}

function show_view(next) {
  view = next;
  if (!scene) return;
  const follows = scene.cuts ? ["(cuts)"] : [];
  const free = view.camera === null ? ["(free)"] : [];
  const camera = view.camera === null ? "(free)" : view.cuts && scene.cuts ? "(cuts)" : view.camera;
  options($("camera"), [...free, ...follows, ...scene.cameras], camera);
  view.sides.forEach(([method, channel], side) => {
    options($(`method${side}`), scene.methods, method);
    options($(`channel${side}`), scene.channels, channel);
  });
  wipes = view.wipe;
  $("wipe").setAttribute("aria-pressed", String(wipes));
  $("right").hidden = $("line").hidden = !wipes;
  if (view.frame !== null && scene.timeline) {
    if ($("frame") !== document.activeElement || view.plays) $("frame").value = view.frame;
    const seconds = (view.frame / scene.timeline[2]).toFixed(3);
    $("told").textContent = `${view.frame} of ${scene.timeline[1]}, ${seconds} s`;
  }
  $("samples").value = view.samples ?? "";
  $("denoising").hidden = view.denoises === null;
  $("denoise").checked = view.denoises;
  $("play").textContent = view.plays ? "pause" : "play";
  $("loop").checked = view.loops;
  show_stale();
  paint();
}

function show_statistics({ picture, frame, encode_ms, sides }) {
  const legends = sides.filter((side) => side.legend).map(({ method, legend }) => (sides[1] ? `${method}: ${legend}` : legend));
  $("legend").textContent = legends.join("\n");
  const lines = [`picture ${picture}, frame ${frame}, read and encoded in ${encode_ms.toFixed(1)} ms`];
  for (const { method, size, samples, ms, rays, passes } of sides) {
    lines.push(`${method} ${size[0]}\u00d7${size[1]}, samples ${samples}, ${ms.toFixed(1)} ms, rays ${rays}`);
    for (const [name, of] of passes) lines.push(`  ${name} ${of.toFixed(2)} ms`);
  }
  $("count").textContent = `${sides[0].samples} shown`;
  $("statistics").textContent = lines.join("\n");
  shown_frame = frame;
  show_stale();
}

// Says that the picture is of another frame than the timeline tells, until the picture of that frame is there.
let shown_frame = null;
function show_stale() {
  if (!view) return;
  $("stale").hidden = !scene || !scene.timeline || shown_frame === null || view.frame === shown_frame;
  $("stale").textContent = `shows frame ${shown_frame}, rendering ${view.frame}`;
}

function connect() {
  const address = new URL("socket", location.href);
  address.protocol = "ws:";
  socket = new WebSocket(address);
  socket.binaryType = "arraybuffer";
  socket.onopen = () => {
    $("status").textContent = "connected";
    unsent.forEach((text) => socket.send(text));
    unsent = [];
  };
  socket.onclose = () => {
    unsent = [];
    $("status").textContent = "the preview has ended, or has too many viewers; trying again";
    setTimeout(connect, 1000);
  };
  socket.onmessage = ({ data }) => {
    if (typeof data !== "string") return void show(data);
    const message = JSON.parse(data);
    if (message.scene) show_scene(message.scene);
    if (message.view) show_view(message.view);
    for (const kind of ["item", "parameters", "material"]) {
      if (kind in message) panels[kind](message[kind]);
    }
    if (message.handles) handles.show(message.handles);
    if (message.keys) keys_of_tracks.show(message.keys, message.records);
    if (message.statistics) show_statistics(message.statistics);
    if (message.message) $("status").textContent = message.message;
  };
}

// Moves are gathered and sent once for each picture of the screen.
let drag = null;
let gathered = [0, 0];
let waits = false;
// Drags with the main button tell where they began and where they are: they may have taken hold of a handle.
function move(held, by) {
  gathered = [gathered[0] + by[0], gathered[1] + by[1]];
  if (waits) return;
  waits = true;
  requestAnimationFrame(() => {
    waits = false;
    const { kind, from, to } = held;
    if (kind === "drag") send({ do: kind, from, to, by: gathered, start: !held.is_sent });
    else send({ do: kind, by: gathered });
    held.is_sent = true;
    gathered = [0, 0];
    if (held.is_over) send({ do: "drop", from });
  });
}

canvas.addEventListener("pointerdown", (event) => {
  canvas.setPointerCapture(event.pointerId);
  canvas.style.cursor = "grabbing";
  const kind = { 0: "drag", 1: "pan", 2: "look" }[event.button];
  const from = place_in(canvas, event);
  drag = { kind, from, to: from, at: [event.clientX, event.clientY], length: 0 };
});
canvas.addEventListener("pointermove", (event) => {
  if (!drag || !drag.kind) return;
  const by = [event.clientX - drag.at[0], event.clientY - drag.at[1]];
  drag.at = [event.clientX, event.clientY];
  drag.to = place_in(canvas, event);
  drag.length += Math.hypot(...by);
  if (drag.length > 3) move(drag, by.map((pixels) => pixels / canvas.clientHeight));
});
function end_drag() {
  if (drag && drag.kind === "drag" && drag.length > 3) {
    drag.is_over = true;
    if (!waits) send({ do: "drop", from: drag.from });
  }
  drag = null;
  canvas.style.cursor = "";
}
canvas.addEventListener("pointerup", (event) => {
  const at = place_in(canvas, event);
  if (drag && drag.kind === "drag" && drag.length <= 3) {
    send(is_inside(at) ? { do: "pick", at } : { do: "press", action: "unpick" });
  }
  end_drag();
});
// The system may cut a drag off, as by a gesture of its own.
canvas.addEventListener("pointercancel", end_drag);
canvas.addEventListener("contextmenu", (event) => event.preventDefault());
canvas.addEventListener("wheel", (event) => {
  event.preventDefault();
  send({ do: "dolly", notches: -Math.sign(event.deltaY) });
}, { passive: false });

for (const side of [0, 1]) {
  for (const kind of ["method", "channel"]) {
    $(`${kind}${side}`).addEventListener("change", (event) => send({ do: kind, side, name: event.target.value }));
  }
}
$("camera").addEventListener("change", ({ target }) =>
  send({ do: "camera", name: target.value.startsWith("(") ? null : target.value }));
const press = (action) => send({ do: "press", action });
const actions = {
  wipe: "wipe", undo: { undo: false }, redo: { undo: true }, play: "play", back: { step: -1 }, on: { step: 1 },
};
for (const [id, action] of Object.entries(actions)) $(id).addEventListener("click", () => press(action));
// The line of a wipe is each viewer's own.
$("screenshot").addEventListener("click", ({ target }) => { target.href = `picture.png?wipe=${$("line").value}`; });
$("keys-of-page").addEventListener("click", show_help);
$("samples").append(...SAMPLES.map((count) => new Option(count)));
$("samples").addEventListener("change", ({ target }) => send({ do: "samples", count: Number(target.value) || null }));
$("denoise").addEventListener("change", ({ target }) => send({ do: "denoise", on: target.checked }));
$("loop").addEventListener("change", () => press("loop"));
$("frame").addEventListener("input", ({ target }) => send({ do: "seek", frame: Number(target.value) }));
$("line").addEventListener("input", paint);

// Keys of the picture, where it has the focus; all others come from the server.
const STEP = 0.03;
const keys = {
  ArrowLeft: { do: "orbit", by: [-STEP, 0] }, ArrowRight: { do: "orbit", by: [STEP, 0] },
  ArrowUp: { do: "orbit", by: [0, -STEP] }, ArrowDown: { do: "orbit", by: [0, STEP] },
  "+": { do: "dolly", notches: 1 }, "-": { do: "dolly", notches: -1 },
};
function show_help() {
  if ($("help").open) $("help").close();
  else $("help").showModal();
}
// What a press does; null if it does nothing.
function pressed({ key, ctrlKey, metaKey, shiftKey, altKey }) {
  const name = key.length === 1 ? key.toUpperCase() : key;
  const held = [[ctrlKey || metaKey, "Ctrl"], [altKey, "Alt"], [shiftKey, "Shift"]].filter(([is_down]) => is_down);
  const keys = [...held.map(([, key]) => key), name].join("+");
  const found = scene && scene.presses.find(([known]) => known === keys);
  return found ? { do: "press", action: found[1] } : null;
}
// Keys that fly as long as they are down: right, up, forward.
const flights = { a: [-1, 0, 0], d: [1, 0, 0], e: [0, 1, 0], q: [0, -1, 0], s: [0, 0, -1], w: [0, 0, 1] };
const flying = new Set();
let flown = null;
function fly(now) {
  if (flying.size === 0) { flown = null; return; }
  const seconds = flown === null ? 1 / 60 : (now - flown) / 1000;
  const by = [0, 1, 2].map((axis) => [...flying].reduce((sum, key) => sum + flights[key][axis], 0));
  flown = now;
  send({ do: "fly", by, seconds });
  requestAnimationFrame(fly);
}
addEventListener("keyup", ({ key }) => flying.delete(key.toLowerCase()));
addEventListener("blur", () => flying.clear());

addEventListener("keydown", (event) => {
  const { key, target } = event;
  if (key === "F12") {
    event.preventDefault();
    $("screenshot").click();
    return;
  }
  if (key.toLowerCase() === "h" && !is_field(target)) {
    show_help();
    return;
  }
  const message = pressed(event);
  const has_command = event.ctrlKey || event.metaKey;
  if (has_command || event.altKey) {
    if (!message || (has_command && is_field(target))) return;
    event.preventDefault();
    send(message);
    return;
  }
  if (!is_field(target) && flights[key]) {
    const starts = flying.size === 0;
    flying.add(key);
    if (starts) requestAnimationFrame(fly);
    return;
  }
  const is_control = ["INPUT", "SELECT", "BUTTON"].includes(target.tagName);
  const done = is_control ? null : (target === $("stage") && keys[key]) || message;
  if (!done) return;
  event.preventDefault();
  send(done);
});

const panels = begin_panels($("panels"), send);
const handles = begin_handles(canvas, $("handles"), send);
const keys_of_tracks = begin_keys($("keys"), { send, press, scene: () => scene, frame: () => view.frame });
connect();
