// Copies the page's sources into a folder of the build and installs what its lock file names there.
//
//   node packages.mjs SOURCE FOLDER

import { execFileSync } from "node:child_process";
import { cpSync, existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join } from "node:path";

const [source, folder] = process.argv.slice(2);
mkdirSync(folder, { recursive: true });
for (const name of ["src", "test"]) rmSync(join(folder, name), { recursive: true, force: true });
for (const name of [".npmrc", "package.json", "package-lock.json", "build.mjs", "src", "test"])
  cpSync(join(source, name), join(folder, name), { recursive: true });

const lock = readFileSync(join(folder, "package-lock.json"), "utf8");
const installed = join(folder, "node_modules", ".installed-lock");
if (!existsSync(installed) || readFileSync(installed, "utf8") !== lock) {
  execFileSync("npm", ["ci", "--ignore-scripts"], { cwd: folder, stdio: "inherit" });
  writeFileSync(installed, lock);
}
console.log("the packages of package-lock.json are there");
