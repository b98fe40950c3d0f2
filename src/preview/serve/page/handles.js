"use strict";
// Handles over the picture: drawn where the server places them, and dragged there.
const COLORS = ["#eb5046", "#6ec846", "#508cfa"];
const KINDS = ["move", "turn", "scale"];
let handles = null;

const shape = (name, attributes) => {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
};

// An end of a handle: an arrow head, a circle or a square.
function mark(kind, color, [x, y], [from_x, from_y], size) {
  if (kind === "turn") return shape("circle", { cx: x, cy: y, r: size / 2, stroke: color, fill: "none" });
  if (kind === "scale") return shape("rect", { x: x - 0.4 * size, y: y - 0.4 * size, width: 0.8 * size, height: 0.8 * size, fill: color });
  const length = Math.hypot(x - from_x, y - from_y) || 1;
  const [along_x, along_y] = [(x - from_x) / length * size, (y - from_y) / length * size];
  const corner = (side) => `${x - along_x - side * along_y / 2},${y - along_y + side * along_x / 2}`;
  return shape("polygon", { points: `${x},${y} ${corner(1)} ${corner(-1)}`, fill: color });
}

function paint_handles() {
  const over = $("handles");
  over.replaceChildren();
  if (!handles) return;
  const { left, top, width, height } = picture_box();
  const stage = $("stage").getBoundingClientRect();
  Object.assign(over.style, { left: `${left - stage.left}px`, top: `${top - stage.top}px`, width: `${width}px`, height: `${height}px` });
  const place = ([x, y]) => [x * width, y * height];
  const line = (from, to, color, wide) => shape("line", { x1: from[0], y1: from[1], x2: to[0], y2: to[1], stroke: color, "stroke-width": wide });
  for (const [from, to] of handles.edges) over.append(line(place(from), place(to), "#ff9620", 1));
  if (!handles.drawn) return;
  const start = place(handles.drawn.start);
  handles.drawn.ends.forEach((end, axis) => {
    const to = place(end);
    over.append(line(start, to, COLORS[axis], 2), mark(handles.kind, COLORS[axis], to, start, handles.mark * height));
  });
}

function show_handles(next) {
  handles = next;
  for (const kind of KINDS) {
    $(kind).hidden = !handles.kinds.includes(kind);
    $(kind).setAttribute("aria-pressed", String(handles.kind === kind));
  }
  paint_handles();
}

for (const kind of KINDS) $(kind).addEventListener("click", () => send({ do: "handles", kind }));
new ResizeObserver(paint_handles).observe($("stage"));
