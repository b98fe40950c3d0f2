// A writer's session in a real browser with the page that runs by itself: mistakes are told at their lines, scenes shown,
// changed, dropped, shared, saved and put into other pages; a lost device, a broken address and a browser without WebGPU are
// told. The folder is for pictures.
import { mkdirSync, readdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { address, ends, launch, place as folder, step } from "./session.mjs";

const PNG = Buffer.from("iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==", "base64");
const PATIENCE_MS = 240_000;
const browser = await launch("--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader");
const open_page = async (from, fragment = "") => {
  const page = await from.newPage({ viewport: { width: 1100, height: 700 } });
  page.setDefaultTimeout(PATIENCE_MS);
  page.on("request", (request) => {
    if (!request.url().startsWith(address) && !request.url().startsWith("blob:")) throw new Error(`${request.url()} is asked for`);
  });
  // Milliseconds from each question to the language server to its answer.
  await page.addInitScript(() => {
    self.waited = [];
    const post = Worker.prototype.postMessage;
    Worker.prototype.postMessage = function (message, ...moved) {
      const [id, began] = [message.rpc && JSON.parse(message.rpc).id, performance.now()];
      const hear = ({ data }) => data.rpc?.includes(`"id":${id},`) && self.waited.push(performance.now() - began);
      if (id) this.addEventListener("message", hear);
      post.call(this, message, ...moved);
    };
  });
  await page.goto(address + fragment);
  return page;
};
const status = (page, pattern) => page.waitForFunction(
  (source) => new RegExp(source).test(document.getElementById("status").textContent), pattern.source);
const picture = (page) => page.evaluate(() => document.getElementById("stage").canvas.toDataURL());
const value = (page) => page.evaluate(() => document.getElementById("text").value);
const has = (page, part, is_so = true) => page.waitForFunction(
  ([part, is_so]) => document.getElementById("text").value.includes(part) === is_so, [part, is_so]);
// Waits for the picture of what is written now.
const shown = (page) => status(page, /^160 × 90 in /);
// Writes, and waits for the messages, which come before the picture: a status that is told later is of this text.
const write = (page, change) => page.evaluate((body) => new Promise((done) => {
  const [text, status, view] = ["text", "status", "stage"].map((id) => document.getElementById(id));
  text.value = new Function("text", `return ${body}`)(text.value);
  view.addEventListener("check", () => done(status.textContent = ""), { once: true });
  text.dispatchEvent(new Event("input"));
}), change);

const began = Date.now();
const page = await open_page(browser);
await page.selectOption("#width", "160");
await shown(page);
console.error(`first picture after ${(Date.now() - began) / 1e3} s`);
const first = await picture(page);

await write(page, "text.replace('roughness = 0.35', 'roughnes = 0.35')");
await page.waitForSelector("#messages .error");
const line = (await value(page)).split("\n").findIndex((row) => row.includes("roughnes ")) + 1;
const marked = await page.locator("#lines .error").textContent();
if (Number(marked) !== line) throw new Error(`line ${marked} is marked, not ${line}`);
await page.click("#messages .error button");
const selected = await page.evaluate(() => { const text = document.getElementById("text"); return text.value.slice(text.selectionStart, text.selectionEnd); });
if (selected !== "roughnes") throw new Error(`a click selects ${selected}`);
step("told");

// Its advice is written by the key at the caret, and by the button.
await page.locator("#text").press("Control+.");
await has(page, "roughness = 0.35");
await page.locator("#text").press("Control+z");
await page.click("#messages .fix");
await has(page, "roughness = 0.35");
await shown(page);
if (await picture(page) !== first) throw new Error("the mended scene looks different");
step("shown");

// The first letters of a key, its value, which is typed over the default one, and the manual under the pointer.
const [x, y] = await page.evaluate(() => {
  const text = document.getElementById("text");
  const before = text.value.slice(0, text.value.indexOf("0.35") + 4);
  text.setSelectionRange(before.length, before.length);
  text.focus();
  const { left, top } = text.getBoundingClientRect();
  return [left + 12, top - 1 + 18 * before.split("\n").length - text.scrollTop];
});
await page.keyboard.type("\nmeta");
await page.waitForSelector("#choice-0[aria-selected=true]");
await page.screenshot({ path: join(folder, "completion.png") });
await page.keyboard.press("Enter");
await page.keyboard.type("0.5");
await page.waitForFunction((old) => document.getElementById("stage").canvas.toDataURL() !== old, first);
if (!(await value(page)).includes("0.35\nmetallic = 0.5\n")) throw new Error("completion writes something else");
// Enter ends a line behind a text that is closed, and where the caret has left the place of the list.
await page.keyboard.type("\nemission = \"#000\"");
await page.keyboard.press("Enter");
await page.keyboard.type("rough");
await page.waitForSelector("#choice-0[aria-selected=true]");
await page.keyboard.press("ArrowLeft");
await page.keyboard.press("Enter");
if (!(await value(page)).includes('"#000"\nroug\nh\n')) throw new Error("Enter takes what is not offered");
for (const key of ["Delete", ...Array(6).fill("Backspace")]) await page.keyboard.press(key);
step("completed");
await page.mouse.move(x, y);
await page.waitForFunction(() => /rough/.test(document.getElementById("hover").textContent));
await page.screenshot({ path: join(folder, "hover.png") });
await write(page, "text.replace('metallic = 0.5\\n', '')");
await shown(page);
step("hinted");

// Saves what the form says.
const fill = async (format, frames = "", aovs = []) => {
  await page.click("#saving summary");
  await page.selectOption("#format", format);
  await page.selectOption("#aovs", aovs);
  await page.fill("#frames", frames);
};
const download = async (from, name) => {
  const [file] = await Promise.all([from.waitForEvent("download"), from.click("#save")]);
  await file.saveAs(join(folder, name));
};
const save = async (name, ...how) => {
  await fill(...how);
  await download(page, name);
};
await save("mirrors.png", "png");
await save("mirrors.exr", "exr", "", ["depth", "ids"]);
step("saved");

await write(page, "text.replace('[0.7, 0.06, 0.04]', '[0.04, 0.7, 0.06]')");
await shown(page);
if (await picture(page) === first) throw new Error("a changed color changes nothing");
step("changed");

// A timeline has a slider, which is played from its end on.
const told_frame = (text) => page.locator("#told", { hasText: text }).waitFor();
const motion = "[timeline]\\nfps = 4\\nend = 3\\n[motion.camera.main]\\nfov_deg = { keys = [{ at_s = 0, value = 55 }, { at_s = 1, value = 80 }] }\\n";
await write(page, `text + '\\n${motion}'`);
await told_frame("0 of 3");
const still = await picture(page);
await page.locator("#frame").fill("3");
await told_frame("3 of 3");
if (await picture(page) === still) throw new Error("the last frame looks like the first");
await page.click("#play");
await told_frame("2 of 3");
await page.click("#play");
// A key of the camera's track is added at the shown frame, moved by its time, and deleted.
const keys = (count) => page.waitForFunction((count) => document.querySelectorAll("#tracks .key").length === count, count);
await page.locator("#frame").fill("1");
await told_frame("1 of 3");
await keys(2);
await page.click("#tracks .track > button");
await keys(3);
await page.locator("#tracks .key").nth(1).click();
await page.fill("#key-time", "2");
await page.press("#key-time", "Enter");
await has(page, "at_s = 0.5");
await page.locator('#tracks [aria-label="fov_deg at 0.500 s"]').click();
await told_frame("2 of 3");
await keys(3);
await page.screenshot({ path: join(folder, "keys.png") });
await page.keyboard.press("Delete");
await keys(2);
await shown(page);
await save("film.zip", "png", "1-2", ["depth"]);
await fill("png", "2-9");
await page.click("#save");
await status(page, /nothing is saved: .*frame 9 is not in the timeline/);
await page.click("#saving summary");
step("played");

// The view's method and samples are chosen beside the text, which stays.
const unchosen = await value(page);
for (const [method, samples, told] of [["path", "4", /4 samples by path,/], ["(as written)", "as written", /by rt,|by hybrid,/]]) {
  await page.selectOption("#method0", method);
  await page.selectOption("#samples", samples);
  await status(page, told);
}
// Depths beside normals: the sides of a wipe, each with the legend of its colors, and a white line between them.
const stage = page.locator("#stage");
await page.selectOption("#channel0", "depth");
await stage.press("b");
await page.selectOption("#channel1", "normal");
await page.locator("#legend", { hasText: /^(rt|hybrid): white: .* m.*\n(rt|hybrid): red, green, blue/ }).waitFor();
await page.waitForFunction(() => document.getElementById("stage").canvas.getContext("2d").getImageData(79, 45, 2, 1).data.every((lane) => lane === 255));
await page.screenshot({ path: join(folder, "wipe.png") });
await stage.press("b");
await page.selectOption("#channel0", "picture");
await page.locator("#legend:empty").waitFor({ state: "attached" });
if (await value(page) !== unchosen) throw new Error("a choice of the view changes the text");
step("chosen");

// A drag of the picture moves the camera, whose place is written into the text where it ends; so does a flight, by a key that the
// list of keys has. Ctrl Z takes both back.
const [eye] = (await value(page)).match(/eye = .*/);
const box = await page.locator("#picture").boundingBox();
const go = (right) => page.mouse.move(box.x + right, box.y + 40);
const fly = [() => stage.press("h"), () => page.locator("#help td", { hasText: "W A S D" }).waitFor(), () => stage.press("h"), () => stage.press("w", { delay: 100 })];
for (const acts of [[() => go(40), () => page.mouse.down(), () => go(90), () => page.mouse.up()], fly]) {
  for (const act of acts) await act();
  await has(page, eye, false);
  await page.locator("#text").press("Control+z");
  await has(page, eye);
}
step("orbited");

// The outline and a click select. Numbers are written where an input ends, in their range; an empty field writes nothing.
const click = (kind) => page.locator("#items button", { hasText: kind }).click();
const labeled = (part) => page.waitForFunction((text) => document.getElementById("label").textContent.includes(text), part);
const writes = async (part) => { await has(page, part); await shown(page); };
const number = async (name, text) => {
  const field = page.locator(`input[type=number][name=${name}]`).first();
  await field.fill(text);
  await field.press("Enter");
};
const unselected = await value(page);
await page.mouse.click(box.x + 0.5 * box.width, box.y + 0.5 * box.height + 0.4 * Math.min(box.height, 9 / 16 * box.width));
await labeled("instance floor");
await click("ball");
await labeled("instance ball");
await number("roughness", "7");
await writes("roughness = 1\n");
await number("roughness", "");
await page.waitForFunction(() => document.querySelector("#material input[type=number][name=roughness]").value === "1");
// Two quick edits are both written, and Ctrl Z takes each back.
await number("translation", "0.5");
await number("scale", "1.5");
await writes("scale = [1.5, 1, 1]");
if (!(await value(page)).includes("[0.5, 0.4, -0.3]")) throw new Error("the first of two edits is lost");
for (const undone of ["scale = [1.5", "[0.5, 0.4", "roughness = 1\n"]) {
  await page.locator("#text").press("Control+z");
  await has(page, undone, false);
}
if (await value(page) !== unselected) throw new Error("undo leaves another text");
// A hidden thing is not seen, and the text stays.
await write(page, "text");
await shown(page);
const with_ball = await picture(page);
for (const isHidden of [true, false]) {
  await page.click('[aria-label="hide instance ball"]');
  await page.waitForFunction(([before, isHidden]) => (document.getElementById("stage").canvas.toDataURL() !== before) === isHidden, [with_ball, isHidden]);
}
if (await value(page) !== unselected) throw new Error("what is hidden changes the text");
step("edited");

// The numbers follow a handle while it is dragged, and the text where it ends.
const place_of_ball = (is_own) => page.waitForFunction(
  (wanted) => (document.querySelector("#numbers input[name=translation]").value === "-0.3") === wanted, is_own);
await place_of_ball(true);
const [[x2, y2]] = await ends(page);
for (const act of [() => page.mouse.move(x2, y2), () => page.mouse.down(), () => page.mouse.move(x2 + 40, y2)]) await act();
await place_of_ball(false);
if (await value(page) !== unselected) throw new Error("a drag is written before its end");
await page.mouse.up();
await page.waitForFunction((text) => document.getElementById("text").value !== text, unselected);
// What a script or a mistake holds says why.
await write(page, "text + '\\nnothing = 1'");
await number("translation", "3");
await status(page, /^not written: the text has changed meanwhile, or has mistakes/);
await click("camera");
await labeled("animates it; change its keys there");
await write(page, JSON.stringify(unselected));
await shown(page);
step("dragged");

// A texture that is not there is told, and found once its folder is added.
await write(page, "text.replace('[material.red]\\n', '[material.red]\\nbase_color_texture = \"maps/dot.png\"\\n')");
await page.waitForFunction(() => document.querySelector("#messages .error")?.textContent.includes("dot.png"));
mkdirSync(join(folder, "maps"), { recursive: true });
writeFileSync(join(folder, "maps", "dot.png"), PNG);
await page.setInputFiles("#folder", join(folder, "maps"));
await shown(page);
// A call in a script shows its signature with the argument at the caret.
const scene_of = await page.locator("#tabs [aria-pressed=true]").textContent();
await page.setInputFiles("#files", { name: "turn.rhai", mimeType: "text/plain", buffer: Buffer.from("") });
await page.locator("#tabs button", { hasText: "turn.rhai" }).click();
await page.locator("#text").pressSequentially('ctx.place("ball", ');
await page.waitForFunction(() => document.querySelector("#hover mark")?.textContent === "position");
await page.screenshot({ path: join(folder, "signature.png") });
await page.locator("#tabs button", { hasText: scene_of }).click();
await shown(page);
step("dropped");

// A pack holds what the scene reads, and opens as it was; packs that are none are refused, and the scene stays.
await save("pack.zip", "zip");
const packed = await value(page);
await page.evaluate(() => document.getElementById("stage").setAttribute("src", "scenes/cornell.toml"));
await has(page, "maps/dot.png", false);
await page.setInputFiles("#files", join(folder, "pack.zip"));
await page.waitForFunction((text) => document.getElementById("text").value === text, packed);
await shown(page);
writeFileSync(join(folder, "bad-noise.zip"), "no pack");
const bad = readdirSync(folder).filter((name) => name.startsWith("bad-"));
for (const name of bad) {
  await page.evaluate(() => document.getElementById("status").textContent = "");
  await page.setInputFiles("#files", join(folder, name));
  await status(page, name === "bad-large.zip" ? /^the pack is refused: its files are longer than 512 MiB/ : /^the pack is refused: /);
  console.error(name, await page.textContent("#status"));
}
if (await value(page) !== packed) throw new Error("a refused pack changes the scene");
step("packed");

await page.click("#share");
await page.waitForFunction(() => location.hash.length > 100);
const written = await value(page);
const other = await open_page(browser, await page.evaluate(() => location.hash));
await other.waitForFunction((text) => document.getElementById("text").value === text, written);
// A scene of an added folder finds what its project has.
const ball = readFileSync(new URL("texts/web/ball.toml", import.meta.url));
for (const [path, content] of Object.entries({ "reflet.toml": 'name = "show"\n', "scenes/ball.toml": ball, "maps/dot.png": PNG })) {
  mkdirSync(join(folder, "show", path, ".."), { recursive: true });
  writeFileSync(join(folder, "show", path), content);
}
await other.setInputFiles("#folder", join(folder, "show"));
await status(other, /^320 × 180 in .* 1 sample by rt,/);
// A new project shows its scene; all of it is replaced by a scene that is typed.
await other.click("#new");
await other.waitForFunction(() => document.querySelector("#tabs [aria-pressed=true]").textContent === "scenes/main.toml");
await status(other, / in .* by rt,/);
await other.click("#share");
await status(other, /^the address holds 4 texts/);
const third = await open_page(browser, await other.evaluate(() => location.hash));
await third.waitForFunction(() => document.querySelectorAll("#tabs button").length === 4);
// A mistake in the file of a project is mended at its place.
await third.locator("#tabs button", { hasText: "reflet.toml" }).click();
await write(third, "text.replace('output =', 'outpu =')");
await third.click("#messages .fix");
await has(third, "\noutput =");
await third.close();
await other.press("#text", "Control+A");
await other.locator("#text").pressSequentially(ball.toString().replace(/^material.*$/m, "material.paint = {}"));
await status(other, /^320 × 180 in .* 1 sample by rt,/);
await other.close();
step("shared");

for (const garbage of ["#%3Cscript%3E", "#AAAA", `#${"x".repeat(1 << 20)}`]) {
  const refusing = await open_page(browser, garbage);
  await refusing.waitForFunction(() => document.getElementById("status").textContent.includes("holds no scene"));
  await refusing.close();
}
step("refused");

// Elements on another page: one turns, one plays in a script's own pictures, one finds a texture beside its scene, and one has no scene.
const host = await browser.newPage({ viewport: { width: 900, height: 700 } });
let programs = 0;
host.on("request", (request) => { programs += request.url().endsWith(".wasm"); });
const element = (attributes) => `<reflet-view width="64" style="float: left; width: 400px" ${attributes}></reflet-view>`;
const bodies = {
  "embed.html": `<!doctype html><script type="module" src="view.js"></script>${element('src="scenes/mirrors.toml" samples="1" auto-rotate="90"')}
    ${element('src="own/my%20ball.toml" camera="near" variant="red" frame="2"')}${element('src="none.toml"')}${element('src="own/my%20ball.toml" camera="far"')}`,
  "own/my%20ball.toml": ball,
  "own/maps/dot.png": PNG,
  "own/reflet.toml": 'name = "own"\n',
};
for (const [path, body] of Object.entries(bodies)) await host.route(address + path, (route) => route.fulfill({ body, contentType: path.endsWith("html") ? "text/html" : undefined }));
await host.goto(`${address}embed.html`);
const view = (at) => `document.querySelectorAll("reflet-view")[${at}]`;
const until = (test) => host.waitForFunction(test, null, { timeout: PATIENCE_MS });
await until(`${view(0)}.canvas.dataset.shown && (self.first = ${view(0)}.canvas.toDataURL())`);
await until(`${view(0)}.canvas.toDataURL() !== self.first`);
await until(`${view(1)}.time.told.textContent.startsWith("2 of 3") && ${view(1)}.files.has("reflet.toml") && !${view(1)}.status.textContent`);
const [red, green] = await host.evaluate(`[...${view(1)}.canvas.getContext("2d").getImageData(32, 18, 1, 1).data]`);
if (red <= green) throw new Error("the variant of the element is not shown");
await until(`/none.toml cannot be loaded: /.test(${view(2)}.status.textContent)`);
await until(`/far/.test(${view(3)}.status.textContent)`);
await host.screenshot({ path: join(folder, "embedded.png") });
await host.addInitScript(() => Object.defineProperty(Navigator.prototype, "gpu", { value: undefined }));
await host.reload();
await until(`/browser lacks WebGPU/.test(${view(0)}.status.textContent)`);
if (programs !== 1) throw new Error(`${programs} programs are loaded for one page, and then one that cannot run`);
await host.close();
step("embedded");

// Rails by both methods: a row, a bar for each, and the samples. What a stop cuts off is said.
const bench = await open_page(browser, "bench.html");
await bench.waitForSelector("#start:enabled");
for (const name of await bench.locator("#views label").allTextContents()) await bench.setChecked(`#views label:text-is("${name}") input`, name.trim() === "rails");
await bench.fill("#frames", "2");
await bench.click("#start");
await bench.waitForSelector("#chart rect:nth-of-type(4)");
await download(bench, "samples.csv");
await bench.screenshot({ path: join(folder, "bench.png") });
await bench.waitForFunction(() => document.getElementById("start").textContent === "start");
for (const time of ["start", "stop"]) await bench.click("#start");
await bench.waitForSelector(".failed:text-is('stopped')");
await bench.close();
step("measured");

// A completion waits for no picture.
const busy = await open_page(browser);
for (const work of ["in", "rendering"]) {
  await status(busy, new RegExp(`\\b${work} ?`));
  await busy.press("#text", "Control+Home");
  for (let time = 0; time <= 20; time += 1) {
    await busy.press("#text", "Control+Space");
    await busy.waitForFunction((answers) => self.waited.length === answers, time + 1);
  }
  const [first, ...waited] = await busy.evaluate(() => self.waited.splice(0));
  console.error(`completions after ${first} ms, then ${waited.sort((a, b) => a - b)[10]} ms, at most ${waited.at(-1)} ms`);
  if (work === "in") await busy.selectOption("#examples", "studio.toml");
}
if (!/^rendering|^sample/.test(await busy.textContent("#status"))) throw new Error("the picture was there first");
await busy.close();
step("quick");

// The browser's process of the adapter crashes: pictures are made on a new device.
await page.evaluate(() => {
  const status = document.getElementById("status");
  new MutationObserver(() => { status.told = `${status.told ?? ""}${status.textContent}\n`; }).observe(status, { childList: true });
});
await (await browser.newBrowserCDPSession()).send("Browser.crashGpuProcess");
await write(page, "text.replace('[0.04, 0.7, 0.06]', '[0.7, 0.06, 0.04]')");
await shown(page);
const told = await page.evaluate(() => document.getElementById("status").told);
if (!/the device was lost .* it is made anew/.test(told)) throw new Error(`a crash is told as ${told}`);
step("lost");
await browser.close();

const without = await launch("--disable-gpu");
const checking = await open_page(without);
await status(checking, /lacks WebGPU|no graphics adapter/);
await write(checking, "text.replace('version = 1', 'version = 2')");
await checking.waitForSelector("#messages .error");
step("lacking");
await without.close();
