// Start of every session in a real browser: its arguments (the browser, the address, a file or a folder, and the module
// Playwright), the browser without traffic of its own, and a line for each step.
import { pathToFileURL } from "node:url";

const [executablePath, address, place, playwright] = process.argv.slice(2);
const { chromium } = await import(pathToFileURL(playwright).href);
const QUIET = ["--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"];

export { address, place };
export const launch = (...more) => chromium.launch({ executablePath, args: [...QUIET, ...more] });
export const step = (text) => console.log(text);
