#!/usr/bin/env node
// Makes a page that simulates by itself, of a page that `dyn view ROBOT --html PAGE` wrote:
//   page.mjs ESBUILD PACKAGE ROBOT PAGE OUT [CONFIGURATION]
// ESBUILD: the command; PACKAGE: the npm package as it is built; ROBOT: a file without meshes; CONFIGURATION: where it starts.
import {execFileSync} from "node:child_process";
import {readFileSync, writeFileSync} from "node:fs";
import {join} from "node:path";

const [esbuild, folder, robot, page, out, configuration = null] = process.argv.slice(2);
const program = execFileSync(esbuild, [join(folder, "live.js"), "--bundle", "--minify", "--format=iife", "--define:import.meta.url=\"file:///page\"", "--external:module", "--external:node:*", "--external:fs", "--external:path",
  "--external:url", "--external:crypto", "--log-level=error"], {encoding: "utf8", maxBuffer: 1 << 28});
const plain = (id, path) => `<script type="text/plain" id="${id}">${readFileSync(path).toString("base64")}</script>\n`;
const head = /(<script type="application\/json" id="dyn-head">)(.*?)(<\/script>)/s;
let text = readFileSync(page, "utf8");
if (!head.test(text)) throw new Error(`${page} is no page of dyn view --html`);
text = text.replace(head, (_, open, json, close) => {
  const data = {...JSON.parse(json), kind: "live", effects: []};
  const start = JSON.stringify({configuration, options: {}});
  return `${open}${JSON.stringify(data).replaceAll("<", "\\u003c")}${close}\n${plain("dyn-module", join(folder, "dyn_module.wasm"))}${plain("dyn-robot", robot)}` +
    `<script type="application/json" id="dyn-start">${start}</script>\n<script>${program.replaceAll("</script", "<\\/script")}</script>\n`;
});
text = text.replace("script-src 'unsafe-inline'", "script-src 'unsafe-inline' 'wasm-unsafe-eval'");
writeFileSync(out, text);
console.log(`${out}: ${text.length} bytes`);
