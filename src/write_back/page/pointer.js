// The pointer on a picture, as messages: drags orbit or take hold of a handle, pan and look around, the wheel comes closer, a click
// selects. Drags tell parts of the picture's height.
import { is_inside, place_in } from "./handles.js";

const KINDS = ["drag", "pan", "look"];
// Way of the pointer up to which a press is a click.
const CLICK_PX = 3;
// Scrolled length of a notch of the wheel, in each unit that browsers tell, and most notches at a time.
const [NOTCH, MOST_NOTCHES] = [[100, 3, 1], 2];

export const begin_pointer = (canvas, send) => {
  // Moves are gathered and sent once for each picture of the screen.
  let drag = null;
  let gathered = [0, 0];
  let waits = false;
  const tell = (held) => {
    waits = false;
    const { kind, from, to } = held;
    // Drags with the main button tell where they began and where they are: they may have taken hold of a handle.
    if (kind === "drag") send({ do: kind, from, to, by: gathered, start: !held.is_sent });
    else send({ do: kind, by: gathered });
    held.is_sent = true;
    gathered = [0, 0];
    if (held.is_over) send({ do: "drop", from });
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    canvas.style.cursor = "grabbing";
    const from = place_in(canvas, event);
    drag = { kind: KINDS[event.button], from, to: from, at: [event.clientX, event.clientY], length: 0 };
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!drag?.kind) return;
    const by = [event.clientX - drag.at[0], event.clientY - drag.at[1]];
    drag.at = [event.clientX, event.clientY];
    drag.to = place_in(canvas, event);
    drag.length += Math.hypot(...by);
    if (drag.length <= CLICK_PX) return;
    gathered = gathered.map((sum, axis) => sum + by[axis] / canvas.clientHeight);
    if (waits) return;
    waits = true;
    const held = drag;
    requestAnimationFrame(() => tell(held));
  });
  const end = () => {
    if (drag?.kind && drag.length > CLICK_PX) {
      drag.is_over = true;
      if (!waits) send({ do: "drop", from: drag.from });
    }
    drag = null;
    canvas.style.cursor = "";
  };
  canvas.addEventListener("pointerup", (event) => {
    const at = place_in(canvas, event);
    if (drag?.kind === "drag" && drag.length <= CLICK_PX) {
      send(is_inside(at) ? { do: "pick", at } : { do: "press", action: "unpick" });
    }
    end();
  });
  // The system may cut a drag off, as by a gesture of its own.
  canvas.addEventListener("pointercancel", end);
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    const notches = -event.deltaY / NOTCH[event.deltaMode];
    if (notches) send({ do: "dolly", notches: Math.max(-MOST_NOTCHES, Math.min(MOST_NOTCHES, notches)) });
  }, { passive: false });
};
