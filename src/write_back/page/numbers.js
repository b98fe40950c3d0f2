// Numbers, colors, switches and texts of a panel.

export const get = (id) => document.getElementById(id);
export const element = (name, properties, ...children) => {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
};

// Colors of scene text are linear; those of the browser's picker are sRGB. What is brighter than 1 keeps its strength.
const to_srgb = (x) => x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055;
const to_linear = (x) => x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4;
const strength = (values) => Math.max(1, ...values);
const to_hex = (values) => "#" + values.map((value) =>
  Math.round(255 * to_srgb(Math.max(0, value / strength(values)))).toString(16).padStart(2, "0")).join("");
const of_hex = (text, before) => [1, 3, 5].map((at) =>
  to_linear(parseInt(text.slice(at, at + 2), 16) / 255) * strength(before));

// Choices of a select, and the chosen one.
export const options = (select, names, chosen) => {
  const now = [...select.options].map((option) => option.value);
  if (now.join("\n") !== names.join("\n")) select.replaceChildren(...names.map((name) => new Option(name, name)));
  select.value = chosen;
};

// Numbers of samples that a view may choose.
export const SAMPLES = [1, 4, 16, 64];

// Labels of rows, each group of rows below its title, which folds it. Folded groups stay folded for other rows.
const folded = new Set();
const grouped = (rows, labels) => {
  const groups = new Map();
  rows.forEach(({ group }, at) => groups.set(group, [...(groups.get(group) ?? []), labels[at]]));
  return [...groups].flatMap(([group, own]) => {
    if (!group) return own;
    const box = element("details", { open: !folded.has(group) }, element("summary", { textContent: group }), ...own);
    box.addEventListener("toggle", () => box.open ? folded.delete(group) : folded.add(group));
    return [box];
  });
};

// Rows of a panel, group by group: name, values, whether they are a color, the step of numbers, their least and largest values,
// of which a single number with both has a slider, their text in the manual and unit. `change` gets the name, the values and
// whether the input is over. Inputs are kept while one of them has the focus, so that a drag is not cut off.
export function fields(panel, rows, change) {
  const shape = JSON.stringify(rows.map(({ name, values, unit }) => [name, unit, values.map((value) => typeof value)]));
  if (panel.dataset.shape !== shape) {
    panel.dataset.shape = shape;
    panel.replaceChildren(...grouped(rows, rows.map(({ name, values, is_color, step, limits: ends, text, unit }) => {
      const [min, max] = ends ?? [null, null];
      const limits = { min: min ?? "", max: max ?? "" };
      const inputs = values.map((value) => {
        const type = { number: "number", boolean: "checkbox", string: "text" }[typeof value];
        return element("input", { type, step: step || "any", name, ariaLabel: name, ...limits });
      });
      const read = () => inputs.map((input) =>
        input.type === "checkbox" ? input.checked : input.type === "number" ? input.valueAsNumber : input.value);
      for (const input of inputs) {
        input.addEventListener("input", () => change(name, read(), false));
        input.addEventListener("change", () => {
          // The value that is written, where the field's is none or out of range.
          if (input.type === "number" && Number.isNaN(input.valueAsNumber)) input.value = input.known;
          const value = input.valueAsNumber;
          if (value < (min ?? value)) input.value = min;
          if (value > (max ?? value)) input.value = max;
          input.known = input.value;
          change(name, read(), true);
        });
      }
      const line = element("span", {}, ...inputs, ...(unit ? [element("small", { textContent: unit })] : []));
      if (is_color) {
        const picker = element("input", { type: "color", ariaLabel: `${name}, picker` });
        const pick = (write) => change(name, of_hex(picker.value, read()), write);
        picker.addEventListener("input", () => pick(false));
        picker.addEventListener("change", () => pick(true));
        line.prepend(picker);
      }
      if (values.length === 1 && min !== null && max !== null) {
        const slider = element("input", { type: "range", ...limits, step: "any", ariaLabel: `${name}, slider` });
        const slide = (write) => { inputs[0].value = Number(slider.valueAsNumber.toPrecision(3)); change(name, read(), write); };
        slider.addEventListener("input", () => slide(false));
        slider.addEventListener("change", () => slide(true));
        line.prepend(slider);
      }
      // Long words break behind their underscores.
      const label = element("label", { title: (text ?? "").replaceAll("`", "") }, name.replaceAll("_", "_\u200b"), line);
      label.dataset.name = name;
      return label;
    })));
  }
  const lines = panel.querySelectorAll("label > span");
  rows.forEach(({ values, is_color }, row) => {
    const line = lines[row];
    const picker = is_color ? line.querySelector("input[type=color]") : null;
    if (picker && picker !== document.activeElement) picker.value = to_hex(values);
    const slider = line.querySelector("input[type=range]");
    if (slider && slider !== document.activeElement) slider.value = values[0];
    const inputs = [...line.querySelectorAll("input")].filter((input) => input !== picker && input !== slider);
    values.forEach((value, index) => {
      const input = inputs[index];
      if (input === document.activeElement) return;
      if (input.type === "checkbox") input.checked = value;
      else input.value = input.known = input.type === "number" ? Number(value.toPrecision(7)) : value;
    });
  });
}

export const are_numbers = (values) => !values.some((value) => Number.isNaN(value));
