// Drags of the picture: the camera goes around its target, and closer by the wheel. Where the drag ends, its place is written
// into the text. What lies over the picture may be dragged instead.
const TURN_PER_PX = 0.008;
const REST_MS = 400;
// Way of the pointer up to which a press is a click.
const CLICK_PX = 3;

const sum = (a, b, by = 1) => a.map((x, at) => x + by * b[at]);
const dot = (a, b) => a.reduce((all, x, at) => all + x * b[at], 0);
const cross = ([a, b, c], [x, y, z]) => [b * z - c * y, c * x - a * z, a * y - b * x];
const unit = (a) => a.map((x) => x / Math.hypot(...a));
// Turns a vector about an axis, a unit vector (Rodrigues' formula).
const turned = (v, axis, angle) => {
  const [sine, cosine] = [Math.sin(angle), Math.cos(angle)];
  const along = axis.map((x) => x * dot(axis, v) * (1 - cosine));
  return sum(sum(v.map((x) => x * cosine), cross(axis, v), sine), along);
};

// Place of a camera after turns about its target by angles; near the poles of `up` it stops.
export const orbited = ({ eye, target, up }, across, down) => {
  const axis = unit(up);
  const arm = turned(sum(eye, target, -1), axis, across);
  const tilted = turned(arm, unit(cross(axis, arm)), down);
  const isUpright = Math.abs(dot(unit(tilted), axis)) < 0.995;
  return sum(target, isUpright ? tilted : arm);
};

// Follows the pointer over the picture: `camera` gives the shown camera or tells why there is none, `show` shows it elsewhere, and
// `write` writes its last place. `grab` gives what a press takes hold of, which hears where it is dragged and of the end, and
// `click` hears of presses without a drag.
export const follow = (canvas, { camera, show, write, grab, click }) => {
  let held = null;
  let press = null;
  let timer = 0;
  const move = (eye) => {
    held.eye = eye;
    show(held.name, eye);
  };
  canvas.onpointerdown = (event) => {
    if (event.button) return;
    press = { at: [event.clientX, event.clientY], grip: grab(event), isDrag: false };
    canvas.setPointerCapture(event.pointerId);
  };
  canvas.onpointermove = (event) => {
    const { clientX, clientY, movementX, movementY } = event;
    if (!press || !canvas.hasPointerCapture(event.pointerId)) return;
    if (!press.isDrag && Math.hypot(clientX - press.at[0], clientY - press.at[1]) <= CLICK_PX) return;
    // The camera is asked for once in a drag, which tells once that there is none.
    if (!press.isDrag && !press.grip) held ??= camera();
    press.isDrag = true;
    if (press.grip) press.grip.drag(event);
    else if (held) move(orbited(held, -movementX * TURN_PER_PX, -movementY * TURN_PER_PX));
  };
  const end = () => {
    clearTimeout(timer);
    if (held) write(held.name, held.eye);
    held = null;
  };
  canvas.onpointerup = (event) => {
    if (press && !press.isDrag) click(event);
  };
  canvas.onlostpointercapture = () => {
    if (press?.isDrag) press.grip?.drop();
    press = null;
    end();
  };
  canvas.onwheel = (event) => {
    event.preventDefault();
    if (!(held ??= camera())) return;
    const closer = Math.exp(Math.max(-200, Math.min(200, event.deltaY)) * 0.002);
    move(sum(held.target, sum(held.eye, held.target, -1), closer));
    clearTimeout(timer);
    timer = setTimeout(end, REST_MS);
  };
};
