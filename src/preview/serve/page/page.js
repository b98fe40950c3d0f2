// The page shows what the server sends, and sends what the viewer does; it keeps no state of the scene.
import { begin_choices } from "./choices.js";
import { begin_handles } from "./handles.js";
import { begin_keyboard } from "./keyboard.js";
import { begin_keys, is_field } from "./keys.js";
import { element, get as $ } from "./numbers.js";
import { begin_panels } from "./panels.js";
import { begin_picture } from "./picture.js";
import { begin_pointer } from "./pointer.js";
import { begin_timeline } from "./timeline.js";

const canvas = $("picture");
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

// A picture: side, number (8 bytes), JPEG or PNG.
async function show(bytes) {
  const side = new Uint8Array(bytes, 0, 1)[0];
  const number = new DataView(bytes).getBigUint64(1, true);
  const is_png = new Uint8Array(bytes, 9, 1)[0] === 0x89;
  try {
    const blob = new Blob([bytes.slice(9)], { type: is_png ? "image/png" : "image/jpeg" });
    picture.show(side, await createImageBitmap(blob));
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
  keyboard.show(scene.keys);
  const problems = $("problems");
  problems.replaceChildren(...scene.problems.map((text) => element("li", {}, ...linked(text))));
  problems.hidden = scene.problems.length === 0;
  panels.scene(scene);
  $("screenshot").download = `${scene.name}.png`;
  keys_of_tracks.paint();
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
  choices.show({ ...scene, ...view, cameras: [...free, ...follows, ...scene.cameras], camera });
  picture.wipe(view.wipe);
  timeline.show({ timeline: scene.timeline, ...view });
  $("denoising").hidden = view.denoises === null;
  $("denoise").checked = view.denoises;
  show_stale();
}

function show_statistics({ picture: number, frame, encode_ms, sides }) {
  picture.explain(sides);
  const lines = [`picture ${number}, frame ${frame}, read and encoded in ${encode_ms.toFixed(1)} ms`];
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

const press = (action) => send({ do: "press", action });
$("undo").addEventListener("click", () => press({ undo: false }));
$("redo").addEventListener("click", () => press({ undo: true }));
// The line of a wipe is each viewer's own.
$("screenshot").addEventListener("click", ({ target }) => { target.href = `picture.png?wipe=${picture.line_at()}`; });
$("denoise").addEventListener("change", ({ target }) => send({ do: "denoise", on: target.checked }));

const choices = begin_choices($("view-choices"), send);
const picture = begin_picture(canvas);
const timeline = begin_timeline($("time"), send);
const keyboard = begin_keyboard({
  stage: $("stage"), send, counts: (target) => !is_field(target), save: () => $("screenshot").click(),
});
begin_pointer(canvas, send);
const panels = begin_panels($("panels"), send);
const handles = begin_handles(canvas, $("handles"), send);
const keys_of_tracks = begin_keys($("keys"), { send, press, scene: () => scene, frame: () => view.frame });
connect();
