// The extension against a stand-in for VS Code, and its grammars against texts.

"use strict";

const assert = require("node:assert");
const { spawnSync } = require("node:child_process");
const fs = require("node:fs");
const Module = require("node:module");
const os = require("node:os");
const path = require("node:path");
const { after, test } = require("node:test");

const root = path.join(__dirname, "..");
const built = ["debug", "release"].map((kind) => path.join(root, "../../target", kind, "reflet"));
const reflet = process.env.REFLET ?? built.find((file) => fs.existsSync(file)) ?? "reflet";
const skip = spawnSync(reflet, ["--version"]).error && "there is no program: set REFLET";

/** What the extension has done to the stand-in. */
const seen = { commands: {}, panels: [], messages: [] };

const vscode = {
  ViewColumn: { Beside: -2 },
  Uri: { file: (file) => ({ scheme: "file", fsPath: file, toString: () => `file://${file}` }) },
  commands: {
    registerCommand: (name, run) => {
      seen.commands[name] = run;
      return { dispose() {} };
    },
  },
  window: {
    activeTextEditor: undefined,
    showInformationMessage: (text) => seen.messages.push(text),
    showErrorMessage: async (text) => void seen.messages.push(text),
    createWebviewPanel: () => {
      const panel = {
        webview: { cspSource: "self:", html: "", asWebviewUri: (uri) => `view:${uri.fsPath}` },
        onDidDispose: (run) => (panel.dispose = run),
      };
      seen.panels.push(panel);
      return panel;
    },
  },
  workspace: {
    getConfiguration: () => ({
      get: (name, value) =>
        ({ path: reflet, pictureArguments: ["--size", "16x9"] })[name] ?? value,
    }),
    findFiles: async () => [],
    textDocuments: [],
    onDidOpenTextDocument: (run) => (seen.opened = run),
    onDidChangeTextDocument: () => {},
  },
};

class LanguageClient {
  constructor(id, name, server) {
    seen.server = server;
  }
  async start() {}
  async stop() {}
}

const load = Module._load;
Module._load = (name, ...rest) => {
  if (name === "vscode") return vscode;
  if (name === "vscode-languageclient/node") return { LanguageClient };
  return load(name, ...rest);
};
const extension = require("../src/extension.js");

const folder = fs.mkdtempSync(path.join(os.tmpdir(), "reflet-vscode-"));
after(() => fs.rmSync(folder, { recursive: true, force: true }));

/** Waits until a condition holds. */
async function until(holds) {
  for (let tries = 0; !holds(); tries += 1) {
    assert(tries < 2400, "it does not come");
    await new Promise((done) => setTimeout(done, 50));
  }
}

test("it starts the language server and registers what the manifest names", async () => {
  await extension.activate({ subscriptions: [] });
  const open = (fileName, text) =>
    seen.opened({ languageId: "toml", fileName, getText: () => text });
  await open("Cargo.toml", 'version = 1\n[package]\nname = "model"\n');
  assert.strictEqual(seen.server, undefined);
  const readme = fs.readFileSync(path.join(root, "../../README.md"), "utf8");
  const [scene] = readme.match(/(?<=```toml\n)version = 1\n[^`]*/);
  await open("my.toml", scene);
  assert.deepStrictEqual(seen.server, { command: reflet, args: ["lsp"] });
  const manifest = JSON.parse(fs.readFileSync(path.join(root, "package.json")));
  const named = manifest.contributes.commands.map((command) => command.command).sort();
  assert.deepStrictEqual(Object.keys(seen.commands).sort(), named);
  for (const { path: file } of manifest.contributes.grammars) {
    assert(fs.existsSync(path.join(root, file)), file);
  }
});

test("the pane shows the picture, the next one after a save, and mistakes", { skip }, async () => {
  const scene = path.join(folder, "a.toml");
  const text = `version = 1
camera.main = { eye = [0, 1, 3], target = [0, 0, 0] }
environment.color = [0.5, 0.5, 0.5]
model.ball.shape = { kind = "sphere", segments = 8 }
`;
  fs.writeFileSync(scene, text);
  seen.commands["reflet.picture"]();
  assert.match(seen.messages.at(-1), /Open a scene/);
  vscode.window.activeTextEditor = {
    document: { fileName: scene, uri: { scheme: "file" } },
  };
  seen.commands["reflet.picture"]();
  const panel = seen.panels.at(-1);
  assert.match(panel.webview.html, /Rendering/);
  const picture = (version) => new RegExp(`<img src="view:[^"]*picture.png\\?${version}"`);
  await until(() => picture(1).test(panel.webview.html));
  assert.match(panel.webview.html, /default-src 'none'; img-src self:/);
  fs.writeFileSync(scene, text.replace("segments = 8", "segments = 9"));
  await until(() => picture(2).test(panel.webview.html));
  fs.writeFileSync(scene, text.replace("eye", "eya"));
  await until(() => /<pre>error\[unknown-key\].*\n.*a.toml:2:17/.test(panel.webview.html));
  panel.dispose();
});

test("a page runs nothing that a message holds", () => {
  const html = extension.page("self:", "", "<script>alert(1)</script>");
  assert(!html.includes("<script>"));
});

test("the grammars name keys, values and functions", async () => {
  const { loadWASM, OnigScanner, OnigString } = require("vscode-oniguruma");
  const { Registry, parseRawGrammar } = require("vscode-textmate");
  const wasm = fs.readFileSync(require.resolve("vscode-oniguruma/release/onig.wasm"));
  await loadWASM(wasm.buffer.slice(wasm.byteOffset, wasm.byteOffset + wasm.length));
  const registry = new Registry({
    onigLib: Promise.resolve({
      createOnigScanner: (patterns) => new OnigScanner(patterns),
      createOnigString: (text) => new OnigString(text),
    }),
    loadGrammar: async (scope) => {
      const file = path.join(root, `${scope.replace("source.", "")}.tmLanguage.json`);
      return parseRawGrammar(fs.readFileSync(file, "utf8"), file);
    },
  });
  const scopes = async (language, line) => {
    const grammar = await registry.loadGrammar(`source.${language}`);
    const { tokens } = grammar.tokenizeLine(line, null);
    return tokens.map((t) => [line.slice(t.startIndex, t.endIndex).trim(), t.scopes.at(-1)]);
  };
  const has = async (language, line, word, scope) => {
    const found = await scopes(language, line);
    assert(found.some(([text, name]) => text === word && name.startsWith(scope)), JSON.stringify(found));
  };
  await has("toml", "[camera.main]", "camera.main", "entity.name.section");
  await has("toml", "eye = [0, 1.5, -3] # here", "1.5", "constant.numeric");
  await has("toml", "eye = [0, 1.5, -3] # here", "# here", "comment");
  await has("toml", 'light.sun = { kind = "point" }', "light.sun", "variable.other.key");
  await has("toml", 'light.sun = { kind = "point" }', "point", "string");
  await has("rhai", 'fn frame(ctx) { ctx.place("a", [0, t, 0]); }', "frame", "entity.name.function");
  await has("rhai", 'fn frame(ctx) { ctx.place("a", [0, t, 0]); }', "ctx", "variable.language");
  await has("rhai", "let x = if a { 1 } else { 2 }; // so", "if", "keyword.control");
});
