// `<reflet-view src="scene.toml">` shows a scene on any page that loads this module. Files are kept here, and handed to the
// worker, which is made anew where it ends or loses its device. docs/web.md lists the attributes. The editor draws panels, handles
// and choices, and hears what they show.
import { AS_WRITTEN } from "./choices.js";
import { begin_picture } from "./picture.js";
import { begin_pointer } from "./pointer.js";
import { lacks } from "./suspend.js";
import { begin_timeline } from "./timeline.js";

const TEXT_FILE = /\.(toml|rhai)$/i;
const [MOST_BYTES, MOST_TEXT_BYTES] = [512 * 2 ** 20, 4 * 2 ** 20];
const [TURN_DEG_PER_S, MOST_STEP_S] = [20, 0.25];
// Inputs by a held button and all that move the camera, the time after which it rests, and why a camera stays.
const DRAGS = ["drag", "pan", "look"];
const MOVES = [...DRAGS, "orbit", "dolly", "fly"];
const REST_MS = 400;
const STAYS = "motion, a script or a parent places this camera: change it in the text";
const LOADING = "loading the renderer";
// Project of the scenes beside it.
const PROJECT = "reflet.toml";

const STYLE = new CSSStyleSheet();
STYLE.replaceSync(`
  :host { display: flex; flex-direction: column; position: relative; background: #101010; color: #ddd; font: 14px/1.4 system-ui, sans-serif; }
  [hidden] { display: none !important; }
  canvas { flex: 1 1 auto; width: 100%; min-height: 0; object-fit: contain; cursor: grab; touch-action: pan-y; background: center / contain no-repeat; }
  canvas:active { cursor: grabbing; }
  p { position: absolute; left: 8px; top: 8px; margin: 0; padding: 2px 6px; max-width: calc(100% - 16px); max-height: calc(100% - 16px); overflow: auto; white-space: pre-wrap; background: #000b; font: 12px/1.4 ui-monospace, monospace; pointer-events: none; }
  p:empty { display: none; }
  div { display: flex; gap: 6px; align-items: center; padding: 4px 8px; color-scheme: dark; }
  input[type="range"] { flex: 1; min-width: 0; }
  #line { position: absolute; left: 0; top: 4px; width: 100%; margin: 0; color-scheme: dark; }
  #legend { top: 28px; }
`);
const INSIDE = `<canvas id="picture" part="picture" width="16" height="9" role="img" aria-label="picture of the scene"></canvas>
<p part="status" role="status"></p>
<div part="time" hidden></div>`;

// One program, compiled once for all workers of a page.
const beside = (name) => new URL(name, import.meta.url);
let compiled = null;
const load = () => fetch(beside("reflet_web_bg.wasm"));
const compile = () => WebAssembly.compileStreaming(load()).catch(async () => WebAssembly.compile(await (await load()).arrayBuffer()));
// Workers are of the origin of the page alone: elsewhere, one that imports the other origin's script.
const script = () => {
  const { href, origin } = beside("worker.js");
  return origin === location.origin ? href : URL.createObjectURL(new Blob([`import ${JSON.stringify(href)};`], { type: "text/javascript" }));
};
export const work = (hear, tell) => {
  const made = new Worker(script(), { type: "module" });
  const fail = (error) => tell(`the renderer cannot be loaded: ${error.message ?? "a file is missing"}`);
  made.onmessage = ({ data }) => hear(data);
  made.onerror = fail;
  compiled ??= compile();
  compiled.then((module) => made.postMessage({ module }), fail);
  return made;
};

// Gives the user a file.
export const offer = (content, name) => {
  const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(new Blob([content])), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
};

const whole = (text, most) => Math.min(most, Math.max(0, Math.trunc(Number(text)) || 0));
const in_words = ({ width, height, seconds, samples, method, adapter }) => {
  const count = `${samples} sample${samples === 1 ? "" : "s"}`;
  return `${width} × ${height} in ${seconds.toFixed(1)} s, ${count} by ${method}, on ${adapter || "the browser's adapter"}`;
};
const mebibytes = (bytes) => `${Math.ceil(bytes / 2 ** 20)} MiB`;
// Content of an address, or why there is none.
// Bytes of a file. Some servers answer with their first page, of a refused type, where there is no such file.
const download = async (url, refused) => {
  const found = await fetch(url);
  if (!found.ok) throw new Error(found.statusText || `status ${found.status}`);
  if (refused && found.headers.get("content-type")?.startsWith(refused)) throw new Error("no such file");
  return new Uint8Array(await found.arrayBuffer());
};

export class RefletView extends HTMLElement {
  static observedAttributes = ["src", "width", "samples", "camera", "method", "channel", "variant", "frame", "auto-rotate", "poster"];

  // Content by name: texts are strings, all else is bytes.
  files = new Map();
  scene = "";
  // Whether what is dragged is written into the text.
  edits = false;

  #worker = null;
  #isReady = false;
  #lacking = null;
  #restarts = 0;
  // Folder of `src`, whose files a scene may name, those of its files that were asked for, and the requests that are open.
  #folder = null;
  #asked = new Set();
  #pending = 0;
  // How a pack is rendered, by its manifest.
  #options = {};
  // Whether the shown camera moves and is held, by a button or not, whether a move without a button is to be written, and when.
  #moves = false;
  #isHeld = false;
  #isDragged = false;
  #isOwed = false;
  #rest = 0;
  // Method and channel of the right side, and whether it is shown; the last picture.
  #right = { method: null, channel: "picture" };
  #wipes = false;
  #shown = {};
  // Texts as an input that is not over has them, each with the text that the editor has.
  #drafts = new Map();
  // Number of the last input that has changed texts.
  #heard = 0;
  // The wanted frame and the timeline, whether it plays and begins again at its end, and the time of the last turn.
  frame = 0;
  timeline = null;
  #plays = false;
  #loops = true;
  #turned = 0;
  #isSeen = false;
  #seer = new IntersectionObserver((seen) => this.#see(seen.at(-1).isIntersecting));

  constructor() {
    super();
    const root = this.attachShadow({ mode: "open" });
    root.adoptedStyleSheets = [STYLE];
    root.innerHTML = INSIDE;
    [this.canvas, this.status] = root.children;
    this.picture = begin_picture(this.canvas);
    this.time = begin_timeline(root.lastElementChild, (message) => this.send(message));
    begin_pointer(this.canvas, (message) => this.send(message));
  }
  connectedCallback() { this.#seer.observe(this); }
  disconnectedCallback() {
    this.#seer.unobserve(this);
    this.#worker?.terminate();
    [this.#worker, this.#isReady, this.#isSeen] = [null, false, false];
  }
  attributeChangedCallback(name, old, value) {
    if (name === "poster") this.canvas.style.backgroundImage = value ? `url(${JSON.stringify(new URL(value, document.baseURI).href)})` : "";
    else if (name === "frame") this.frame = whole(value, 2 ** 31);
    if (name === "src" && value !== null && this.#worker) this.#load();
    else this.run();
  }
  tell(words) {
    this.status.textContent = words;
    this.#emit("status", words);
  }
  // Another scene of the files does not play.
  choose(name) {
    if (name === this.scene) return;
    this.scene = name;
    [this.#moves, this.#options] = [false, {}];
    this.#drafts.clear();
    this.#plays = false;
    this.frame = whole(this.getAttribute("frame"), 2 ** 31);
  }
  clear() {
    this.files.clear();
    this.#drafts.clear();
    this.#asked.clear();
    [this.scene, this.#folder, this.#options] = ["", null, {}];
    if (this.#isReady) this.#worker.postMessage({ clear: true });
  }
  put(name, content) {
    this.files.set(name, content);
    this.#drafts.delete(name);
    if (this.#isReady) this.#worker.postMessage(this.message_of(name));
    this.#emit("file", name);
  }
  // Throws in words where a file of so many bytes does not fit.
  check(name, bytes) {
    const held = [...this.files].reduce((sum, [other, { byteLength, length }]) => sum + (other === name ? 0 : byteLength ?? length), 0);
    if (held + bytes > MOST_BYTES) throw new Error(`${name} does not fit: all files together may have ${mebibytes(MOST_BYTES)}`);
    if (TEXT_FILE.test(name) && bytes > MOST_TEXT_BYTES) throw new Error(`${name} has ${mebibytes(bytes)}, and a text at most ${mebibytes(MOST_TEXT_BYTES)}`);
  }
  // Puts bytes, as text where the name says so.
  add(name, bytes) {
    this.check(name, bytes.length);
    this.put(name, TEXT_FILE.test(name) ? new TextDecoder().decode(bytes) : bytes);
  }
  message_of(name) {
    const content = this.files.get(name);
    return { file: name, bytes: typeof content === "string" ? new TextEncoder().encode(content) : content };
  }
  // Another frame of the same text has no other messages. A renderer that was given up is started anew.
  run(checks = true) {
    if (this.#worker && !this.#isReady && this.#restarts >= 3) this.#start();
    if (!this.#isReady || !this.scene) return;
    if (!this.#lacking && (checks || this.edits)) this.tell("rendering");
    const isDraft = this.#isHeld || this.#drafts.size > 0;
    this.#worker.postMessage({ ask: this.#ask(isDraft), sides: this.#sides(), checks: checks && !isDraft, isDraft, heard: this.#heard });
  }
  // Hands an input to the worker; `write` tells the changes of texts that follow.
  act(message) {
    if (this.#isReady) this.#worker.postMessage({ act: message });
  }
  // Follows an input of a viewer: choices and time here, all else in the worker. Only an editor selects and writes.
  send(message) {
    const { do: what, action } = message;
    const [press, value] = Object.entries(typeof action === "string" ? { [action]: null } : action ?? {}).flat();
    const isMove = MOVES.includes(what) || press === "frame";
    if (this.#does[what]) this.#does[what](message);
    else if (this.#presses[press]) this.#presses[press](value);
    else if (isMove && !this.#moves && !(this.edits && what === "drag")) this.tell(STAYS);
    else if (what === "drop" && !this.edits) this.#drop();
    else if (isMove || press === "scene_camera" || this.edits) this.#hand(message, isMove);
    this.#show_time();
    this.#emit("choice");
  }
  #hand(message, isMove) {
    if (isMove || message.do === "drop") {
      clearTimeout(this.#rest);
      const isDrag = DRAGS.includes(message.do);
      this.#isHeld = isMove;
      this.#isDragged = isDrag || (this.#isDragged && isMove);
      this.#isOwed ||= isMove && !isDrag;
      // Other moves are written when they rest and no button is down.
      if (this.#isOwed && !this.#isDragged) this.#rest = setTimeout(() => this.#drop(), REST_MS);
    }
    this.act(message);
    if (message.do === "hide" || message.action === "scene_camera") this.run(false);
  }
  // The place where a camera rests is written.
  #drop() {
    [this.#isHeld, this.#isOwed] = [false, false];
    if (this.edits) this.act({ do: "drop", from: [0, 0] });
    else this.run(false);
  }
  // Attributes, and the right side of the wipe, which has none.
  #choose(name, value) {
    if (value === null) this.removeAttribute(name);
    else this.setAttribute(name, value);
  }
  #choose_side(side, name, value) {
    if (!side) return this.#choose(name, value);
    this.#right[name] = value;
    this.run(false);
  }
  #does = {
    camera: ({ name }) => this.#choose("camera", name),
    samples: ({ count }) => this.#choose("samples", count),
    method: ({ side, name }) => this.#choose_side(side, "method", name),
    channel: ({ side, name }) => this.#choose_side(side, "channel", name),
    seek: ({ frame }) => this.seek(frame),
  };
  #presses = {
    play: () => {
      this.#plays = !this.#plays;
      this.run(false);
    },
    step: (by) => {
      const [start, end] = this.timeline ?? [0, 0];
      const count = end - start + 1;
      const frame = this.frame + by - start;
      this.#plays = false;
      this.seek(start + (this.#loops ? (frame + count) % count : Math.min(end - start, Math.max(0, frame))));
    },
    start: () => this.seek(this.timeline?.[0]),
    end: () => this.seek(this.timeline?.[1]),
    loop: () => { this.#loops = !this.#loops; },
    method: (index) => this.#choose("method", this.#shown.methods?.[index + 1] ?? null),
    wipe: () => {
      this.#wipes = !this.#wipes;
      const [{ method, channel }] = this.#sides();
      const left = method ?? this.#shown.method;
      const isSame = [null, left].includes(this.#right.method) && this.#right.channel === (channel ?? "picture");
      if (this.#wipes && isSame) this.#right.method = left === "rt" ? "hybrid" : "rt";
      this.picture.wipe(this.#wipes);
      this.run(false);
    },
  };
  // Methods and channels to render: of the picture, or of both sides of the wipe.
  #sides() {
    const [method, channel] = ["method", "channel"].map((name) => this.getAttribute(name));
    return [{ method, channel }, this.#right].slice(0, this.#wipes ? 2 : 1);
  }
  // Choices of the view, and the names that can be chosen.
  get choices() {
    const [camera, samples, method, channel] = ["camera", "samples", "method", "channel"].map((name) => this.getAttribute(name));
    const { cameras = [], methods = [], channels = [] } = this.#shown;
    const sides = [[method, channel ?? "picture"], [this.#right.method, this.#right.channel]];
    return { cameras: [AS_WRITTEN, ...cameras], methods: [AS_WRITTEN, ...methods], channels, camera, samples, sides, wipe: this.#wipes };
  }
  #show_time() {
    const { timeline, frame } = this;
    this.time.show({ timeline, frame, shown: this.#shown.frame, plays: this.#plays, loops: this.#loops });
  }
  // Saves the picture or, where they are named, frames, with planes or as a pack; without a name it stops.
  save(output, aovs, frames) {
    this.#worker?.postMessage(output ? { save: { asked: this.#ask(), output, aovs, frames } } : { stop: true });
  }
  // A pack takes the place of all files.
  open_pack(bytes) {
    this.tell("opening the pack");
    this.#worker?.postMessage({ unpack: bytes }, [bytes.buffer]);
  }
  #ask(isDraft = false) {
    const [scene, frame] = [this.scene, this.frame];
    const text = this.#drafts.get(scene)?.text ?? this.files.get(scene);
    const [own, count, camera, method, names] = ["width", "samples", "camera", "method", "variant"].map((name) => this.getAttribute(name));
    const width = own === null ? Math.max(1, this.clientWidth) : whole(own, 2 ** 16);
    const samples = isDraft && this.edits ? 1 : whole(count, 2 ** 20) || null;
    const variant = names?.split(/\s+/).filter(Boolean);
    const asked = { ...this.#options, scene, text: typeof text === "string" ? text : null, width, samples, frame, camera, method };
    return variant?.length ? { ...asked, variant } : asked;
  }
  #emit(kind, detail) { this.dispatchEvent(new CustomEvent(kind, { detail })); }
  #see(isSeen) {
    this.#isSeen = isSeen;
    if (!isSeen) return;
    if (this.#worker) return this.#next();
    if (lacks() && !this.edits) return this.tell(`no picture: this browser lacks ${lacks()}`);
    this.#start();
    if (this.hasAttribute("src")) this.#load();
  }
  #start() {
    [this.#isReady, this.#heard] = [false, 0];
    this.#drafts.clear();
    this.tell(LOADING);
    this.#worker = work((data) => this.#hear[Object.keys(this.#hear).find((key) => key in data)](data), (words) => this.tell(words));
  }
  // A renderer that ends again before it has made a picture waits for a change.
  #restart(why) {
    this.#worker.terminate();
    this.#emit("saved", "");
    this.#restarts += 1;
    this.#isReady = false;
    if (this.#restarts < 3) this.#start();
    this.tell(this.#restarts < 3 ? `${why}; it is made anew` : `${why}, again and again; a change of the text starts it anew`);
  }
  async #load() {
    this.clear();
    const src = this.getAttribute("src");
    try {
      const url = new URL(src, document.baseURI);
      const name = decodeURIComponent(url.pathname.split("/").at(-1));
      const asked = /\.toml$/i.test(name) ? download(new URL(PROJECT, url), "text/html").catch(() => null) : null;
      const bytes = await download(url);
      const project = await asked;
      if (src !== this.getAttribute("src")) return;
      if (/\.zip$/i.test(name)) return this.open_pack(bytes);
      this.#folder = new URL(".", url);
      if (project) this.add(PROJECT, project);
      this.add(name, bytes);
      this.#opened(name);
    } catch (error) {
      this.tell(`${src} cannot be loaded: ${error.message}`);
    }
  }
  #opened(name, options = {}) {
    this.choose(name);
    this.#options = options;
    this.#emit("load", name);
    this.run();
  }
  // Files that the scene names and lacks are beside it, or nowhere: messages that they are missing wait for them.
  async #fetch_missing(paths) {
    const wanted = paths.filter((path) => this.#folder && !this.#asked.has(path));
    if (!wanted.length) return;
    const folder = this.#folder;
    this.#pending += 1;
    this.tell(`loading ${wanted.length === 1 ? wanted[0] : `${wanted.length} files`}`);
    await Promise.all(wanted.map(async (path) => {
      this.#asked.add(path);
      const bytes = await download(new URL(path.split("/").map(encodeURIComponent).join("/"), folder)).catch(() => null);
      if (bytes && folder === this.#folder && !this.files.has(path)) this.add(path, bytes);
    })).catch((error) => this.tell(error.message));
    this.#pending -= 1;
    if (!this.#pending) this.run();
  }
  #draw(side, { width, height }, pixels) {
    const drawn = new OffscreenCanvas(width, height);
    drawn.getContext("2d").putImageData(new ImageData(new Uint8ClampedArray(pixels.buffer), width, height), 0, 0);
    this.picture.show(side, drawn);
    this.canvas.dataset.shown = this.scene;
  }
  // Changes of texts are shown as drafts while an input goes on. Where it is over or fails, drafts end, and the editor hears.
  #change({ changes, writes, error, number }) {
    const written = [];
    this.#heard = number;
    for (const { file, before, after } of changes) {
      const draft = this.#drafts.get(file) ?? { base: this.files.get(file), text: this.files.get(file) };
      // Typed meanwhile, or with a mistake, so that the picture is of another text.
      if (draft.text !== before) error ??= "the text has changed meanwhile, or has mistakes";
      else if (writes) written.push([file, draft.base, after]);
      else this.#drafts.set(file, { ...draft, text: after });
      if (!error) this.#worker.postMessage({ file, bytes: new TextEncoder().encode(after) });
    }
    if (writes || error) {
      // A file whose draft ends without a change of it has the editor's text again.
      const ended = [...this.#drafts].filter(([file, { base }]) => base === this.files.get(file));
      this.#drafts.clear();
      for (const [file] of ended) this.#worker.postMessage(this.message_of(file));
      this.#emit("write", { changes: error ? [] : written, error });
    }
    this.run(Boolean(writes || error));
  }
  // Shows another frame.
  seek(frame) {
    this.frame = whole(frame, 2 ** 31);
    this.run(false);
  }
  // While it plays or turns, each picture asks for the next; not where nobody sees it.
  #next() {
    requestAnimationFrame((now) => {
      if (!this.#isSeen || !this.#isReady || this.#pending) return;
      const rests = this.#isHeld || matchMedia("(prefers-reduced-motion: reduce)").matches;
      const turns = this.hasAttribute("auto-rotate") && this.#moves && !rests;
      if (turns) {
        const speed = Number(this.getAttribute("auto-rotate")) || TURN_DEG_PER_S;
        const degrees = speed * Math.min(MOST_STEP_S, (now - this.#turned) / 1e3);
        this.act({ do: "orbit", by: [-degrees / 180, 0] });
        this.#turned = now;
      }
      if (!this.#plays) return;
      const [start, end] = this.timeline;
      this.#plays = this.#loops || this.frame < end;
      if (this.#plays) this.seek(this.frame < end ? this.frame + 1 : start);
      else this.#show_time();
    });
  }
  #hear = {
    state: (data) => {
      this.#isReady = true;
      this.#lacking = data.lacks;
      for (const name of this.files.keys()) this.#worker.postMessage(this.message_of(name));
      this.#emit("keys", data.keys);
      if (data.lacks) this.tell(`messages only: this browser lacks ${data.lacks}`);
      else if (this.status.textContent === LOADING) this.tell("");
      this.run();
    },
    missing: ({ missing }) => this.#fetch_missing(missing),
    check: ({ check }) => this.#pending || this.#emit("check", check),
    part: ({ part, pixels }) => {
      this.#draw(part.side, part, pixels);
      this.tell(`sample ${part.done} of ${part.samples}`);
    },
    shown: ({ shown, pictures }) => {
      this.#plays &&= Boolean(pictures);
      if (pictures) {
        pictures.forEach((pixels, side) => this.#draw(side, shown, pixels));
        this.picture.explain(shown.sides);
        this.#restarts = 0;
        [this.#shown, this.timeline, this.#moves] = [shown, shown.timeline, shown.moves];
        this.#plays &&= Boolean(shown.timeline) && shown.timeline[0] < shown.timeline[1];
      }
      this.#show_time();
      if (shown.lost) return this.#restart(`the device was lost (${shown.error})`);
      if (this.#pending) return;
      this.#emit("picture", shown);
      if (!pictures) {
        const mistake = !this.edits && shown.messages?.find(({ severity }) => severity === "error")?.text;
        this.tell(shown.error ?? (mistake || "the scene has mistakes"));
      } else {
        this.tell(this.edits ? in_words(shown) : "");
        this.#next();
      }
    },
    moved: () => this.run(false),
    panels: ({ panels }) => this.#emit("panels", panels),
    changed: ({ changed }) => this.#change(changed),
    progress: ({ progress }) => this.tell(progress),
    saved: ({ saved, name }) => {
      offer(saved, name);
      this.#emit("saved", name);
    },
    unsaved: ({ unsaved }) => {
      this.#emit("saved", "");
      this.tell(`nothing is saved: ${unsaved}`);
    },
    unpacked: ({ unpacked: { scene, set, variant, assets, lenient, strict, project }, files }) => {
      this.clear();
      try {
        for (const [name, bytes] of files) this.add(name, bytes);
      } catch (error) {
        return this.tell(`the pack is refused: ${error.message}`);
      }
      this.#opened(scene, { set, variant, assets, lenient, strict, project });
    },
    refused: ({ refused }) => this.tell(`the pack is refused: ${refused}`),
    ended: ({ ended }) => this.#restart(`the renderer ended (${ended})`),
  };
}

customElements.define("reflet-view", RefletView);
