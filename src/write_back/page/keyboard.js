// The keyboard of a picture, as messages: presses that the program lists, arrows that orbit while the picture has the focus, keys
// that fly as long as they are down, and the list of all keys.
import { element, get } from "./numbers.js";

const STEP = 0.03;
const MOVES = {
  ArrowLeft: { do: "orbit", by: [-STEP, 0] }, ArrowRight: { do: "orbit", by: [STEP, 0] },
  ArrowUp: { do: "orbit", by: [0, -STEP] }, ArrowDown: { do: "orbit", by: [0, STEP] },
  "+": { do: "dolly", notches: 1 }, "-": { do: "dolly", notches: -1 },
};
// Keys that fly: right, up, forward; how much faster they do with Shift, and the most seconds of a step.
const FLIGHTS = { a: [-1, 0, 0], d: [1, 0, 0], e: [0, 1, 0], q: [0, -1, 0], s: [0, 0, -1], w: [0, 0, 1] };
const [FASTER, MOST_STEP_S] = [4, 0.25];
// Keys that buttons, switches and sliders have a use for.
const OF_CONTROLS = /^( |Enter|Arrow|Home|End|Page|\+|-)/;
const CONTROLS = ["INPUT", "BUTTON", "SUMMARY", "A"];

// `stage` is the picture, `counts` says whether keys at an element are for it, and `save` saves the shown picture.
export const begin_keyboard = ({ stage, send, counts, save }) => {
  const table = element("table");
  const help = element("dialog", { id: "help", ariaLabel: "keys" }, table);
  document.body.append(help);
  const show_help = () => help.open ? help.close() : help.showModal();
  get("keys-of-page").addEventListener("click", show_help);
  const own = { help: show_help, screenshot: save };

  let actions = new Map();
  const action_of = ({ key, ctrlKey, metaKey, shiftKey, altKey }) => {
    const held = [[ctrlKey || metaKey, "Ctrl"], [altKey, "Alt"], [shiftKey, "Shift"]].filter(([is_down]) => is_down);
    return actions.get([...held.map(([, name]) => name), key.length === 1 ? key.toUpperCase() : key].join("+"));
  };

  const flying = new Set();
  let [flown, speed] = [null, 1];
  const fly = (now) => {
    if (flying.size === 0) { flown = null; return; }
    const seconds = flown === null ? 1 / 60 : Math.min(MOST_STEP_S, (now - flown) / 1000);
    const by = [0, 1, 2].map((axis) => [...flying].reduce((sum, key) => sum + FLIGHTS[key][axis], 0));
    flown = now;
    send({ do: "fly", by, seconds: seconds * speed });
    requestAnimationFrame(fly);
  };
  const start_flight = (key) => {
    if (flying.size === 0) requestAnimationFrame(fly);
    flying.add(key);
  };
  addEventListener("keyup", ({ key, shiftKey }) => {
    flying.delete(key.toLowerCase());
    speed = shiftKey ? FASTER : 1;
  });
  addEventListener("blur", () => flying.clear());
  addEventListener("focusin", (event) => counts(event.composedPath()[0]) || flying.clear());

  addEventListener("keydown", (event) => {
    const [target, key] = [event.composedPath()[0], event.key.toLowerCase()];
    const action = action_of(event);
    // The list of keys closes by its own key or Esc; F12 and Alt are no input of fields.
    if (help.open ? own[action] !== show_help : !counts(target) && !event.altKey && own[action] !== save) return;
    const is_held = event.ctrlKey || event.metaKey || event.altKey;
    speed = event.shiftKey ? FASTER : 1;
    if (!is_held && FLIGHTS[key]) return start_flight(key);
    if (!is_held && CONTROLS.includes(target.tagName) && OF_CONTROLS.test(event.key)) return;
    const move = target === stage && !is_held && MOVES[event.key];
    if (!move && action === undefined) return;
    event.preventDefault();
    if (move) send(move);
    else if (own[action]) own[action]();
    else send({ do: "press", action });
  });
  return {
    show: ({ presses, help: rows }) => {
      actions = new Map(presses);
      table.replaceChildren(...rows.map((row) => element("tr", {}, ...row.map((textContent) => element("td", { textContent })))));
    },
  };
};
