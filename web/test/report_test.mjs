// The report of a real run in a browser: it opens from disk, the robot moves, and it asks for nothing.
//
//   node report_test.mjs PLIANT FOLDER [BROWSER]     FOLDER takes the report and a picture of it

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { statSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

import { launch, open, ready, seek } from "./browser.mjs";

const [pliant, folder, executablePath] = process.argv.slice(2);
const out = join(folder, "null-space-compliance");
execFileSync(
  pliant,
  ["experiment", "run", "null-space-compliance", "--force", "--strict", "--out", out]
    .concat("--set", "station.ideal=true")
    .concat("--set", "station.engine=recursive")
    .concat("--set", "integrator.method=bogacki_shampine"),
  { stdio: "inherit" },
);
const file = join(out, "report.html");
assert.ok(statSync(file).size < 5e6, `${statSync(file).size} bytes`);

const address = pathToFileURL(file).href;
const browser = await launch(executablePath);
const { page, requests, faults } = await open(browser, address, {
  viewport: { width: 1280, height: 900 },
});
await ready(page);

async function view(time) {
  await seek(page, time);
  return page.locator("#replay canvas[role=img]").screenshot();
}

assert.match(await page.locator(".tally").innerText(), /^5 of 5 claims hold$/);
assert.equal(await page.locator("figure > svg").count(), 3);
assert.equal(await page.getByRole("tab").count(), 4);
assert.match(await page.locator("details").first().textContent(), /robot: "gen3"/);

// At rest the arm stands still; where it gives way in its null space, its elbow is elsewhere.
await page.getByRole("tab", { name: "null space" }).click();
await page.getByRole("tab", { name: "null space", selected: true }).waitFor();
const before = await view(0);
assert.ok(before.equals(await view(0.4)), "the arm moves before it is pushed");
assert.ok(!before.equals(await view(2)), "the push moves nothing");
await view(1.25);
assert.match(await page.locator("#replay .forces").innerText(), /push_1\.force.* 30\.0 N/);

const plot = page.locator("#replay .plot").first().locator(".u-over");
await plot.scrollIntoViewIfNeeded();
const box = await plot.boundingBox();
await page.mouse.click(box.x + 0.5 * box.width, box.y + 0.5 * box.height);
const time = await page.evaluate(() => window.pliant.time());
assert.ok(Math.abs(time - 3) < 6 / 300, `a click in the middle goes to ${time} s`);

await page.screenshot({ path: join(folder, "report.png"), fullPage: true });
assert.deepEqual(requests, [address]);
assert.deepEqual(faults, []);
await browser.close();
console.log("ok  the report of a run");
