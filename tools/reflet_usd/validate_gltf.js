// Runs the Khronos validator over files named on standard input, one path a line; writes one
// JSON line for each: the issue counts, the first messages and what the file uses.
"use strict";

const fs = require("fs");
const path = require("path");
const readline = require("readline");

const validator = require(process.argv[2]);
const MAX_ISSUES = 200;

async function check(file) {
  const folder = path.dirname(file);
  const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), {
    uri: path.basename(file),
    maxIssues: MAX_ISSUES,
    externalResourceFunction: async (uri) =>
      new Uint8Array(fs.readFileSync(path.join(folder, decodeURIComponent(uri)))),
  });
  return {
    file,
    version: validator.version(),
    errors: report.issues.numErrors,
    warnings: report.issues.numWarnings,
    infos: report.issues.numInfos,
    messages: report.issues.messages,
  };
}

function reason(error) {
  const lines = String((error && error.message) || error || "").split("\n");
  return lines[0].trim() || "an error without a message";
}

async function main() {
  // The validator throws some errors, such as an exhausted call stack, where no caller can catch them.
  let fail = () => {};
  process.on("uncaughtException", (error) => fail(error));
  for await (const line of readline.createInterface({ input: process.stdin })) {
    const file = line.trim();
    if (!file) continue;
    try {
      const crash = new Promise((_, reject) => {
        fail = (error) => reject(Object.assign(new Error(reason(error)), { crashed: true }));
      });
      console.log(JSON.stringify(await Promise.race([check(file), crash])));
    } catch (error) {
      const crashed = Boolean(error && error.crashed);
      console.log(JSON.stringify({ file, failure: reason(error), crashed }));
    }
  }
}

main();
