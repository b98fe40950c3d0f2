// Completion, the manual under the pointer, colors, renaming and definitions in the editor. The program's language server answers,
// as messages of its protocol (LSP), in a worker of its own: it is quick while a picture is made.
const [ROW_PX, PADDING_PX] = [18, 8];
const REST_MS = 350;

const get = (id) => document.getElementById(id);
const [text, completion, choices, manual, hover, naming] = ["text", "completion", "choices", "manual", "hover", "naming"].map(get);
const ruler = document.createElement("canvas").getContext("2d");

// The editor: the view with its files and the shown one, and functions that make a worker, go to a place, mend and tell words.
let page = null;
let worker = null;
let opened = ["", ""];
let asked = 0;
const waiting = new Map();

const uri_of = (name) => `file:///${name.split("/").map(encodeURIComponent).join("/")}`;
const name_of = (uri) => decodeURIComponent(uri.slice("file:///".length));
const position = (offset) => {
  const rows = text.value.slice(0, offset).split("\n");
  return { line: rows.length - 1, character: rows.at(-1).length };
};
export const offset_of = (content, { line, character }) =>
  content.split("\n").slice(0, line).reduce((sum, row) => sum + row.length + 1, character);

export const begin = (given) => { page = given; };
// Other files take the place of all, or the server has ended: the next question starts one.
export const restart = () => {
  worker?.terminate();
  worker = null;
};
export const hand = (message) => worker?.postMessage(message);

const post = (message) => worker.postMessage({ rpc: JSON.stringify({ jsonrpc: "2.0", ...message }) });
// Result of a request about the text as it is now.
const ask = async (method, params = {}) => {
  if (!worker) {
    [opened, worker] = [["", ""], page.work(({ rpc, ended }) => {
      if (ended) restart();
      for (const answer of JSON.parse(rpc ?? "[]")) waiting.get(answer.id)?.(answer);
    })];
    for (const name of page.view.files.keys()) hand(page.view.message_of(name));
  }
  const [uri, [last, old]] = [uri_of(page.tab()), opened];
  const tell = (what, textDocument) => post({ method: `textDocument/${what}`, params: { textDocument } });
  // Other texts are read as files, since a new name changes them too.
  if (last && last !== uri) tell("didClose", { uri: last });
  if (last !== uri || old !== text.value) tell("didOpen", { uri, text: text.value });
  opened = [uri, text.value];
  const id = ++asked;
  post({ id, method: `textDocument/${method}`, params: { textDocument: { uri }, ...params } });
  const { result, error } = await new Promise((done) => { waiting.set(id, done); });
  waiting.delete(id);
  if (error) throw new Error(error.message);
  return result;
};

// The few forms of Markdown that the manual has.
const show_manual = (box, markdown) => {
  const made = (kind, words) => Object.assign(document.createElement(kind), { textContent: words });
  const plain = (words) => words.trim().replace(/\[([^\]]*)\]\([^)]*\)/g, "$1").replace(/\n{2,}/g, "\n")
    .split("`").map((part, at) => made(at % 2 ? "code" : "span", part));
  box.replaceChildren(...markdown.split(/```\w*\n?/).flatMap((part, at) => at % 2 ? made("pre", part.trimEnd()) : plain(part)));
};

const width = (part) => {
  ruler.font = getComputedStyle(text).font;
  return ruler.measureText(part.replaceAll("\t", "  ")).width;
};
// Shows a box below a place in the text, above it where there is more room or the text that follows is to be seen.
const place = (box, offset, isAbove = false) => {
  box.hidden = false;
  const edge = text.getBoundingClientRect();
  const { line, character } = position(offset);
  const row = text.value.split("\n")[line].slice(0, character);
  const left = edge.left + PADDING_PX + width(row) - text.scrollLeft;
  const top = edge.top + PADDING_PX + line * ROW_PX - text.scrollTop;
  const fitsBelow = top + ROW_PX + box.offsetHeight < innerHeight || top < innerHeight / 2;
  const isBelow = isAbove ? top < box.offsetHeight : fitsBelow;
  box.style.left = `${Math.max(4, Math.min(left, innerWidth - box.offsetWidth - 4))}px`;
  box.style.top = `${isBelow ? top + ROW_PX : Math.max(4, top - box.offsetHeight)}px`;
};
// Offset of the character under a pointer; -1 beside the text.
const offset_at = ({ clientX, clientY }) => {
  const edge = text.getBoundingClientRect();
  const line = Math.floor((clientY - edge.top - PADDING_PX + text.scrollTop) / ROW_PX);
  const left = clientX - edge.left - PADDING_PX + text.scrollLeft;
  const row = text.value.split("\n")[line] ?? "";
  if (left < 0 || width(row) < left) return -1;
  let [character, end] = [0, row.length];
  while (end - character > 1) {
    const middle = (character + end) >> 1;
    if (width(row.slice(0, middle)) < left) character = middle;
    else end = middle;
  }
  return offset_of(text.value, { line, character });
};

// Writes as typing does, so that it can be undone.
let isTyped = true;
const write = (from, to, words) => {
  text.focus();
  text.setSelectionRange(from, to);
  isTyped = false;
  if (!document.execCommand("insertText", false, words)) {
    text.setRangeText(words, from, to, "end");
    text.dispatchEvent(new Event("input"));
  }
  isTyped = true;
};
// Writes other words in place of the selected ones, where these are still the expected words.
export const replace = (old, words) => {
  const [from, to] = [text.selectionStart, text.selectionEnd];
  if (text.value.slice(from, to) !== old) return false;
  write(from, to, words);
  return true;
};
// Puts a text in place of the shown one; only where they differ.
export const replace_all = (words) => {
  const old = text.value;
  let [from, end] = [0, 0];
  while (from < words.length && words[from] === old[from]) from += 1;
  while (end < Math.min(words.length, old.length) - from && words.at(-1 - end) === old.at(-1 - end)) end += 1;
  write(from, old.length - end, words.slice(from, words.length - end));
};
const apply = (edits, content, change) => edits
  .map(({ range, newText }) => [offset_of(content, range.start), offset_of(content, range.end), newText])
  .sort(([a], [b]) => b - a).forEach((edit) => change(...edit));

// Completion: items, the chosen one, and the written part of the word that they continue.
let [items, chosen, written] = [[], 0, ""];
// Whether an item was chosen by an arrow; and file, text and caret that the items are for.
let isChosen = false;
let offered = [];
// File, text and caret of the shown signature.
let signed = [];
const place_now = () => [page.tab(), text.value, text.selectionStart];
const isNow = (place) => place_now().every((part, at) => part === place[at]);
// Answers that come later than this are not shown.
let hidden = 0;
const hide = () => {
  hidden += 1;
  completion.hidden = hover.hidden = true;
  signed = [];
  text.removeAttribute("aria-activedescendant");
};
const choose = (at) => {
  choices.children[chosen]?.setAttribute("aria-selected", "false");
  chosen = (at + items.length) % items.length;
  const option = choices.children[chosen];
  option.setAttribute("aria-selected", "true");
  option.scrollIntoView({ block: "nearest" });
  text.setAttribute("aria-activedescendant", option.id);
  show_manual(manual, items[chosen].documentation?.value ?? "");
  place(completion, text.selectionStart - written.length);
};
const isQuoted = (line) => line.replace(/\\./g, "").split('"').length % 2 === 0;
const written_before = (line) => {
  return isQuoted(line) ? line.slice(line.lastIndexOf('"') + 1) : line.match(page.tab().endsWith(".rhai") ? /\w*$/ : /[\w-]*$/)[0];
};
const complete = async () => {
  const [now, before] = [place_now(), hidden];
  const caret = now[2];
  const found = await ask("completion", { position: position(caret) });
  if (!isNow(now) || before !== hidden) return;
  [offered, isChosen] = [now, false];
  written = written_before(text.value.slice(text.value.lastIndexOf("\n", caret - 1) + 1, caret));
  // Names that begin with the written part come before names whose later word does.
  const place_in = ({ label }) => {
    const [name, part] = [label.replaceAll('"', ""), written].map((each) => each.toLowerCase());
    return name.startsWith(part) ? 0 : ["_", "-", ".", "/"].some((sign) => name.includes(sign + part)) ? 1 : 2;
  };
  items = (found ?? []).filter((item) => place_in(item) < 2 && (item.insertText ?? item.label) !== written);
  items.sort((a, b) => place_in(a) - place_in(b));
  if (!items.length) return hide();
  hover.hidden = true;
  choices.replaceChildren(...items.map((item, index) => {
    const option = Object.assign(document.createElement("li"), { textContent: item.label, id: `choice-${index}`, role: "option" });
    option.onmousedown = (event) => {
      event.preventDefault();
      accept(item);
    };
    return option;
  }));
  completion.hidden = false;
  choices.scrollTop = 0;
  choose(0);
};
const accept = ({ label, insertText = label, insertTextFormat }) => {
  const caret = text.selectionStart;
  const [before, after] = [text.value.slice(0, caret - written.length), text.value.slice(caret)];
  const hole = insertTextFormat === 2 ? insertText.match(/\$(?:1|\{1:((?:\\.|[^\\}])*)\})/) : null;
  const value = (hole?.[1] ?? "").replace(/\\(.)/g, "$1");
  let words = hole ? insertText.replace(hole[0], () => value) : insertText;
  if (before.endsWith("=")) words = ` ${words}`;
  const start = before.length + (hole ? hole.index : words.length);
  const quote = before.endsWith('"') && !/^[^"\n]*"/.test(after) ? '"' : "";
  hide();
  const line = before.slice(before.lastIndexOf("\n") + 1);
  // A text is replaced up to its closing quote.
  const rest = isQuoted(line) ? after.match(/^[^"\n]*(?=")/)?.[0] ?? "" : after.match(/^\w*/)[0];
  write(before.length, caret + rest.length, words + quote);
  text.setSelectionRange(start + (hole ? 0 : quote.length), start + (hole ? value.length : quote.length));
  // The value of a key without a default, as a name after a bracket, comes next.
  assist(hole && !value);
};
// Shows the completions of a word that is begun, or else the signature of the call.
const assist = async (isBegun) => {
  if (isBegun) await complete();
  if (completion.hidden) await sign();
};
text.addEventListener("input", () => {
  const caret = text.selectionStart;
  const line = text.value.slice(text.value.lastIndexOf("\n", caret - 1) + 1, caret);
  const isScript = page.tab().endsWith(".rhai");
  const isComment = isScript && line.includes("//");
  // After a closing quote nothing is to complete, and scripts have names of their own behind brackets and signs.
  const isBegun = line.endsWith('"') ? isQuoted(line) : (isScript ? /[\p{L}_]{2}$|\.$/u : /[\p{L}_[.=]$/u).test(line);
  hide();
  if (isTyped && !isComment) assist(isBegun);
});

// Signature of the call that the caret is in, with the argument that is written now, and its manual.
const sign = async () => {
  const [now, before] = [place_now(), hidden];
  const found = await ask("signatureHelp", { position: position(now[2]) });
  if (!found || !isNow(now) || before !== hidden || !completion.hidden) return;
  const { label, parameters, documentation } = found.signatures[found.activeSignature];
  show_manual(hover, documentation.value);
  // Names of arguments follow each other in the label.
  let [start, end] = [label.indexOf("("), label.indexOf("(")];
  for (const name of parameters.slice(0, found.activeParameter + 1)) {
    start = label.indexOf(name.label, end);
    end = start + name.label.length;
  }
  const [line, argument] = [document.createElement("pre"), document.createElement("mark")];
  if (found.activeParameter >= parameters.length) start = end = label.length;
  argument.textContent = label.slice(start, end);
  line.append(label.slice(0, start), argument, label.slice(end));
  hover.prepend(line);
  signed = now;
  place(hover, now[2], true);
};

// The manual under the pointer, with a picker where it is on a color.
let [resting, shown] = [0, [0, 0]];
const show_hover = async (offset) => {
  const [now, before] = [place_now(), hidden];
  const at = { position: position(offset) };
  const [found, colors] = [await ask("hover", at), await ask("documentColor") ?? []];
  const ends = (range) => [offset_of(text.value, range.start), offset_of(text.value, range.end)];
  const holds = ([start, end]) => start <= offset && offset < end;
  const color = colors.find(({ range }) => holds(ends(range)));
  const isOld = now[0] !== page.tab() || now[1] !== text.value || before !== hidden;
  if (!found && !color || !completion.hidden || isOld) return;
  const place_of_color = color && ends(color.range);
  shown = ends((color ?? found).range ?? { start: at.position, end: at.position });
  show_manual(hover, found?.contents.value ?? "");
  if (color) {
    const two = (part) => Math.round(part * 255).toString(16).padStart(2, "0");
    const value = `#${["red", "green", "blue"].map((part) => two(color.color[part])).join("")}`;
    const picker = Object.assign(document.createElement("input"), { type: "color", value, title: "choose another color" });
    picker.onchange = async () => {
      hover.hidden = true;
      if (page.tab() !== now[0] || text.value !== now[1]) return page.tell("the text has changed: the color is not written");
      const part = (from) => parseInt(picker.value.slice(from, from + 2), 16) / 255;
      const range = { start: position(place_of_color[0]), end: position(place_of_color[1]) };
      const [{ label }] = await ask("colorPresentation", { color: { red: part(1), green: part(3), blue: part(5), alpha: 1 }, range });
      write(...place_of_color, label);
    };
    hover.prepend(picker);
  }
  place(hover, shown[0]);
};
text.addEventListener("mousemove", (event) => {
  clearTimeout(resting);
  const offset = offset_at(event);
  if (!hover.hidden && offset >= shown[0] && offset <= shown[1]) return;
  hover.hidden = true;
  if (offset >= 0 && !event.buttons) resting = setTimeout(() => show_hover(offset), REST_MS);
});
text.addEventListener("mouseleave", ({ relatedTarget }) => {
  clearTimeout(resting);
  if (!hover.contains(relatedTarget)) hover.hidden = true;
});
hover.addEventListener("mouseleave", () => { hover.hidden = !hover.querySelector(":focus"); });

const define = async () => {
  const [found] = await ask("definition", { position: position(text.selectionStart) }) ?? [];
  if (found) page.go_to(name_of(found.uri), found.range.start, found.range.end);
  else page.tell("nothing is defined by a name here");
};
const rename = async () => {
  const at = { position: position(text.selectionStart) };
  const range = await ask("prepareRename", at);
  if (!range) return page.tell("there is no name here that can be changed");
  const [start, end] = [range.start, range.end].map((each) => offset_of(text.value, each));
  naming.value = text.value.slice(start, end).replace(/^["']|["']$/g, "");
  place(naming, start);
  naming.select();
  naming.onkeydown = async (event) => {
    if (!["Enter", "Escape"].includes(event.key)) return;
    event.preventDefault();
    text.focus();
    if (event.key === "Escape") return;
    try {
      const { changes } = await ask("rename", { ...at, newName: naming.value });
      for (const [uri, edits] of Object.entries(changes)) {
        const name = name_of(uri);
        let content = name === page.tab() ? text.value : page.view.files.get(name);
        if (name === page.tab()) apply(edits, content, write);
        else if (typeof content === "string") {
          apply(edits, content, (from, to, words) => { content = content.slice(0, from) + words + content.slice(to); });
          page.view.put(name, content);
        }
      }
    } catch (error) {
      page.tell(error.message);
    }
  };
};
naming.onblur = () => { naming.hidden = true; };
const format = async () => apply(await ask("formatting", { options: { tabSize: 4, insertSpaces: true } }) ?? [], text.value, write);

const commands = { "Control+ ": complete, "Control+Shift+ ": sign, "Control+.": () => page.mend(), F2: rename, F12: define, "Alt+Shift+F": format, Escape: hide };
const in_list = {
  ArrowDown: () => { isChosen = true; choose(chosen + 1); },
  ArrowUp: () => { isChosen = true; choose(chosen - 1); },
  Enter: () => accept(items[chosen]),
  Tab: () => accept(items[chosen]),
};
text.addEventListener("keydown", (event) => {
  const held = ["Control", "Meta", "Alt", "Shift"].filter((name) => event.getModifierState(name));
  const key = [...held, event.key].join("+");
  // In a script, Enter ends a line, unless an arrow has chosen: the name may be its own.
  const isMeant = isNow(offered) && (key !== "Enter" || isChosen || !page.tab().endsWith(".rhai"));
  const command = (!completion.hidden && isMeant && in_list[key]) || commands[key];
  if (!command || event.isComposing) return;
  event.preventDefault();
  command();
});
text.addEventListener("click", (event) => { hide(); if (event.ctrlKey || event.metaKey) define(); });
text.addEventListener("blur", ({ relatedTarget }) => { if (!hover.contains(relatedTarget)) hide(); });
text.addEventListener("scroll", hide);
document.addEventListener("selectionchange", () => {
  if (completion.hidden ? signed.length && !isNow(signed) : !isNow(offered)) hide();
});
