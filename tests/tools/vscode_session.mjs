// A session in the real VS Code (code-server) with the built extension: a mistake is marked, explained and mended by a quick
// fix, a key is completed, a name renamed across files, and the pane shows the picture, anew after a save.
// The folder is the project's; where a step fails, a screenshot is left in it.
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { address, launch, place as folder, step, written } from "./session.mjs";

const PATIENCE_MS = 60_000;
const browser = await launch("--disable-gpu");
const page = await browser.newPage({ viewport: { width: 1400, height: 900 } });
page.setDefaultTimeout(PATIENCE_MS);

const saved = (name, holds) => written(join(folder, name), holds);
const quickInput = page.locator(".quick-input-widget");
// Chooses in the box that these keys open.
const choose = async (keys, words) => {
  await page.keyboard.press(keys);
  await quickInput.locator("input").first().fill(words);
  await quickInput.locator(".monaco-list-row").first().waitFor();
  await page.keyboard.press("Enter");
  await quickInput.waitFor({ state: "hidden" });
};
// Puts the cursor at the start of a text of the scene's file as it is saved.
const goTo = async (part) => {
  const before = readFileSync(join(folder, "scene.toml"), "utf8").split(part)[0].split("\n");
  await choose("Control+g", `:${before.length}:${before.at(-1).length + 1}`);
};
// Presses keys until what they open is there: VS Code closes it again where it lays itself out at that moment.
const open = async (keys, opened) => {
  const until = Date.now() + PATIENCE_MS;
  for (let is_open = false; !is_open; ) {
    if (Date.now() > until) throw new Error(`${keys} opens nothing`);
    for (const key of keys) await page.keyboard.press(key);
    is_open = await opened.first().waitFor({ timeout: 5_000 }).then(() => true, () => false);
  }
};
const save = () => page.keyboard.press("Control+s");
const editor = page.locator(".editor-instance .view-lines").first();
const problems = page.locator(".markers-panel");
const pane = page.frameLocator("iframe.webview").frameLocator("#active-frame");
// Waits for the picture that the pane shows as its nth.
const shown = async (nth) => {
  const size = await pane.locator(`img[src$="?${nth}"]`).evaluate(async (image) => {
    await image.decode();
    return `${image.naturalWidth}x${image.naturalHeight}`;
  });
  if (size !== "96x54") throw new Error(`the picture has ${size} pixels`);
};

async function session() {
  await page.goto(`${address}?folder=${encodeURIComponent(folder)}`);
  await page.locator(".monaco-workbench").waitFor();
  await choose("Control+p", "scene.toml");
  await editor.getByText("camera.main").first().waitFor();
  step("opened");

  await page.keyboard.press("Control+Shift+m");
  await problems.getByText("sphere").first().waitFor();
  step("marked");

  await page.locator(".editor-instance").first().click();
  await goTo("target");
  await open(["Control+k", "Control+i"], page.locator(".monaco-hover:visible", { hasText: "looks at" }));
  await page.keyboard.press("Escape");
  step("explained");

  await goTo("spere");
  await open(["Control+."], page.locator(".action-widget", { hasText: "sphere" }));
  await page.keyboard.press("Enter");
  await editor.getByText('"sphere"').waitFor();
  await save();
  await saved("scene.toml", (text) => text.includes('kind = "sphere"'));
  await problems.getByText("No problems").first().waitFor();
  step("mended");

  await goTo("\n[environment]");
  await page.keyboard.type("\nfov");
  await open(["Control+Space"], page.locator(".suggest-widget:visible", { hasText: "fov_deg" }));
  await page.keyboard.press("Tab");
  await page.keyboard.type("40"); // in place of the default, which is selected
  await save();
  await saved("scene.toml", (text) => /\nfov_deg = 40\n\[environment\]/.test(text));
  step("completed");

  await goTo("red");
  const name = page.locator(".rename-box input:visible");
  await open(["F2"], name);
  await name.fill("crimson");
  await page.keyboard.press("Enter");
  await saved("base.toml", (text) => text.includes("[material.crimson]"));
  await saved("scene.toml", (text) => text.includes('material = "crimson"'));
  step("renamed");

  await choose("F1", ">Reflet: Show the Picture of This Scene");
  await shown(1);
  step("pictured");

  await editor.click();
  await goTo("40\n");
  await page.keyboard.press("Shift+End");
  await page.keyboard.type("20");
  await save();
  await shown(2);
  step("rerendered");
}

try {
  await session();
} catch (error) {
  await page.screenshot({ path: join(folder, "failed.png") });
  throw error;
} finally {
  await browser.close();
}
