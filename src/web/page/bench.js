// `bench`: views by `hybrid` and by `rt` in turns, in a worker with a device of its own, a chart of them, and the samples to save.
import { offer, work } from "./view.js";

const SIZES = [[320, 180], [640, 360], [1280, 720], [1920, 1080]];
const TIMED_BY = { gpu_timestamps: "timestamps", cpu_waits: "waits for each pass", none: "wall time of the frame: no timestamps" };
const [BAR_PX, LABEL_PX, CHART_PX] = [13, 300, 900];

const get = (id) => document.getElementById(id);
const [rows, chart, start, progress] = ["rows", "chart", "start", "progress"].map(get);
const tell = (words) => { get("status").textContent = words; };
const make = (kind, parent, attributes, text = "") => {
  const made = document.createElementNS(parent.namespaceURI, kind);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.textContent = text;
  parent.append(made);
  return made;
};

// The worker, which ends with its device; each question to it has one answer, or the reason why it has none.
let worker = null;
let answered = null;
const end = (why) => {
  worker?.terminate();
  worker = null;
  answered?.({ error: why });
};
const hear = (data) => {
  if (data.step) {
    tell(data.step);
    Object.assign(progress, { max: data.steps, value: data.done });
  } else if (data.ended) {
    end(`the program ended: ${data.ended}`);
  } else {
    answered?.(data.measured ?? data);
  }
};
const asked = (message) => new Promise((done) => {
  answered = done;
  if (message) worker.postMessage(message);
});
const texts = new Map();
const open = async () => {
  worker = work(hear, end);
  const state = await asked(null);
  for (const [file, bytes] of texts) worker?.postMessage({ file, bytes });
  return state;
};

// The machine as far as browsers tell it: WebGPU tells the family of the adapter, WebGL often its name, though perhaps of another.
const machine = async () => {
  const opened = await navigator.gpu.requestAdapter();
  if (!opened) throw new Error("this browser has no graphics adapter for WebGPU");
  const { info } = opened;
  const context = document.createElement("canvas").getContext("webgl");
  const names = context?.getExtension("WEBGL_debug_renderer_info");
  return {
    adapter: [info.vendor, info.architecture, info.device, info.description].filter(Boolean).join(" ") || "an adapter without a name",
    driver: names ? `WebGL: ${context.getParameter(names.UNMASKED_RENDERER_WEBGL)}` : "",
    os: navigator.userAgent,
    cpu: `${navigator.hardwareConcurrency} threads`,
  };
};

const number = (value, digits = 3) => value.toLocaleString("en", { maximumSignificantDigits: digits });
const count = (value) => value.toLocaleString("en");
const time_of = (point) => point.reflection_ms ?? point.frame_ms;
const of = ({ points }, method) => points.find((point) => point.method === method);

// A row tells the state of its view, and then its figures, behind the names of view and size.
const clear = (row) => row.replaceChildren(...[...row.children].slice(0, 2));
const say = (row, text, kind = "") => {
  clear(row);
  make("td", row, { colspan: 8, class: kind }, text);
};
const fill = (row, measured) => {
  const [rt, hybrid] = ["rt", "hybrid"].map((method) => of(measured, method));
  clear(row);
  for (const point of [rt, hybrid]) {
    const { median, ends } = time_of(point);
    const cell = make("td", row, {}, number(median));
    if (ends) make("small", cell, {}, ends.map((end) => number(end)).join(" to "));
  }
  const share = (key) => rt[key] > 0 ? number(hybrid[key] / rt[key], 2) : "–";
  // A browser may round a short pass to nothing.
  const [less, more] = [rt, hybrid].map((point) => time_of(point).median);
  const cells = [
    less > 0 ? (more / less).toFixed(2) : "–",
    count(rt.rays),
    count(hybrid.rays),
    count(hybrid.march_steps),
    share("visited_nodes"),
    TIMED_BY[rt.timing],
  ];
  for (const text of cells) make("td", row, {}, text);
};

const draw = (all) => {
  const most = Math.max(1e-3, ...all.flatMap(({ points }) => points.map((point) => time_of(point).median)));
  const height = 44 + all.length * (2 * BAR_PX + 14);
  chart.replaceChildren();
  chart.setAttribute("viewBox", `0 0 ${CHART_PX} ${height}`);
  const scale = (CHART_PX - LABEL_PX - 90) / most;
  for (const [at, method] of ["rt", "hybrid"].entries()) {
    make("rect", chart, { x: LABEL_PX + 90 * at, y: 12, width: 12, height: 12, fill: color_of(of(all[0], method)) });
    make("text", chart, { x: LABEL_PX + 90 * at + 18, y: 23 }, method);
  }
  make("text", chart, { x: LABEL_PX + 190, y: 23 }, "milliseconds, medians; less is better");
  make("line", chart, { x1: LABEL_PX, x2: LABEL_PX, y1: 34, y2: height - 6 });
  for (const [at, one] of all.entries()) {
    const top = 40 + at * (2 * BAR_PX + 14);
    make("text", chart, { x: LABEL_PX - 8, y: top + BAR_PX + 4, "text-anchor": "end" }, `${one.view.name}, ${one.size[1]}p`);
    for (const [line, method] of ["rt", "hybrid"].entries()) {
      const [point, y] = [of(one, method), top + line * (BAR_PX + 1)];
      const width = time_of(point).median * scale;
      make("rect", chart, { x: LABEL_PX, y, width, height: BAR_PX, fill: color_of(point) });
      make("text", chart, { x: LABEL_PX + width + 6, y: y + 11 }, number(time_of(point).median));
    }
  }
  chart.removeAttribute("hidden");
};
const color_of = ({ color }) => `rgb(${color})`;

// A tab that nobody sees may be slowed down: it waits, and what was measured meanwhile is measured again.
let wasHidden = false;
document.addEventListener("visibilitychange", () => { wasHidden ||= document.hidden; });
const seen = async () => {
  while (document.hidden) await new Promise((done) => document.addEventListener("visibilitychange", done, { once: true }));
  wasHidden = false;
};

let views = [];
let isStopped = false;
let csv = "";
const measure = async (row, wanted) => {
  for (let again = ""; !isStopped; again = " again, since the tab was hidden") {
    if (document.hidden) say(row, "waits for the tab to be seen");
    await seen();
    if (isStopped) break;
    say(row, `is measured${again}`);
    const state = worker ? {} : await open();
    const measured = state.error ? state : await asked({ bench: wanted });
    if (measured.error || !wasHidden) return measured;
  }
  return { error: "stopped" };
};

const run = async (host) => {
  const chosen = (id) => [...get(id).querySelectorAll("input")].flatMap((input, at) => input.checked ? [at] : []);
  const frames = Math.min(200, Math.max(1, Math.trunc(Number(get("frames").value)) || 1));
  const all = chosen("sizes").flatMap((size) => chosen("views").map((view) => ({ view: views[view], size: SIZES[size], frames })));
  if (!all.length) return tell("choose a view and a size");
  isStopped = false;
  csv = "";
  get("save").disabled = true;
  for (const element of [document.querySelector("table"), get("notes"), progress]) element.hidden = false;
  chart.setAttribute("hidden", "");
  rows.replaceChildren();
  const lines = all.map(({ view, size }) => {
    const row = make("tr", rows, {});
    for (const text of [view.name, size.join(" × ")]) make("td", row, {}, text);
    say(row, "waits");
    return row;
  });
  const done = [];
  for (const [at, wanted] of all.entries()) {
    const measured = await measure(lines[at], { ...wanted, ...host });
    if (measured.error) {
      // Another device may do better, so that the next view has a new worker.
      end("");
      say(lines[at], measured.error, "failed");
      if (isStopped) break;
      continue;
    }
    csv += (csv ? "" : measured.header) + measured.lines;
    done.push({ ...wanted, ...measured });
    fill(lines[at], measured);
    draw(done);
    get("save").disabled = false;
  }
  progress.hidden = true;
  for (const row of lines.filter((row) => row.textContent.endsWith("waits"))) say(row, "not measured");
  const saving = done.length ? "; the samples can be saved" : "";
  tell(`${isStopped ? "stopped: " : ""}${done.length} of ${all.length} views are measured${saving}`);
};

const choice = (id, names, checked) => {
  for (const [at, name] of names.entries()) {
    const label = make("label", get(id), {});
    make("input", label, { type: "checkbox" }).checked = checked(at);
    label.append(` ${name}`);
  }
};
const begin = async () => {
  const state = await open();
  if (state.error ?? state.lacks) return tell(state.error ?? `nothing can be measured: this browser lacks ${state.lacks}`);
  ({ views } = await asked({ views: true }));
  await Promise.all([...new Set(views.map(({ scene }) => scene))].map(async (scene) => {
    const found = await fetch(scene);
    if (!found.ok) throw new Error(`${scene} is missing`);
    texts.set(scene, new Uint8Array(await found.arrayBuffer()));
    worker.postMessage({ file: scene, bytes: texts.get(scene) });
  }));
  const host = await machine();
  const isSoftware = /swiftshader|llvmpipe|warp|basic render/i.test(host.adapter);
  choice("views", views.map(({ name }) => name), () => true);
  choice("sizes", SIZES.map((size) => size.join(" × ")), (at) => isSoftware ? at === 0 : at >= 2);
  if (isSoftware) get("frames").value = 3;
  const driver = host.driver ? ` (${host.driver})` : "";
  const slow = isSoftware ? " It renders on the processor, so that sizes above the smallest take long." : "";
  get("machine").textContent = `Adapter: ${host.adapter}${driver}.${slow}`;
  tell("ready");
  start.disabled = false;
  get("choice").onsubmit = async (event) => {
    event.preventDefault();
    if (start.textContent === "stop") {
      isStopped = true;
      return end("stopped");
    }
    start.textContent = "stop";
    await run(host).catch((error) => tell(error.message));
    start.textContent = "start";
  };
  get("save").onclick = () => offer(csv, "samples.csv");
};

begin().catch((error) => tell(`nothing can be measured: ${error.message}`));
