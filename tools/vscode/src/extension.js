// Extension of VS Code for Reflet: the language server, and a pane with the picture of a scene.

"use strict";

const { spawn } = require("node:child_process");
const fs = require("node:fs");
const os = require("node:os");
const path = require("node:path");
const vscode = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

let client;
/** Panes that are open, each with a program that waits for saves. */
const panes = new Set();

/** The program that the user has set. */
function program() {
  return vscode.workspace.getConfiguration("reflet").get("path", "reflet");
}

/** Tables of scenes, where a text has one with or without a header. */
const TABLE =
  /^\s*\[*(box_faces|camera|decal|environment|group|image|instance|light|material|model|motion|near_far|params|probes?|reflection|timeline|variant)\b/;

/**
 * Whether a text is a scene, as the server judges it: its first line names Reflet's schema, or it has a table of scenes and
 * a whole number as version, or without a version tables of scenes alone.
 */
function isScene(text) {
  if (/^\uFEFF?#:schema\s.*reflet/i.test(text)) return true;
  const lines = text.replace(/^\uFEFF/, "").split("\n");
  const version = lines.map((line) => /^(["']?)version\1\s*=\s*(.*)/.exec(line)?.[2]).find(Boolean);
  if (!lines.some((line) => TABLE.test(line))) return false;
  if (version !== undefined) return /^\d+\s*(#|$)/.test(version);
  return lines.every((line) => !/^\s*\[+\s*["'\w]/.test(line) || TABLE.test(line));
}

/** Whether a document needs the server. */
function needsServer(document) {
  return (
    document.languageId === "rhai" ||
    path.basename(document.fileName) === "reflet.toml" ||
    (document.languageId === "toml" && isScene(document.getText()))
  );
}

/** Starts the server once it is needed: with a project in the folders of the window, a script or a scene. */
async function startWhereNeeded(context) {
  const { workspace } = vscode;
  const projects = await workspace.findFiles("**/reflet.toml", "**/node_modules/**", 1);
  if (projects.length > 0 || workspace.textDocuments.some(needsServer)) return startServer();
  let isStarted = false;
  const look = async (document) => {
    if (isStarted || !needsServer(document)) return;
    isStarted = true;
    if (client === undefined) await startServer();
  };
  context.subscriptions.push(
    workspace.onDidOpenTextDocument(look),
    workspace.onDidChangeTextDocument((change) => look(change.document)),
  );
}

async function startServer() {
  const server = { command: program(), args: ["lsp"] };
  client = new LanguageClient("reflet", "Reflet", server, {
    documentSelector: [
      { scheme: "file", language: "toml" },
      { scheme: "file", language: "rhai" },
    ],
  });
  try {
    await client.start();
  } catch (error) {
    client = undefined;
    const set = "Set the path";
    // The client rejects with nothing where the program cannot be run.
    const why = error?.message ?? `\`${program()} lsp\` cannot be run`;
    const text = `Reflet's language server did not start: ${why}. Is reflet installed?`;
    if ((await vscode.window.showErrorMessage(text, set)) === set) {
      await vscode.commands.executeCommand("workbench.action.openSettings", "reflet.path");
    }
  }
}

/** Path of the scene in the active editor. */
function activeScene() {
  const document = vscode.window.activeTextEditor?.document;
  if (document?.uri.scheme !== "file" || !document.fileName.endsWith(".toml")) {
    vscode.window.showInformationMessage("Open a scene (.toml) first.");
    return undefined;
  }
  return document.fileName;
}

/** A pane that shows what `reflet render --watch` writes. */
class PicturePane {
  constructor(scene) {
    this.folder = fs.mkdtempSync(path.join(os.tmpdir(), "reflet-"));
    this.file = path.join(this.folder, "picture.png");
    this.version = 0;
    this.told = "";
    const name = path.basename(scene);
    const root = vscode.Uri.file(this.folder);
    const column = vscode.ViewColumn.Beside;
    this.panel = vscode.window.createWebviewPanel("reflet.picture", name, column, {
      localResourceRoots: [root],
    });
    const own = vscode.workspace.getConfiguration("reflet").get("pictureArguments", []);
    const words = ["render", scene, "--watch", "--output", this.file, ...own];
    this.child = spawn(program(), words, { cwd: path.dirname(scene) });
    this.child.stderr.setEncoding("utf8");
    this.child.stderr.on("data", (text) => this.hear(text));
    this.child.on("error", (error) => this.hear(`error: ${error.message}\n`));
    this.child.on("exit", () => this.show());
    this.panel.onDidDispose(() => this.close());
    panes.add(this);
    this.show();
  }

  /** Keeps what the program says about one picture, and shows both once it waits for the next save. */
  hear(text) {
    this.told += text;
    const [about, rest] = this.told.split(/^waiting for a save.*$/m);
    if (rest !== undefined) {
      this.version += 1;
      this.told = rest.trimStart();
      this.show(about);
    } else {
      this.show(this.told);
    }
  }

  show(text = "") {
    const messages = text.replace(/^(wrote|created) .*$/gm, "").trim();
    const uri = this.panel.webview.asWebviewUri(vscode.Uri.file(this.file));
    const picture = fs.existsSync(this.file) ? `${uri}?${this.version}` : "";
    this.panel.webview.html = page(this.panel.webview.cspSource, picture, messages);
  }

  close() {
    panes.delete(this);
    this.child.kill();
    fs.rmSync(this.folder, { recursive: true, force: true });
  }
}

/** The page of a pane: a picture, and messages below it. It loads the picture alone and runs nothing. */
function page(source, picture, messages) {
  const safe = (text) =>
    text.replace(/[&<>"]/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[c]);
  const instead = messages ? "" : "<p>Rendering …</p>";
  const image = picture ? `<img src="${safe(picture)}" alt="The rendered scene">` : instead;
  const policy = `default-src 'none'; img-src ${source}; style-src 'unsafe-inline'`;
  return `<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="${policy}">
<style>img { max-width: 100%; } pre { overflow-x: auto; }</style>
</head><body>${image}<pre>${safe(messages)}</pre></body></html>`;
}

function activate(context) {
  const command = (name, run) =>
    context.subscriptions.push(vscode.commands.registerCommand(name, run));
  command("reflet.picture", () => {
    const scene = activeScene();
    if (scene && client === undefined) startServer();
    return scene && new PicturePane(scene);
  });
  command("reflet.preview", () => {
    const scene = activeScene();
    if (scene) {
      const window = spawn(program(), ["preview", scene], { detached: true, stdio: "ignore" });
      window.on("error", (error) => vscode.window.showErrorMessage(`Reflet: ${error.message}`));
      window.unref();
    }
  });
  command("reflet.restart", async () => {
    await client?.stop();
    await startServer();
  });
  return startWhereNeeded(context);
}

function deactivate() {
  // No pane is disposed where VS Code itself ends.
  panes.forEach((pane) => pane.close());
  return client?.stop();
}

module.exports = { activate, deactivate, isScene, page };
