// Panels of what is selected, its material, the script's parameters and the outline of the scene. They keep nothing of the scene:
// `send` hears what a user does there.
import { are_numbers, element, fields, get, options } from "./numbers.js";
import { KINDS } from "./handles.js";

const panel = (id, title, ...inside) => element("section", { id }, element("h2", { textContent: title }), ...inside);

export const begin_panels = (box, send) => {
  const kinds = KINDS.map((kind) => element("button", { id: kind, textContent: kind, title: "handles over the picture", hidden: true }));
  box.append(
    panel("parameters-panel", "Script parameters", element("div", { id: "parameters" })),
    panel("selection-panel", "Selection", element("p", { id: "label" }), element("div", { id: "numbers" }), element("p", { id: "kinds" }, ...kinds)),
    panel("material-panel", "Material", element("select", { id: "materials", ariaLabel: "material" }), element("p", { id: "origin" }), element("div", { id: "material" }), element("select", { id: "lacking", ariaLabel: "add a number to the material" })),
    panel("items-panel", "Scene", element("ul", { id: "items" })),
  );
  get("parameters-panel").hidden = get("material-panel").hidden = true;
  get("materials").addEventListener("change", ({ target }) =>
    send({ do: "material", row: target.selectedIndex > 0 ? target.selectedIndex - 1 : null }));
  let lacking = [];
  get("lacking").addEventListener("change", ({ target }) => {
    const { name: key, values } = lacking[target.selectedIndex - 1];
    target.selectedIndex = 0;
    send({ do: "material_number", key, values, write: true });
  });
  // Row of the selected item in the outline, and its button.
  let [row, marked] = [null, null];
  const mark = () => {
    const button = row === null ? null : get("items").children[row]?.firstChild;
    if (button === marked) return;
    marked?.removeAttribute("aria-current");
    button?.setAttribute("aria-current", "true");
    button?.scrollIntoView({ block: "nearest" });
    marked = button;
  };
  const numbers = (kind) => (key, values, write) => {
    if (are_numbers(values)) send({ do: kind, key, values, write });
  };
  return {
    scene: ({ items, materials }) => {
      get("items").replaceChildren(...items.map(([label, depth, left_out], at) => {
        const button = element("button", { textContent: "\u00a0".repeat(2 * depth) + label });
        button.addEventListener("click", () => send({ do: "select", row: at }));
        // Two buttons hide a thing that views can leave out, and show it alone.
        const switches = (left_out ?? []).map((is_on, solo) => {
          const does = ["hide", "solo"][solo];
          const made = element("button", { textContent: does, ariaLabel: `${does} ${label}`, ariaPressed: String(is_on) });
          made.addEventListener("click", () => send({ do: "hide", row: at, solo: Boolean(solo) }));
          return made;
        });
        return element("li", {}, button, ...switches);
      }));
      mark();
      options(get("materials"), ["(none)", ...materials], get("materials").value || "(none)");
      get("material-panel").hidden = materials.length === 0;
    },
    item: (item) => {
      row = item?.row ?? null;
      mark();
      const held = item ? item.held.map(([key, why]) => `${key}: ${why}`) : [];
      get("label").textContent = item
        ? [`${item.label} ${item.place}`, ...held, item.refused || ""].join("\n").trim()
        : "a click on the picture selects";
      fields(get("numbers"), item ? item.numbers : [], numbers("number"));
      const is_held = (name) => Boolean(item?.held.some(([key]) => key === name));
      for (const input of get("numbers").querySelectorAll("input")) input.disabled = is_held(input.closest("label").dataset.name);
    },
    material: (material) => {
      get("materials").selectedIndex = material ? material.row + 1 : 0;
      get("origin").textContent = material ? material.told : "";
      fields(get("material"), material ? material.numbers : [], numbers("material_number"));
      lacking = material?.lacking ?? [];
      get("lacking").hidden = lacking.length === 0;
      const choices = lacking.map(({ name, values, unit, group, text: title }) =>
        Object.assign(new Option(`${group}: ${name} = ${values.join(", ")} ${unit ?? ""}`), { title }));
      get("lacking").replaceChildren(new Option("add \u2026"), ...choices);
    },
    parameters: (parameters) => {
      const rows = parameters.map(({ name, value, integer }) =>
        ({ name, values: Array.isArray(value) ? value : [value], step: integer ? "1" : "any" }));
      get("parameters-panel").hidden = rows.length === 0;
      fields(get("parameters"), rows, (name, values, write) => {
        if (!are_numbers(values)) return;
        const is_list = Array.isArray(parameters.find((own) => own.name === name).value);
        send({ do: "parameter", name, value: is_list ? values : values[0], write });
      });
    },
  };
};
