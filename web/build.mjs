// Bundles src/ into dist/: replay.js, replay.css and the licences of all that is in them.
//
//   node build.mjs [FOLDER]     the folder to write, else dist/

import { readFileSync, writeFileSync, mkdirSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

import { build } from "esbuild";

const root = dirname(fileURLToPath(import.meta.url));
const out = resolve(process.argv[2] ?? join(root, "dist"));

const { metafile, outputFiles } = await build({
  absWorkingDir: root,
  entryPoints: { replay: "src/main.js", sheet: "src/replay.css" },
  outdir: out,
  bundle: true,
  minify: true,
  format: "iife",
  target: ["chrome111", "firefox113", "safari16.4"],
  charset: "ascii",
  legalComments: "none",
  metafile: true,
  write: false,
});

/// Packages of which a file is in the bundle, with their licences in full.
function licences() {
  const packages = new Set(
    Object.keys(metafile.inputs)
      .map((path) => path.match(/node_modules\/((?:@[^/]+\/)?[^/]+)\//)?.[1])
      .filter(Boolean),
  );
  return [...packages].sort().map((name) => {
    const folder = join(root, "node_modules", name);
    const { version, license } = JSON.parse(readFileSync(join(folder, "package.json"), "utf8"));
    const text = readFileSync(join(folder, "LICENSE"), "utf8");
    const lines = text.replaceAll("\r", "").replaceAll("\t", "    ").split("\n");
    const tidy = lines
      .map((line) => line.trimEnd())
      .join("\n")
      .trim();
    return `${name} ${version} (${license})\n\n${tidy}\n`;
  });
}

mkdirSync(out, { recursive: true });
const line = `\n${"-".repeat(80)}\n\n`;
writeFileSync(
  join(out, "LICENSES.txt"),
  `replay.js and replay.css hold code of these packages.\n${line}${licences().join(line)}`,
);
for (const { path, text } of outputFiles) {
  const name = path.endsWith(".css") ? "replay.css" : "replay.js";
  // What would end the element of the page that holds it.
  if (/<\/(?:script|style)|<!--/i.test(text)) throw new Error(`${name} cannot stand in a page`);
  writeFileSync(join(out, name), text);
}
