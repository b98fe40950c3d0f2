// Start of every session in a real browser: its arguments (the browser, the address, a file or a folder, and the module
// Playwright), the browser without traffic of its own, and a line for each step.
import { readFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

const [executablePath, address, place, playwright] = process.argv.slice(2);
const { chromium } = await import(pathToFileURL(playwright).href);
const QUIET = ["--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"];

export { address, place };
export const launch = (...more) => chromium.launch({ executablePath, args: [...QUIET, ...more] });
export const step = (text) => console.log(text);
// Waits until the text of a file is as wanted.
export const written = async (file, holds, until = Date.now() + 60_000) => {
  for (let text; !holds(text = readFileSync(file, "utf8"));) {
    if (Date.now() > until) throw new Error(`${file}: ${text}`);
    await new Promise((done) => setTimeout(done, 20));
  }
};
// Places of the ends of the handles on a page.
export const ends = (viewer) => viewer.evaluate(() => {
  const { left, top } = document.getElementById("handles").getBoundingClientRect();
  const lines = [...document.querySelectorAll("#handles line[stroke-width='2']")];
  return lines.map(({ x2, y2 }) => [left + x2.baseVal.value, top + y2.baseVal.value]);
});
