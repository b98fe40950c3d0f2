// The timeline of a page: steps, playback, a slider of frames, and the frame in words.
import { element } from "./numbers.js";

export const begin_timeline = (box, send) => {
  const press = (action) => () => send({ do: "press", action });
  const button = (id, textContent, title, action) => element("button", { id, textContent, title, onclick: press(action) });
  const play = button("play", "play", "Space", "play");
  const loop = element("input", { id: "loop", type: "checkbox", onchange: press("loop") });
  const slider = element("input", {
    id: "frame", type: "range", step: "1", ariaLabel: "frame",
    oninput: () => send({ do: "seek", frame: slider.valueAsNumber }),
  });
  const told = element("output", { id: "told" });
  box.prepend(
    button("back", "<", "left arrow on the slider", { step: -1 }), play, button("on", ">", "right arrow on the slider", { step: 1 }),
    element("label", {}, loop, " loop"), slider, told,
  );
  return {
    slider, told,
    // Shows the chosen frame, which a drag of the slider sets by itself, and tells `shown`, or else the same.
    show: ({ timeline, frame, shown = frame, plays, loops }) => {
      box.hidden = !timeline;
      if (!timeline) return;
      const [start, end, fps] = timeline;
      [slider.min, slider.max] = [start, end];
      if (plays || slider !== slider.getRootNode().activeElement) slider.value = frame;
      told.textContent = `${shown} of ${end}, ${(shown / fps).toFixed(3)} s`;
      play.textContent = plays ? "pause" : "play";
      loop.checked = loops;
    },
  };
};
