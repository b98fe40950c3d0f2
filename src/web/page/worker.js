// The program, away from the page, which stays quick: the checker and the renderer, or the language server. Messages: {module} first,
// then {file, bytes}, {scene, text, width, frame, checks, camera, eye}, {put}, {png} and {rpc}; answers: {state}, {check},
// {part, pixels}, {shown, pixels}, {put}, {png}, {rpc} and {ended}.
"use strict";

import init, { answer, ask, check, language, pixels, png, put_camera, put_file, start } from "./reflet_web.js";
import { canSuspend } from "./suspend.js";

const tell = (message, moved) => self.postMessage(message, moved);
self.tell_part = (done, samples, width, height, rgba) => tell({ part: { done, samples, width, height }, pixels: rgba }, [rgba.buffer]);
let why = "";
self.tell_panic = (text) => { why = text; };
const ended = (error) => tell({ ended: why || String(error) });

// Whatever pictures need and this browser lacks, by name.
const lacks = () => {
  if (!self.navigator.gpu) return "WebGPU, which Chrome and Edge have on all systems (or the page was not loaded by https or from localhost)";
  if (!canSuspend) return "JavaScript Promise Integration, which Chrome and Edge have since version 137";
  return null;
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
      if (!shown.interrupted) tell({ shown, pixels: rgba }, rgba ? [rgba.buffer] : []);
    }
  } catch (error) {
    ended(error);
  }
  isShowing = false;
  write();
};

const work = {
  file: ({ file, bytes }) => put_file(file, new Uint8Array(bytes)),
  scene: ({ scene, text, width, frame, checks, camera, eye }) => {
    if (checks) tell({ check: JSON.parse(check(scene, text)) });
    if (!show) return;
    ask(scene, text, width, frame, camera ?? "", new Float32Array(eye ?? []));
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
