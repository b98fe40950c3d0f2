// The program, away from the page, which stays quick: the checker and the renderer, or the language server. Messages: {module} first,
// then {clear}, {file, bytes}, {ask, checks}, {put}, {save}, {stop}, {unpack} and {rpc}; answers: {state}, {missing}, {check},
// {part, pixels}, {shown, pixels}, {put}, {progress}, {saved} or {unsaved}, {unpacked} or {refused}, {rpc} and {ended}.
import init, { answer, ask, check, clear, frames, interrupt, keep, language, missing, pack, pixels, put_camera, put_file, start, take, take_kept, unpack } from "./reflet_web.js";
import { lacks } from "./suspend.js";

const tell = (message, moved) => self.postMessage(message, moved);
self.tell_part = (done, samples, width, height, rgba) => tell({ part: { done, samples, width, height }, pixels: rgba }, [rgba.buffer]);
let why = "";
self.tell_panic = (text) => { why = text; };
const ended = (error) => tell({ ended: why || String(error) });

// Files that were looked for and are not there, before a message says so.
const tell_missing = () => {
  const paths = JSON.parse(missing());
  if (paths.length) tell({ missing: paths });
};

let show = null;
let [isSaving, isStopped] = [false, false];
// Whether the picture that was made last is the one that the page shows, not a frame that was saved.
let isShown = true;
// Calls that need the scene wait for the picture in work, which holds it.
let last = Promise.resolve();
const queue = (call) => { last = last.then(call).catch(ended); };

const make = async (asked) => {
  ask(asked);
  await show();
  return JSON.parse(answer());
};
// Of the pictures that were asked for meanwhile, only the last is made.
let next = null;
const makeNext = async () => {
  if (!next) return;
  const [asked, began] = [next, performance.now()];
  next = null;
  const shown = await make(asked);
  isShown = true;
  const rgba = shown.width ? pixels() : null;
  shown.seconds = (performance.now() - began) / 1e3;
  tell_missing();
  if (!shown.interrupted) tell({ shown, pixels: rgba }, rgba ? [rgba.buffer] : []);
};

// Mistakes of the user are thrown as words; all else ends the program.
const inWords = async (kind, call) => {
  try {
    await call();
  } catch (error) {
    if (typeof error !== "string") return ended(error);
    tell({ [kind]: error });
  }
};

// Each frame is a picture of its own; the shown one is not made again.
const save = async ({ asked, output, aovs: planes, frames: named }) => {
  [isSaving, isStopped] = [true, false];
  await inWords("unsaved", async () => {
    if (output.endsWith(".zip")) return tell({ saved: pack(JSON.stringify(asked)), name: output });
    const all = [...frames(named)];
    for (const [at, frame] of all.entries()) {
      if (named || planes.length || !isShown) {
        isShown = false;
        const shown = await make(JSON.stringify({ ...asked, frame, aovs: planes }));
        if (isStopped || !shown.width) throw isStopped ? "stopped" : shown.error ?? "the scene has mistakes";
      }
      keep(output);
      tell({ progress: `${at + 1} of ${all.length} pictures are made` });
    }
    const isOne = all.length === 1 && (!planes.length || output.endsWith(".exr"));
    tell({ saved: take_kept(), name: isOne ? output.replace("####", String(all[0]).padStart(4, "0")) : output.replace(/(\.####)?\.\w+$/, ".zip") });
  });
  isSaving = false;
};

const work = {
  clear,
  file: ({ file, bytes }) => put_file(file, new Uint8Array(bytes)),
  ask: ({ ask: asked, checks }) => {
    const json = JSON.stringify(asked);
    if (checks) {
      const found = JSON.parse(check(json));
      tell_missing();
      tell({ check: found });
    }
    if (!show) return;
    next = json;
    if (!isSaving) interrupt();
    queue(makeNext);
  },
  put: ({ put: [camera, eye] }) => queue(() => tell({ put: JSON.parse(put_camera(camera, new Float32Array(eye))) })),
  save: (wanted) => queue(() => save(wanted.save)),
  stop: () => { isStopped = isSaving; if (isSaving) interrupt(); },
  // A save keeps its pictures where a pack is opened, so that one waits for the other.
  unpack: ({ unpack: bytes }) => queue(() => inWords("refused", () => {
    const manifest = JSON.parse(unpack(bytes));
    tell({ unpacked: manifest, files: manifest.files.map(({ path }) => [path, take(path)]) });
  })),
  rpc: ({ rpc }) => tell({ rpc: language(rpc) }),
};

let load = null;
const loaded = new Promise((done) => { load = done; });
const ready = loaded.then(init).then((exports) => {
  start();
  const lacking = lacks();
  if (!lacking) show = WebAssembly.promising(exports.show);
  tell({ state: "ready", lacks: lacking });
}).catch(ended);

self.onmessage = async ({ data }) => {
  if (data.module) return load({ module_or_path: data.module });
  await ready;
  const kind = Object.keys(work).find((key) => key in data);
  try {
    work[kind](data);
  } catch (error) {
    ended(error);
  }
};
