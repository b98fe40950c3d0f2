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

async function main() {
  for await (const line of readline.createInterface({ input: process.stdin })) {
    const file = line.trim();
    if (!file) continue;
    try {
      console.log(JSON.stringify(await check(file)));
    } catch (error) {
      console.log(JSON.stringify({ file, failure: String(error && error.message || error) }));
    }
  }
}

main();
