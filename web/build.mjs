// Bundles src/ into dist/: the script and the sheet of a report's page, replay.js and replay.css, those
// of the page of a run that goes on, live.js and live.css, and the licences of all that is in them.
//
//   node build.mjs [FOLDER]     the folder to write, else dist/

import { readFileSync, readdirSync, writeFileSync, mkdirSync } from "node:fs";
import { basename, dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

import { build } from "esbuild";

const root = dirname(fileURLToPath(import.meta.url));
const out = resolve(process.argv[2] ?? join(root, "dist"));

const { metafile, outputFiles } = await build({
  absWorkingDir: root,
  entryPoints: {
    "replay.js": "src/main.js",
    "replay.css": "src/replay.css",
    "live.js": "src/live.js",
    "live.css": "src/live.css",
  },
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

/// The bundles that hold a file of each package: {name: [bundle]}.
function packages() {
  const found = {};
  for (const [path, { inputs }] of Object.entries(metafile.outputs))
    for (const input of Object.keys(inputs)) {
      const name = input.match(/node_modules\/((?:@[^/]+\/)?[^/]+)\//)?.[1];
      if (name) (found[name] ??= new Set()).add(nameOf(path));
    }
  return Object.entries(found).sort(([a], [b]) => (a < b ? -1 : 1));
}

/// Packages that come without the text of their licence: one of the same authors with the same text.
const kTextElsewhere = { "@foxglove/ws-protocol": "@foxglove/rosmsg" };

function licenceOf(name) {
  const folder = join(root, "node_modules", kTextElsewhere[name] ?? name);
  const file = readdirSync(folder).find((entry) => /^licen[cs]e(\.\w+)?$/i.test(entry));
  return readFileSync(join(folder, file), "utf8");
}

/// Packages with their licences in full.
function licences() {
  return packages().map(([name, bundles]) => {
    const folder = join(root, "node_modules", name);
    const { version, license } = JSON.parse(readFileSync(join(folder, "package.json"), "utf8"));
    const lines = licenceOf(name).replaceAll("\r", "").replaceAll("\t", "    ").split("\n");
    const tidy = lines
      .map((line) => line.trimEnd())
      .join("\n")
      .trim();
    return `${name} ${version} (${license}), in ${[...bundles].sort().join(", ")}\n\n${tidy}\n`;
  });
}

/// esbuild adds the ending again.
function nameOf(path) {
  return basename(path).replace(/\.(js|css)\.\1$/, ".$1");
}

mkdirSync(out, { recursive: true });
const line = `\n${"-".repeat(80)}\n\n`;
writeFileSync(
  join(out, "LICENSES.txt"),
  `The scripts and sheets beside this file hold code of these packages.\n${line}` +
    licences().join(line),
);
for (const { path, text } of outputFiles) {
  const name = nameOf(path);
  // What would end the element of the page that holds it.
  if (/<\/(?:script|style)|<!--/i.test(text)) throw new Error(`${name} cannot stand in a page`);
  writeFileSync(join(out, name), text);
}
