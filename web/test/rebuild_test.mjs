// That web/dist is what web/src and the lock file make of it, byte for byte.
//
//   node rebuild_test.mjs DIST

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readdirSync, readFileSync, rmSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const [dist] = process.argv.slice(2);
const root = dirname(dirname(fileURLToPath(import.meta.url)));
const made = join(root, "dist");
rmSync(made, { recursive: true, force: true });
execFileSync(process.execPath, [join(root, "build.mjs"), made], { stdio: "inherit" });

const names = ["LICENSES.txt", "live.css", "live.js", "replay.css", "replay.js"];
assert.deepEqual(readdirSync(dist).sort(), names);
assert.deepEqual(readdirSync(made).sort(), names);
for (const name of names)
  assert.ok(
    readFileSync(join(dist, name)).equals(readFileSync(join(made, name))),
    `web/dist/${name} is not what its sources make: run “npm ci && npm run build” in web/`,
  );

const licences = readFileSync(join(dist, "LICENSES.txt"), "utf8");
const { dependencies } = JSON.parse(readFileSync(join(root, "package.json"), "utf8"));
for (const [name, version] of Object.entries(dependencies)) {
  assert.match(version, /^\d+\.\d+\.\d+$/, `${name} needs one exact version`);
  assert.ok(licences.includes(`${name} ${version} (`), `no licence of ${name} ${version}`);
}
assert.doesNotMatch(
  readFileSync(join(root, "package-lock.json"), "utf8"),
  /"resolved"/,
  "the lock names a registry",
);
console.log(`${names.join(", ")}: as built`);
