// Keys of tracks below the timeline: dragged, added by + or a double click, deleted; a click selects one and goes there.
import { element, get as $ } from "./numbers.js";

// The page: functions that send what the viewer does, and that give the scene and the frame; and, where it records flights, a
// function that presses keys.
let page = null;
let tracks = [];
let selected_key = null;
let dragged_key = null;

const of_key = ({ kind, name, key }, change) => page.send({ do: "key", kind, name, key, change });
const same_track = (a, b) => a.kind === b.kind && a.name === b.name && a.key === b.key;
const selected_track = () => selected_key && tracks.find((track) => same_track(track, selected_key.track));
const in_seconds = () => $("unit").value === "seconds";
const frames_per_second = () => page.scene().timeline[2];

// Whole frames, or hundredths of a second.
function snapped(at_s) {
  const rate = in_seconds() ? 100 : frames_per_second();
  return Math.max(0, Math.round(at_s * rate) / rate);
}

function time_at(event, bar) {
  const box = bar.getBoundingClientRect();
  const [start, end, fps] = page.scene().timeline;
  const share = Math.min(1, Math.max(0, (event.clientX - box.left) / box.width));
  return snapped((start + share * Math.max(1, end - start)) / fps);
}

function place_key(button, at_s) {
  const [start, end, fps] = page.scene().timeline;
  const share = (at_s * fps - start) / Math.max(1, end - start);
  button.style.left = `${100 * share}%`;
  button.hidden = share < 0 || share > 1;
}

function key_button(track, index, bar) {
  const at_s = track.at_s[index];
  const is_selected = selected_key && same_track(selected_key.track, track) && selected_key.index === index;
  const button = element("button", {
    className: "key", ariaPressed: String(Boolean(is_selected)),
    ariaLabel: `${track.key} at ${at_s.toFixed(3)} s`, title: "drag moves it, Delete deletes it",
  });
  place_key(button, at_s);
  button.addEventListener("pointerdown", (event) => {
    button.setPointerCapture(event.pointerId);
    dragged_key = { from: event.clientX, to_s: at_s, moves: false };
  });
  button.addEventListener("pointermove", (event) => {
    if (!dragged_key) return;
    dragged_key.moves ||= Math.abs(event.clientX - dragged_key.from) > 3;
    if (dragged_key.moves) place_key(button, dragged_key.to_s = time_at(event, bar));
  });
  button.addEventListener("pointerup", () => {
    const { moves, to_s } = dragged_key;
    dragged_key = null;
    selected_key = { track, index, at_s: moves ? to_s : at_s };
    if (moves && Math.abs(to_s - at_s) > 1e-6) of_key(track, { move: [index, to_s] });
    if (!moves) page.send({ do: "seek", frame: Math.round(at_s * frames_per_second()) });
    show_tracks();
  });
  button.addEventListener("pointercancel", () => { dragged_key = null; show_tracks(); });
  button.addEventListener("click", () => { selected_key ??= { track, index, at_s }; show_tracks(); });
  return button;
}

function show_tracks() {
  const has_time = Boolean(page.scene()?.timeline);
  $("keys").hidden = !has_time || !page.press && !tracks.length;
  if (dragged_key || !has_time) return;
  $("tracks").replaceChildren(...tracks.map((track) => {
    const label = `${track.name}.${track.key}`;
    const bar = element("div", { className: "bar" });
    bar.append(...track.at_s.map((_, index) => key_button(track, index, bar)));
    bar.addEventListener("dblclick", (event) => {
      if (event.target === bar) of_key(track, { add: time_at(event, bar) });
    });
    const add = element("button", { textContent: "+", title: "a key at the current frame", ariaLabel: `add a key to ${label}` });
    add.addEventListener("click", () => of_key(track, { add: page.frame() / frames_per_second() }));
    return element("div", { className: "track" }, add, element("span", { textContent: label, title: label }), bar);
  }));
  const track = selected_track();
  const at_s = track ? track.at_s[selected_key.index] : undefined;
  $("selected-key").hidden = at_s === undefined;
  if (at_s !== undefined && $("key-time") !== document.activeElement) {
    $("key-time").value = Number((in_seconds() ? at_s : at_s * frames_per_second()).toFixed(3));
  }
}

function show_keys(next, records) {
  tracks = next;
  // The selected key stays selected where keys before it come and go.
  const found = selected_track()?.at_s.findIndex((at_s) => Math.abs(at_s - selected_key.at_s) < 5e-4) ?? -1;
  if (found >= 0) selected_key.index = found;
  if (page.press) $("record").textContent = records ? "end flight" : "record flight";
  $("record")?.setAttribute("aria-pressed", String(records));
  show_tracks();
}

function delete_key() {
  const track = selected_track();
  if (!track || track.at_s[selected_key.index] === undefined) return false;
  of_key(track, { delete: selected_key.index });
  selected_key = null;
  show_tracks();
  return true;
}

export const is_field = (target) => ["SELECT", "TEXTAREA"].includes(target.tagName)
  || (target.tagName === "INPUT" && !["range", "checkbox"].includes(target.type));

export const begin_keys = (box, given) => {
  page = given;
  const record = element("button", { id: "record", textContent: "record flight", title: "fly while the timeline plays: keys of this camera" });
  const time = element("label", {}, "key at ", element("input", { id: "key-time", type: "number", step: "any" }));
  box.append(
    element("div", { id: "key-bar" }, ...(page.press ? [record] : []),
      element("select", { id: "unit", ariaLabel: "unit of times" }, new Option("frames"), new Option("seconds")),
      element("span", { id: "selected-key", hidden: true }, time, " ", element("button", { id: "key-delete", title: "Delete", textContent: "delete" }))),
    element("div", { id: "tracks", ariaLabel: "keys of the selected item, else of the camera" }),
  );
  $("key-time").addEventListener("change", ({ target }) => {
    const track = selected_track();
    if (!track || Number.isNaN(target.valueAsNumber)) return;
    const at_s = in_seconds() ? target.valueAsNumber : target.valueAsNumber / frames_per_second();
    selected_key.at_s = at_s;
    of_key(track, { move: [selected_key.index, at_s] });
  });
  $("key-delete").addEventListener("click", delete_key);
  $("unit").addEventListener("change", show_tracks);
  record.addEventListener("click", () => page.press("record"));
  addEventListener("keydown", (event) => {
    const is_held = event.ctrlKey || event.metaKey || event.altKey;
    if (event.key === "Delete" && !is_held && !is_field(event.target) && delete_key()) event.preventDefault();
  });
  return { show: show_keys, paint: show_tracks };
};
