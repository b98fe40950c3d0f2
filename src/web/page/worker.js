// The program, away from the page, which stays quick: the checker and the renderer, or the language server. Messages: {module} first,
// then {clear}, {file, bytes}, {ask, sides, checks, isDraft, heard}, {act}, {save}, {stop}, {unpack}, {rpc}, {views} and {bench}; answers:
// {state}, {missing}, {check}, {part, pixels}, {shown, pictures}, {panels}, {changed}, {moved}, {progress}, {saved} or {unsaved}, {unpacked} or
// {refused}, {rpc}, {views}, {step} and {measured}, and {ended}.
import init, { answer, ask, ask_act, ask_bench, check, clear, frames, interrupt, keep, keys, language, missing, pack, panels, pixels, put_file, start, take, take_kept, unpack, views } from "./reflet_web.js";
import { lacks } from "./suspend.js";

const tell = (message, moved) => self.postMessage(message, moved);
let side = 0;
self.tell_part = (done, samples, width, height, rgba) => tell({ part: { side, done, samples, width, height }, pixels: rgba }, [rgba.buffer]);
self.tell_step = (step, done, steps) => tell({ step, done, steps });
let why = "";
self.tell_panic = (text) => { why = text; };
const ended = (error) => tell({ ended: why || String(error) });

// Files that were looked for and are not there, before a message says so.
const tell_missing = () => {
  const paths = JSON.parse(missing());
  if (paths.length) tell({ missing: paths });
};

let [show, act, bench] = [null, null, null];
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
// Panels that have changed.
let told = {};
const tell_panels = () => {
  const now = JSON.parse(panels());
  const changed = Object.entries(now).filter(([name, json]) => told[name] !== json);
  told = now;
  if (changed.length) tell({ panels: Object.fromEntries(changed.map(([name, json]) => [name, JSON.parse(json)])) });
};

// Of the pictures that were asked for meanwhile, only the last is made. One in work is given up for the next, but drafts of a drag
// are not, which would show nothing then; and a picture that inputs have cut off is made after them.
let [next, inWork, cutOff] = [null, null, null];
// Pictures of the sides of a wipe, one after the other, told as the first of them; or as one that fails.
const makeSides = async (asked) => {
  const [answers, pictures] = [[], []];
  for (const json of asked) {
    side = answers.length;
    answers.push(await make(json));
    if (!answers.at(-1).width) return { shown: answers.at(-1), pictures: [] };
    pictures.push(pixels());
  }
  const sides = answers.map(({ method, legend }) => ({ method, legend }));
  return { shown: { ...answers[0], sides }, pictures };
};
const giveUp = () => { if (!isSaving && !inWork?.isDraft) interrupt(); };
const makeNext = async () => {
  if (!next) return;
  const began = performance.now();
  [inWork, next, cutOff] = [next, null, null];
  const made = inWork;
  const { shown, pictures } = await makeSides(made.sides);
  if (shown.interrupted) cutOff = made;
  inWork = null;
  isShown = pictures.length === 1;
  // Inputs are about the scene that was asked for.
  if (shown.interrupted && !shown.open && acts.length) {
    next ??= cutOff;
    queue(makeNext);
    return;
  }
  tell_panels();
  isOwed &&= made.heard !== changes;
  if (acts.length) queue(actNext);
  shown.seconds = (performance.now() - began) / 1e3;
  tell_missing();
  if (!shown.interrupted) tell({ shown, pictures: shown.width ? pictures : null }, pictures.map((rgba) => rgba.buffer));
};

// Inputs that wait, the number of those that have changed texts, and whether the picture after the last of these is still to come:
// the next input is about its text.
let [acts, changes, isOwed] = [[], 0, false];
const actNext = async () => {
  if (isOwed || !acts.length) return;
  ask_act(JSON.stringify(acts.shift()));
  await act();
  const done = JSON.parse(answer());
  if (done.error) told = {};
  tell_panels();
  isOwed = Boolean(done.changes.length || done.writes);
  if (isOwed) return tell({ changed: { ...done, number: ++changes } });
  if (done.moves) tell({ moved: true });
  if (acts.length) return queue(actNext);
  // The page asks for the picture of a moved camera.
  if (!done.moves) next ??= cutOff;
  queue(makeNext);
};
// Of the steps of an input that wait, only the last counts; moves of the camera add up.
const both = (a, b) => ({ ...b, by: b.by.map((x, axis) => a.by[axis] + x) });
const sums = {
  orbit: both, pan: both, look: both,
  drag: (a, b) => !b.start && { ...both(a, b), start: a.start },
  dolly: (a, b) => ({ ...b, notches: a.notches + b.notches }),
  fly: (a, b) => `${a.by}` === `${b.by}` && { ...b, seconds: a.seconds + b.seconds },
};
const take_act = (now) => {
  const last = acts.at(-1);
  const replaces = (a, b) => a.write === false && a.key === b.key && a.name === b.name && b;
  const joined = last?.do === now.do && (sums[now.do] ?? replaces)(last, now);
  if (joined) acts[acts.length - 1] = joined;
  else acts.push(now);
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
  clear: () => {
    acts = [];
    clear();
  },
  file: ({ file, bytes }) => put_file(file, new Uint8Array(bytes)),
  ask: ({ ask: asked, sides, checks, isDraft, heard }) => {
    if (checks) {
      const found = JSON.parse(check(JSON.stringify(asked)));
      tell_missing();
      tell({ check: found });
    }
    if (!show) return;
    next = { sides: sides.map((own) => JSON.stringify({ ...asked, ...own })), isDraft, heard };
    giveUp();
    queue(makeNext);
  },
  act: ({ act: message }) => {
    if (!act) return;
    take_act(message);
    giveUp();
    queue(actNext);
  },
  save: (wanted) => queue(() => save(wanted.save)),
  stop: () => { isStopped = isSaving; if (isSaving) interrupt(); },
  // A save keeps its pictures where a pack is opened, so that one waits for the other.
  unpack: ({ unpack: bytes }) => queue(() => inWords("refused", () => {
    const manifest = JSON.parse(unpack(bytes));
    tell({ unpacked: manifest, files: manifest.files.map(({ path }) => [path, take(path)]) });
  })),
  views: () => tell({ views: JSON.parse(views()) }),
  bench: ({ bench: asked }) => queue(async () => {
    ask_bench(JSON.stringify(asked));
    await bench();
    tell({ measured: JSON.parse(answer()) });
  }),
  rpc: ({ rpc }) => tell({ rpc: language(rpc) }),
};

let load = null;
const loaded = new Promise((done) => { load = done; });
const ready = loaded.then(init).then((exports) => {
  start();
  const lacking = lacks();
  if (!lacking) [show, act, bench] = [exports.show, exports.act, exports.bench].map((call) => WebAssembly.promising(call));
  tell({ state: "ready", lacks: lacking, keys: JSON.parse(keys()) });
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
