// Choices of a view: camera, method and shown channel of each side, the wipe, and the number of samples.
import { element, get, options, SAMPLES } from "./numbers.js";

const select = (label, id, choose) =>
  element("label", {}, `${label} `, element("select", { id, onchange: ({ target }) => choose(target.value) }));

// Choice of a camera or method that is left to the text. As other names in parentheses, it is sent as none.
export const AS_WRITTEN = "(as written)";
const named = (value) => value.startsWith("(") ? null : value;

export const begin_choices = (box, send) => {
  const side = (at) => [
    select(at ? "right" : "method", `method${at}`, (value) => send({ do: "method", side: at, name: named(value) })),
    select("shows", `channel${at}`, (name) => send({ do: "channel", side: at, name })),
  ];
  const press_wipe = () => send({ do: "press", action: "wipe" });
  box.append(
    select("camera", "camera", (value) => send({ do: "camera", name: named(value) })), ...side(0),
    element("button", { id: "wipe", textContent: "wipe", title: "B", ariaPressed: "false", onclick: press_wipe }),
    element("span", { id: "right", hidden: true }, ...side(1)),
    select("samples", "samples", (value) => send({ do: "samples", count: Number(value) || null })),
  );
  get("samples").append(new Option("as written", ""), ...SAMPLES.map((count) => new Option(count)));
  return {
    // The names to choose from and, for each side, the chosen method and channel.
    show: ({ cameras, camera, methods, channels, sides, wipe, samples }) => {
      options(get("camera"), cameras, camera ?? AS_WRITTEN);
      sides.forEach(([method, channel], at) => {
        options(get(`method${at}`), methods, method ?? AS_WRITTEN);
        options(get(`channel${at}`), channels, channel);
      });
      get("wipe").setAttribute("aria-pressed", String(wipe));
      get("right").hidden = !wipe;
      get("samples").value = samples ?? "";
    },
  };
};
