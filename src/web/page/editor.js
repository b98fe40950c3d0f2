// The page: texts of a scene beside its picture, which the element `reflet-view` makes.
import { begin_choices } from "./choices.js";
import { begin_handles } from "./handles.js";
import { begin_keyboard } from "./keyboard.js";
import { begin_keys } from "./keys.js";
import * as language from "./language.js";
import { begin_panels } from "./panels.js";
import { fromFragment, is_scene, toFragment } from "./share.js";
import { offer, work } from "./view.js";

const [TYPING_MS, EXAMPLE] = [300, "scenes/mirrors.toml"];

const get = (id) => document.getElementById(id);
const [text, lines, messages, status, view] = ["text", "lines", "messages", "status", "stage"].map(get);
const { files } = view;
view.edits = true;
// Why the address that was opened holds no scene, until the text changes.
let refusal = "";
// Name of the shown scene in files.
const stem = () => view.scene.replace(/^.*\/|\.\w+$/g, "");
const tell = (words) => { status.textContent = refusal + words; };

let [tab, timer] = ["", 0];

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
    if (message.fix) {
      const fix = Object.assign(document.createElement("button"), { className: "fix", textContent: `write ${message.fix.new}` });
      fix.onclick = () => mend(message);
      item.append(fix);
    }
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

// Writes the words that a message advises, unless the text has changed since.
const mend = ({ file, fix: { range: { start, end }, old, new: words } }) => {
  go_to(file, start, end);
  if (file === tab && !language.replace(old, words)) tell("the text has changed: the advice is not written");
};

// Writes the advice of the message at the caret, or else of the first message in its line.
const mend_at_caret = () => {
  const own = (messages.found ?? []).filter(({ file, fix }) => fix && file === tab);
  const caret = text.selectionStart;
  const holds = ({ range }) => language.offset_of(text.value, range.start) <= caret && caret <= language.offset_of(text.value, range.end);
  const line = text.value.slice(0, caret).split("\n").length - 1;
  const message = own.find(holds) ?? own.find(({ range }) => range.start.line === line);
  if (message) mend(message);
  else tell("no message in this line says what to write");
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

const open = (name) => {
  tab = name;
  if (is_scene(name)) {
    // Another scene has other cameras.
    if (name !== view.scene) view.removeAttribute("camera");
    view.choose(name);
  }
  text.readOnly = typeof files.get(name) !== "string";
  text.value = text.readOnly ? "" : files.get(name);
  show_tabs();
  list(messages.found ?? []);
  view.run();
};

// Other texts take the place of all files.
const replace = (all) => {
  view.removeAttribute("src");
  view.clear();
  language.restart();
  for (const [name, content] of Object.entries(all)) view.put(name, content);
  open(Object.keys(all)[0]);
};

const heard = {
  status: tell,
  file: (name) => {
    language.hand(view.message_of(name));
    if (name === tab && !text.readOnly && text.value !== files.get(name)) language.replace_all(files.get(name));
    show_tabs();
  },
  load: (name) => {
    view.removeAttribute("camera");
    language.restart();
    open(name);
  },
  check: list,
  picture: (shown) => {
    // A camera that has another name now: the text's own is shown.
    if (shown.unknown) view.removeAttribute(shown.unknown);
    tracks.paint();
    choices.show(view.choices);
    const prints = (shown.log ?? []).map((line) => ({ severity: "print", text: line }));
    if (shown.messages) list([...shown.messages, ...prints]);
    get("save").disabled &&= !shown.width;
    if (shown.aovs && `${shown.aovs}` !== `${[...get("aovs").options].map(({ value }) => value)}`) get("aovs").replaceChildren(...shown.aovs.map((name) => new Option(name)));
  },
  // Written as by typing; the focus stays where the input is.
  write: ({ changes, error }) => {
    const focus = document.activeElement;
    for (const [file, before, after] of changes) {
      if (files.get(file) !== before) error = "the text has changed meanwhile";
      else if (before !== after) view.put(file, after);
    }
    focus.focus({ preventScroll: true });
    refusal = error ? `not written: ${error}; ` : "";
  },
  choice: () => choices.show(view.choices),
  keys: (all) => keyboard.show(all),
  panels: ({ tracks: found, handles: drawn, ...all }) => {
    for (const [name, shown] of Object.entries(all)) panels[name](shown);
    if (drawn) handles.show(drawn);
    if (found) tracks.show(found, false);
  },
  saved: (name) => {
    get("save").textContent = "save";
    get("saving").open &&= !name;
  },
};
const send = (message) => view.send(message);
const choices = begin_choices(get("view-choices"), send);
const panels = begin_panels(get("panels"), send);
const handles = begin_handles(view.canvas, get("handles"), send);
const tracks = begin_keys(get("keys"), { send, scene: () => ({ timeline: view.timeline }), frame: () => view.frame });
// Keys are for the picture where it has the focus, or nothing.
const keyboard = begin_keyboard({
  stage: view, send,
  counts: (target) => target === document.body || target.getRootNode().host === view || target === view,
  save: () => view.canvas.toBlob((png) => offer(png, `${stem()}.png`)),
});
for (const [kind, hear] of Object.entries(heard)) view.addEventListener(kind, ({ detail }) => hear(detail));
language.begin({ view, tab: () => tab, work: (hear) => work(hear, tell), go_to, mend: mend_at_caret, tell });

// Files with their paths; of scenes, the one of the shortest path is opened.
const add = async (dropped) => {
  const depth = ([path]) => path.split("/").length;
  let scene = "";
  for (const [path, file] of dropped.sort((a, b) => depth(b) - depth(a))) {
    try {
      view.check(path, file.size);
      if (/\.zip$/i.test(path)) return view.open_pack(new Uint8Array(await file.arrayBuffer()));
      view.add(path, new Uint8Array(await file.arrayBuffer()));
      if (is_scene(path)) scene = path;
    } catch (error) {
      tell(error.message);
      return;
    }
  }
  open(scene || tab);
};

// Files of a dropped file or folder, with their paths.
const files_of = async (entry) => {
  if (entry.isFile) return [[entry.fullPath.slice(1), await new Promise((done, fail) => entry.file(done, fail))]];
  const [reader, all] = [entry.createReader(), []];
  for (let some; (some = await new Promise((done, fail) => reader.readEntries(done, fail))).length;) all.push(...some);
  return (await Promise.all(all.map(files_of))).flat();
};

const names_in = async (folder) => (await fetch(`${folder}/names.json`)).json();
// The files of a new project take the place of all; its scene is shown.
const make_new = async () => {
  const names = (await names_in("new")).sort((a, b) => b.startsWith("scenes/") - a.startsWith("scenes/"));
  const content = async (name) => [name, await (await fetch(`new/${name}`)).text()];
  replace(Object.fromEntries(await Promise.all(names.map(content))));
};

const begin = async () => {
  const names = (await names_in("scenes")).filter((name) => name.endsWith(".toml"));
  get("examples").append(...names.map((name) => new Option(name, `scenes/${name}`)));
  const choose = (src) => view.setAttribute("src", src);
  get("examples").onchange = ({ target }) => target.value && choose(target.value);
  const arrive = async () => {
    refusal = "";
    if (location.hash.length < 2) return choose(EXAMPLE);
    try {
      replace(await fromFragment(location.hash.slice(1)));
    } catch (error) {
      refusal = `the address holds no scene: ${error.message}; this is ${EXAMPLE}: `;
      choose(EXAMPLE);
    }
  };
  addEventListener("hashchange", arrive);
  await arrive();
};

text.oninput = () => {
  refusal = "";
  view.put(tab, text.value);
  list([]);
  clearTimeout(timer);
  timer = setTimeout(() => view.run(), TYPING_MS);
};
text.onscroll = () => { lines.scrollTop = text.scrollTop; };
get("new").onclick = () => make_new().catch((error) => tell(`a new project cannot be loaded: ${error.message}`));
get("width").onchange = ({ target }) => view.setAttribute("width", target.value);
get("save").onclick = (event) => {
  event.preventDefault();
  if (get("save").textContent === "stop") return view.save();
  get("save").textContent = "stop";
  const [format, frames] = ["format", "frames"].map((id) => get(id).value.trim());
  view.save(`${stem()}${frames && format !== "zip" ? ".####" : ""}.${format}`, [...get("aovs").selectedOptions].map(({ value }) => value), frames);
};
for (const id of ["files", "folder"]) get(id).onchange = ({ target }) => add([...target.files].map((file) => [file.webkitRelativePath || file.name, file]));
get("share").onclick = async () => {
  const texts = [...files].filter(([, content]) => typeof content === "string");
  // The shown scene comes first.
  texts.sort(([a], [b]) => (b === view.scene) - (a === view.scene));
  history.replaceState(null, "", `#${await toFragment(Object.fromEntries(texts))}`);
  await navigator.clipboard?.writeText(location.href).catch(() => {});
  const left = files.size - texts.length;
  tell(`the address holds ${texts.length} text${texts.length === 1 ? "" : "s"}${left ? `, and not the ${left} other files` : ""}: copy it`);
};
// Undoes and redoes changes of the text, also while a slider or the picture has the focus. The browser counts what was typed into
// fields of the panels as steps too, which are passed over and change nothing.
let isUndoing = false;
for (const kind of ["input", "change"]) {
  get("panels").addEventListener(kind, (event) => { if (isUndoing) event.stopImmediatePropagation(); }, { capture: true });
}
addEventListener("keydown", (event) => {
  const { key, ctrlKey, metaKey, altKey, shiftKey, target } = event;
  const kind = { z: shiftKey ? "redo" : "undo", y: "redo" }[key.toLowerCase()];
  const isTyped = target !== text && target.matches("input:not([type=range], [type=checkbox], [type=color])");
  if (!kind || !(ctrlKey || metaKey) || altKey || isTyped) return;
  event.preventDefault();
  const before = text.value;
  isUndoing = true;
  do text.focus({ preventScroll: true });
  while (text.value === before && document.queryCommandEnabled(kind) && document.execCommand(kind));
  for (const input of get("panels").querySelectorAll("input[type=number], input[type=text]")) input.value = input.known;
  isUndoing = false;
});
addEventListener("dragover", (event) => { event.preventDefault(); document.body.classList.add("dropping"); });
addEventListener("dragleave", () => document.body.classList.remove("dropping"));
addEventListener("drop", async (event) => {
  event.preventDefault();
  document.body.classList.remove("dropping");
  const dropped = [...event.dataTransfer.items].filter(({ kind }) => kind === "file").map((item) => item.webkitGetAsEntry() ?? item.getAsFile());
  const all = await Promise.all(dropped.map((it) => it instanceof File ? [[it.name, it]] : files_of(it))).catch((error) => [tell(error.message)]);
  if (all[0]) add(all.flat());
});

begin().catch((error) => tell(`the page cannot be loaded: ${error.message}`));
