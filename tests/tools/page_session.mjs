// A viewer's session in a real browser: opens the page of `reflet preview --serve`, orbits, scrubs, drags a parameter,
// selects, wipes in a second window, breaks and mends the scene. Arguments: the browser, the address of the page, the scene and the module Playwright.
// Prints one line for each step; ends with an error where one fails.
import { readFileSync, writeFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

const [browserPath, address, scenePath, playwright] = process.argv.slice(2);
const { chromium } = await import(pathToFileURL(playwright).href);
const PATIENCE_MS = 60_000;

const browser = await chromium.launch({
  executablePath: browserPath,
  args: ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync"],
});
const page = await browser.newPage({ viewport: { width: 900, height: 700 } });
page.setDefaultTimeout(PATIENCE_MS);
const errors = [];
const requests = [];
page.on("pageerror", (error) => errors.push(String(error)));
page.on("request", (request) => requests.push(request.url()));

// Waits for a lossless picture after the one with this number.
const rest = async (after) => {
  await page.waitForFunction((number) => {
    const { number: shown, kind } = document.getElementById("picture").dataset;
    return kind === "png" && Number(shown) > number;
  }, after);
  return page.evaluate(() => Number(document.getElementById("picture").dataset.number));
};
const pixels = () => page.evaluate(() => document.getElementById("picture").toDataURL());
const step = (text) => console.log(text);
const differs = (a, b, what) => {
  if (a === b) throw new Error(`${what} changed nothing`);
};

await page.goto(address);
let number = await rest(0);
let shown = await pixels();
step("opened");

const box = await page.locator("#picture").boundingBox();
const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
await page.mouse.move(x, y);
await page.mouse.down();
await page.mouse.move(x + 90, y + 10, { steps: 4 });
await page.mouse.up();
number = await rest(number);
let next = await pixels();
differs(shown, next, "orbiting");
shown = next;
step("orbited");

await page.locator("#frame").fill("7");
await page.waitForFunction(() => document.getElementById("told").textContent.startsWith("7 of"));
number = await rest(number);
next = await pixels();
differs(shown, next, "scrubbing");
shown = next;
step("scrubbed");

const parameter = page.locator("#parameters input").first();
await parameter.fill("1.5");
await parameter.press("Enter");
number = await rest(number);
next = await pixels();
differs(shown, next, "the parameter");
const written = Date.now() + PATIENCE_MS;
while (!readFileSync(scenePath, "utf8").includes("height = 1.5")) {
  if (Date.now() > written) throw new Error("the parameter was not written into the scene");
  await page.waitForTimeout(50);
}
step("written");

// The picture stands in the middle of the canvas, with margins; the floor is below its middle.
await page.mouse.click(x, y + 0.05 * box.height);
await page.waitForFunction(() => document.getElementById("label").textContent.includes("floor"));
step("selected");

// A second viewer shares the view: its wipe is seen by both, and a narrow page shows all of its parts.
const second = await browser.newPage({ viewport: { width: 640, height: 700 } });
await second.goto(address);
await second.locator("#wipe").click();
for (const viewer of [page, second]) {
  await viewer.waitForFunction(() => document.getElementById("wipe").getAttribute("aria-pressed") === "true");
  await viewer.locator("#line").waitFor({ state: "visible" });
}
const overflow = await second.evaluate(() => document.documentElement.scrollWidth - innerWidth);
if (overflow > 0) throw new Error(`a page of 640 px is ${overflow} px too wide`);
await second.close();
step("shared");

const text = readFileSync(scenePath, "utf8");
writeFileSync(scenePath, text.replace('kind = "sphere"', 'kind = "spere"'));
await page.waitForFunction(() => document.getElementById("problems").textContent.includes("sphere"));
step("broken");
writeFileSync(scenePath, text);
await page.waitForFunction(() => document.getElementById("problems").hidden);
step("mended");

const refused = await page.request.get(address.replace(/[0-9a-f]{32}/, "0".repeat(32)));
if (refused.status() !== 403) throw new Error(`a wrong token is answered by ${refused.status()}`);
const away = requests.filter((url) => !url.startsWith(address) && !url.startsWith("blob:"));
if (away.length > 0) throw new Error(`requests leave the page: ${away}`);
if (errors.length > 0) throw new Error(errors.join("\n"));
step("refused");
await browser.close();
