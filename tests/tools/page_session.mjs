// A viewer's session in a real browser: opens the page of `reflet preview --serve`, orbits, scrubs, drags a parameter,
// selects, wipes in a second window, breaks and mends the scene, whose file is named.
import { readFileSync, writeFileSync } from "node:fs";
import { address, ends, launch, place as scenePath, step, written } from "./session.mjs";

const PATIENCE_MS = 60_000;
const browser = await launch("--disable-gpu");
// A page that waits as long as a busy machine needs.
const viewer_page = async (width) => {
  const viewer = await browser.newPage({ viewport: { width, height: 700 } });
  viewer.setDefaultTimeout(PATIENCE_MS);
  viewer.on("pageerror", (error) => errors.push(String(error)));
  return viewer;
};
const errors = [];
const page = await viewer_page(900);
const requests = [];
page.on("request", (request) => requests.push(request.url()));

const pixels = () => page.evaluate(() => document.getElementById("picture").toDataURL());
// Waits for a value that stays for half a second.
const staying = async (read) => {
  for (let [last, now] = [null, await read()]; ; [last, now] = [now, await read()]) {
    if (`${now}` === `${last}`) return now;
    await page.waitForTimeout(500);
  }
};
// Waits for a lossless picture that stays, so that no picture of an earlier action follows.
const still = () => staying(async () => {
  await page.waitForFunction(() => document.getElementById("picture").dataset.kind === "png");
  return pixels();
});
// Waits until the picture is not this one any more, and stays.
const changed = async (before, what) => {
  await page.waitForFunction((was) => document.getElementById("picture").toDataURL() !== was, before)
    .catch(() => { throw new Error(`${what} changed nothing`); });
  return still();
};
// Presses the button at a place, and drags by pixels.
const hold = async (viewer, [left, top], [right, down], steps = 4) => {
  await viewer.mouse.move(left, top);
  await viewer.mouse.down();
  await viewer.mouse.move(left + right, top + down, { steps });
};

await page.goto(address);
let shown = await still();
step("opened");

const box = await page.locator("#picture").boundingBox();
const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
await hold(page, [x, y], [90, 10]);
await page.mouse.up();
shown = await changed(shown, "orbiting");
// A drag that the system cuts off has ended.
await page.mouse.down();
const is_cut = await page.evaluate(() => {
  const canvas = document.getElementById("picture");
  const held = canvas.style.cursor;
  canvas.dispatchEvent(new PointerEvent("pointercancel"));
  return held === "grabbing" && !canvas.style.cursor;
});
if (!is_cut) throw new Error("a drag goes on after it was cut off");
await page.mouse.up();
step("orbited");

// Keys that the window has too.
await page.locator("#stage").focus();
await page.keyboard.press("h");
await page.locator("#help td", { hasText: "W A S D" }).waitFor();
await page.keyboard.press("h");
if (await page.title() !== "scene \u2013 Reflet") throw new Error(`the title is ${await page.title()}`);
const scrub = () => page.locator("#frame").fill("7");
for (const [act, frame] of [[() => page.keyboard.press("Home"), 0], [() => page.keyboard.press("End"), 9], [scrub, 7]]) {
  await act();
  await page.locator("#told", { hasText: `${frame} of` }).waitFor();
}
shown = await changed(shown, "scrubbing");
step("scrubbed");

const parameter = page.locator("#parameters input").first();
await parameter.fill("1.5");
await parameter.press("Enter");
await changed(shown, "the parameter");
const saved = (part, is_there = true) => written(scenePath, (text) => text.includes(part) === is_there);
await saved("height = 1.5");
step("written");

// The picture stands in the middle of the canvas, with margins; the floor is below its middle.
await page.mouse.click(x, y + 0.05 * box.height);
await page.waitForFunction(() => document.getElementById("label").textContent.includes("floor"));
step("selected");

// Material and place of an item of the outline, by picker, number and arrow.
await page.locator("#items button", { hasText: "ball" }).click();
await page.waitForFunction(() => document.getElementById("label").textContent.includes("ball"));
await page.locator("#materials").selectOption("red");
await page.locator("#material input[name=roughness]").fill("7");
await page.locator("#material input[name=roughness]").press("Enter");
await page.waitForFunction(() => document.querySelector("#material input[name=roughness]").value === "1");
await page.getByLabel("roughness, slider", { exact: true }).fill("0.25");
await saved("roughness = 0.25");
await page.locator("#material input[type=color]").first().fill("#00ff00");
await page.locator("#material input[type=color]").first().dispatchEvent("change");
await saved("base_color = [0, 1, 0]");
// A number that the material lacks is written where it is added, and others that need it appear; their group folds.
await page.locator("#lacking").selectOption({ label: "Clear coat: clearcoat = 0" });
await saved("clearcoat = 0");
await page.locator("#material input[name=clearcoat_roughness]").waitFor();
await page.locator("#material summary", { hasText: "Clear coat" }).click();
await page.locator("#material input[name=clearcoat_roughness]").waitFor({ state: "hidden" });
await page.locator("#items button", { hasText: "lamp" }).click();
await page.waitForFunction(() => document.getElementById("label").textContent.includes("lamp"));
await page.locator("#stage").focus();
await page.keyboard.press("Alt+ArrowRight");
await saved("position = [2.1, 4");
await page.keyboard.press("Control+z");
await saved("position = [2, 4, 3]");
step("changed");

// A click selects the decal that covers the floor; its handles are dragged, and the camera stays.
await page.locator("#camera").selectOption("main");
await page.locator("#items button", { hasText: "floor" }).click();
await page.waitForFunction(() => document.getElementById("label").textContent.includes("floor"));
await page.locator("#samples").selectOption("4");
await page.waitForFunction(() => document.getElementById("count").textContent === "4 shown");
shown = await still();
// Things leave the view and come back; the text keeps them.
for (const does of ["hide", "hide", "solo", "solo"]) {
  await page.getByLabel(`${does} instance ball`).click();
  shown = await changed(shown, does);
}
await page.mouse.click(x - 0.157 * box.height, y + 0.067 * box.height);
await page.waitForFunction(() => document.getElementById("label").textContent.includes("decal sign"));
const pull = async (axis, by, held = async () => {}) => {
  await hold(page, (await ends(page))[axis], by);
  await held();
  await page.mouse.up();
};
// Waits until the first number of the selected item's place is that of the text, or another one.
const at_rest = (viewer, is_so) => viewer.waitForFunction(
  (wanted) => (document.querySelector("#numbers input[name=translation]")?.value === "-1.2") === wanted, is_so);
// Twelve edges of the box and three handles are drawn. A viewer who leaves in a drag takes it back, and nothing is written.
const leaver = await viewer_page(900);
await leaver.goto(address);
for (const viewer of [page, leaver]) await viewer.waitForFunction(() => document.querySelectorAll("#handles line").length === 15);
shown = await still();
await hold(leaver, (await ends(page))[0], [40, 0]);
await at_rest(page, false);
// So does one who leaves while a parameter and a number of a material are changed.
const inputs = { "#parameters input": ["1.2", "1.5"], "#material input[name=roughness]": ["0.8", "0.25"] };
const reads = (which) => page.waitForFunction(
  ([all, index]) => Object.entries(all).every(([at, values]) => Number(document.querySelector(at).value) === Number(values[index])),
  [inputs, which]);
await reads(1);
for (const [at, [value]] of Object.entries(inputs)) {
  await leaver.locator(at).first().evaluate((input, now) => {
    input.value = now;
    input.dispatchEvent(new Event("input", { bubbles: true }));
  }, value);
}
await reads(0);
await leaver.close();
await at_rest(page, true);
await reads(1);
await page.waitForFunction((before) => document.getElementById("picture").toDataURL() === before, shown);
if (!readFileSync(scenePath, "utf8").includes("translation = [-1.2, 0, 0.5]")) throw new Error("a drag without an end was written");
// The numbers follow the handle.
await pull(0, [40, 0], () => at_rest(page, false));
await saved("translation = [-1.2,", false);
if (await page.locator("#camera").inputValue() !== "main") throw new Error("a drag of a handle moved the camera");
await page.locator("#turn").click();
await page.waitForFunction(() => document.querySelectorAll("#handles circle").length === 3);
await pull(1, [0, -40]);
await saved("rotation_deg = [-90, 0, 0]", false);
await page.locator("#undo").click();
await saved("rotation_deg = [-90, 0, 0]");
await page.locator("#undo").click();
await saved("translation = [-1.2, 0, 0.5]");
step("dragged");

// Two viewers take a handle at once: the second has it, and the drag of the first moves neither it nor the camera.
const rival = await viewer_page(900);
await rival.goto(address);
await rival.waitForSelector("#handles polygon, #handles circle");
await page.locator("#move").click();
for (const viewer of [page, rival]) {
  await viewer.waitForSelector("#handles polygon");
  await at_rest(viewer, true); // the undone drag is shown
}
// Place of the first handle, once a page has drawn it twice where it is.
const resting = (viewer) => staying(async () => (await ends(viewer))[0]);
const [here_x, here_y] = await resting(page);
await hold(page, [here_x, here_y], [30, 0], 3);
await at_rest(rival, false);
// The rival takes the handle where it rests on its own page.
await hold(rival, await resting(rival), [10, 0], 2);
await saved("translation = [-1.2,", false);
await page.mouse.move(here_x + 200, here_y + 60, { steps: 4 });
await page.mouse.up();
await rival.mouse.up();
await rival.close();
await page.waitForTimeout(300);
if (await page.locator("#camera").inputValue() !== "main") throw new Error("a drag that another viewer took over moved the camera");
await page.locator("#undo").click();
await page.locator("#undo").click();
await saved("translation = [-1.2, 0, 0.5]");
step("taken");

// Keys of the camera's track: one is added at the current frame, moved by a drag, and deleted.
await page.locator("#items button", { hasText: "camera" }).click();
await page.locator(".track button").first().click();
await page.waitForFunction(() => document.querySelectorAll(".key").length === 3);
const key = await page.locator(".key").nth(1).boundingBox();
const bar = await page.locator(".bar").first().boundingBox();
const middle = [key.x + key.width / 2, key.y + key.height / 2];
await hold(page, middle, [bar.x + (2 / 9) * bar.width - middle[0], 0], 3);
await page.mouse.up();
await saved("at_s = 0.083");
await page.keyboard.press("Delete");
await page.waitForFunction(() => document.querySelectorAll(".key").length === 2);
await saved("at_s = 0.083", false);
// A flight in free view replaces them.
await page.locator("#record").click();
await page.locator("#stage").focus();
await page.keyboard.press("ArrowRight");
await saved("[motion.camera.main]\n");
await page.waitForFunction(() => document.getElementById("record").textContent === "record flight");
step("keyed");

// The picture as a file has the size that was asked for.
const [download] = await Promise.all([page.waitForEvent("download"), page.locator("#screenshot").click()]);
const png = readFileSync(await download.path());
const size = [png.readUInt32BE(16), png.readUInt32BE(20)];
if (download.suggestedFilename() !== "scene.png" || size.join() !== "96,54") {
  throw new Error(`${download.suggestedFilename()} has ${size}`);
}
step("downloaded");

// A second viewer shares the view: its wipe is seen by both, and a narrow page shows all of its parts.
const second = await viewer_page(640);
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
await page.locator(`#problems a[href^="vscode://file${scenePath}:"]`).first().waitFor();
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
