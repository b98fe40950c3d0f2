// The picture of a page, and the handles over it: drawn where `handles` places them, in parts of the picture.
import { get } from "./numbers.js";

const COLORS = ["#eb5046", "#6ec846", "#508cfa"];
export const KINDS = ["move", "turn", "scale"];
// Place of the picture on the page: its canvas shows it with margins.
const box_of = (canvas) => {
  const box = canvas.getBoundingClientRect();
  const scale = Math.min(box.width / canvas.width, box.height / canvas.height);
  const [width, height] = [canvas.width * scale, canvas.height * scale];
  return { left: box.left + (box.width - width) / 2, top: box.top + (box.height - height) / 2, width, height };
};

// Place of a pointer in the picture, 0 to 1 inside of it.
export const place_in = (canvas, event) => {
  const { left, top, width, height } = box_of(canvas);
  return [(event.clientX - left) / width, (event.clientY - top) / height];
};
export const is_inside = (place) => place.every((part) => part >= 0 && part <= 1);

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

// Handles over a canvas, drawn into an SVG element in its box; `send` hears which kind is chosen in the panels.
export const begin_handles = (canvas, over, send) => {
  let shown = null;
  const paint = () => {
    over.replaceChildren();
    if (!shown) return;
    const { left, top, width, height } = box_of(canvas);
    const around = over.parentElement.getBoundingClientRect();
    Object.assign(over.style, { left: `${left - around.left}px`, top: `${top - around.top}px`, width: `${width}px`, height: `${height}px` });
    const place = ([x, y]) => [x * width, y * height];
    const line = (from, to, color, wide) => shape("line", { x1: from[0], y1: from[1], x2: to[0], y2: to[1], stroke: color, "stroke-width": wide });
    for (const [from, to] of shown.edges) over.append(line(place(from), place(to), "#ff9620", 1));
    if (!shown.drawn) return;
    const start = place(shown.drawn.start);
    shown.drawn.ends.forEach((end, axis) => {
      const to = place(end);
      over.append(line(start, to, COLORS[axis], 2), mark(shown.kind, COLORS[axis], to, start, shown.mark * height));
    });
  };
  const show = (next) => {
    shown = next;
    for (const kind of KINDS) {
      get(kind).hidden = !shown.kinds.includes(kind);
      get(kind).setAttribute("aria-pressed", String(shown.kind === kind));
    }
    paint();
  };
  for (const kind of KINDS) get(kind).addEventListener("click", () => send({ do: "handles", kind }));
  new ResizeObserver(paint).observe(canvas);
  canvas.addEventListener("resized", paint);
  return { show };
};
