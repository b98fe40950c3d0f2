// Lets a call of WebAssembly wait for the browser: it is suspended until something that it waits for calls back.
let woken = false;
let resume = null;

export const wake = () => {
  woken = true;
  resume?.();
};

const wait = async () => {
  if (!woken) await new Promise((done) => { resume = done; });
  resume = null;
  woken = false;
};

const canSuspend = typeof WebAssembly.Suspending === "function";
export const suspend = canSuspend ? new WebAssembly.Suspending(wait)
  : () => { throw new Error("this browser cannot suspend WebAssembly"); };

// Whatever pictures need and this browser lacks, by name.
export const lacks = () => {
  if (!navigator.gpu) return "WebGPU, which Chrome and Edge have on all systems (or the page was not loaded by https or from localhost)";
  if (!canSuspend) return "JavaScript Promise Integration, which Chrome and Edge have since version 137";
  return null;
};
