// The picture of a page: one side, or two on the sides of a line that each viewer moves; and the legends of their colors.
import { element } from "./numbers.js";

export const begin_picture = (canvas) => {
  const line = element("input", { id: "line", type: "range", min: 0, max: 1, step: 0.001, value: 0.5, ariaLabel: "wipe line", hidden: true });
  const legend = element("p", { id: "legend", role: "note" });
  canvas.after(line, legend);
  const sides = [null, null];
  const paint = () => {
    const [left, right] = sides;
    if (!left) return;
    const { width, height } = left;
    if (canvas.width !== width || canvas.height !== height) {
      Object.assign(canvas, { width, height });
      canvas.dispatchEvent(new Event("resized"));
    }
    const context = canvas.getContext("2d");
    context.drawImage(left, 0, 0);
    if (line.hidden || !right) return;
    const x = Math.round(line.value * width);
    context.save();
    context.beginPath();
    context.rect(x, 0, width - x, height);
    context.clip();
    context.drawImage(right, 0, 0, width, height);
    context.restore();
    context.fillStyle = "#fff";
    context.fillRect(x - 1, 0, 2, height);
  };
  line.addEventListener("input", paint);
  return {
    paint,
    line_at: () => line.value,
    show: (side, image) => {
      sides[side] = image;
      paint();
    },
    wipe: (is_on) => {
      line.hidden = !is_on;
      paint();
    },
    // Legends of the sides, named by their methods where there are two.
    explain: (told) => {
      const all = told.filter((side) => side.legend).map((side) => told[1] ? `${side.method}: ${side.legend}` : side.legend);
      legend.textContent = all.join("\n");
    },
  };
};
