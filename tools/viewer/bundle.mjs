// One HTML page of src/: scripts and styles inside, and a place for data.   node bundle.mjs FOLDER-OF-NODE_MODULES PAGE
import { createRequire } from "node:module";
import { mkdirSync, readFileSync, renameSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const [work, page] = process.argv.slice(2);
const src = join(dirname(fileURLToPath(import.meta.url)), "src");
const esbuild = createRequire(join(work, "package.json"))("esbuild");
const made = await esbuild.build({
  entryPoints: [join(src, "main.js")],
  bundle: true,
  minify: true,
  write: false,
  outdir: work,
  format: "iife",
  target: ["chrome100", "firefox100", "safari15.4"],
  nodePaths: [join(work, "node_modules")],
  legalComments: "inline",
});
const text = (ending) => made.outputFiles.find((file) => file.path.endsWith(ending)).text;
const html = readFileSync(join(src, "page.html"), "utf8")
  .replace("/*styles*/", () => text(".css"))
  .replace("/*script*/", () => text(".js"));
mkdirSync(dirname(page), { recursive: true });
writeFileSync(page + ".part", html);
renameSync(page + ".part", page);
