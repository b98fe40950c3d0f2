// The program, away from the page, which stays quick: the checker and the renderer, or the language server. Messages: {module} first,
// then {clear}, {file, bytes}, {ask, checks}, {put}, {png} and {rpc}; answers: {state}, {missing}, {check}, {part, pixels},
// {shown, pixels}, {put}, {png}, {rpc} and {ended}.
"use strict";

import init, { answer, ask, check, clear, language, missing, pixels, png, put_camera, put_file, start } from "./reflet_web.js";
import { lacks } from "./suspend.js";

const tell = (message, moved) => self.postMessage(message, moved);
self.tell_part = (done, samples, width, height, rgba) => tell({ part: { done, samples, width, height }, pixels: rgba }, [rgba.buffer]);
let why = "";
self.tell_panic = (text) => { why = text; };
const ended = (error) => tell({ ended: why || String(error) });

// Files that were looked for and are not there, before a message says so.
const tell_missing = () => {
  const paths = JSON.parse(missing());
  if (paths.length) tell({ missing: paths });
};

let show = null;
let isShowing = false;
let isAsked = false;

// A camera to put elsewhere waits for the picture in work, which holds the scene.
let moved = null;
const write = () => {
  if (!moved || isShowing) return;
  const [camera, eye] = moved;
  moved = null;
  tell({ put: JSON.parse(put_camera(camera, new Float32Array(eye))) });
};

const showAll = async () => {
  if (isShowing) return;
  isShowing = true;
  try {
    while (isAsked) {
      isAsked = false;
      const began = performance.now();
      await show();
      const shown = JSON.parse(answer());
      const rgba = shown.width ? pixels() : null;
      shown.seconds = (performance.now() - began) / 1e3;
      tell_missing();
      if (!shown.interrupted) tell({ shown, pixels: rgba }, rgba ? [rgba.buffer] : []);
    }
  } catch (error) {
    ended(error);
  }
  isShowing = false;
  write();
};

const work = {
  clear,
  file: ({ file, bytes }) => put_file(file, new Uint8Array(bytes)),
  ask: ({ ask: asked, checks }) => {
    const json = JSON.stringify(asked);
    if (checks) {
      const found = JSON.parse(check(json));
      tell_missing();
      tell({ check: found });
    }
    if (!show) return;
    ask(json);
    isAsked = true;
    showAll();
  },
  put: ({ put }) => {
    moved = put;
    write();
  },
  png: () => tell({ png: png() }),
  rpc: ({ rpc }) => tell({ rpc: language(rpc) }),
};

let load = null;
const loaded = new Promise((done) => { load = done; });
const ready = loaded.then(init).then((exports) => {
  start();
  const lacking = lacks();
  if (!lacking) show = WebAssembly.promising(exports.show);
  tell({ state: "ready", lacks: lacking });
}).catch(ended);

self.onmessage = async ({ data }) => {
  if (data.module) return load({ module_or_path: data.module });
  await ready;
  const kind = Object.keys(work).find((key) => key in data);
  try {
    work[kind](data);
  } catch (error) {
    ended(error);
  }
};
