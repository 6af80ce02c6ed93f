// The page of a run that goes on, in a browser, against the run itself.
//
//   node live_test.mjs PLIANT SCENARIO FOLDER [BROWSER]     FOLDER takes pictures of the page

import assert from "node:assert/strict";
import { mkdirSync } from "node:fs";
import { join } from "node:path";

import { drawn, launch, open, ready } from "./browser.mjs";
import { connect } from "./foxglove_client.mjs";
import { show } from "./live_process.mjs";

const [pliant, scenario, folder, executablePath] = process.argv.slice(2);
mkdirSync(folder, { recursive: true });
const browser = await launch(executablePath);
const kWide = { width: 1280, height: 900 };
const kNarrow = { width: 420, height: 900 };
const kIdeal = ["--set", "station.ideal=true"];

// ---- what the tests are written in -------------------------------------------------------------

async function test(name, act) {
  await act();
  console.log(`ok  ${name}`);
}

const plots = (page) => page.locator("#replay .plot");
const banner = (page) => page.locator("#replay .banner");
const live = (page) => page.getByRole("button", { name: "Live", exact: true });
const said = (page) => page.locator("#replay .said");
const following = (page) => page.evaluate(() => window.pliant.following());
const time = (page) => page.evaluate(() => window.pliant.time());

/// Once the page has more rows than now.
async function moreRows(page, more = 1) {
  const count = await page.evaluate(() => window.pliant.rows());
  await page.waitForFunction((wanted) => window.pliant.rows() >= wanted, count + more);
}

const kJoints = [1, 2, 3, 4, 5, 6, 7].map((j) => `arm.measured_position[joint_${j}]`);

/// How far the joints are from where they were at first [rad].
function moved(page) {
  return page.evaluate(
    (joints) =>
      Math.max(
        ...joints.map((name) => {
          const values = window.pliant.values(name);
          return Math.abs(values.at(-1) - values[0]);
        }),
      ),
    kJoints,
  );
}

/// Presses on a link, where the cursor says that there is one.
async function grasp(page) {
  const box = await page.locator("#replay canvas[role=img]").boundingBox();
  for (let row = 2; row < 10; ++row)
    for (let column = 2; column < 10; ++column) {
      await page.mouse.move(box.x + (column / 12) * box.width, box.y + (row / 12) * box.height);
      if (!(await page.locator("#replay canvas.push").count())) continue;
      await page.mouse.down();
      await page.locator("#replay .push-label").waitFor();
      return box;
    }
  throw new Error("no link is where the page is drawn");
}

// ---- one page, from opening to the end of its run ----------------------------------------------

const run = await show(pliant, scenario, ...kIdeal);
const other = await connect(run.address);
const { page, requests, faults, close } = await open(browser, run.address, {
  viewport: kWide,
  colorScheme: "light",
});
await ready(page);

await test("the run is shown, and its time goes on", async () => {
  assert.equal(await page.getByRole("heading", { level: 1 }).innerText(), "An arm to be pushed");
  assert.equal(await plots(page).count(), 3);
  const before = await time(page);
  await page.waitForFunction((t) => window.pliant.time() > t, before);
  assert.ok(await following(page));
  await said(page).getByText(/running · \d+\.\d s of 600 s · pace/).waitFor();
});

await test("a click in a plot looks back while rows still come, and Live follows again", async () => {
  await moreRows(page, 100);
  const over = plots(page).first().locator(".u-over");
  const box = await over.boundingBox();
  await page.mouse.click(box.x + 3, box.y + 0.5 * box.height);
  assert.ok(!(await following(page)));
  const held = await time(page);
  await moreRows(page);
  assert.equal(await time(page), held);
  await live(page).click();
  await page.waitForFunction((t) => window.pliant.time() > t, held);
});

await test("space holds the picture and lets it go on", async () => {
  await plots(page).first().focus();
  await page.keyboard.press("Space");
  assert.ok(!(await following(page)));
  await page.keyboard.press("Space");
  assert.ok(await following(page));
});

await test("the slider of time looks back", async () => {
  await page.getByRole("slider", { name: "Time" }).fill("0");
  assert.equal(await time(page), 0);
  await live(page).click();
  assert.ok(await following(page));
});

await test("without a hand the arm stays where it is", async () => {
  // What a controller that holds a pose leaves of its first ticks.
  assert.ok((await moved(page)) < 0.02, `${await moved(page)} rad`);
});

await test("a link that is dragged pulls the arm, and the view does not turn", async () => {
  const corner = async () => {
    await drawn(page);
    const box = await page.locator("#replay canvas[role=img]").boundingBox();
    return page.screenshot({ clip: { ...box, width: 40, height: 40, y: box.y + box.height - 42 } });
  };
  const before = await corner();
  await page.keyboard.down("Control");
  const box = await grasp(page);
  await page.mouse.move(box.x + 0.9 * box.width, box.y + 0.3 * box.height, { steps: 4 });
  await page.getByText(/^\d+ N( \(most\))?$/).waitFor();
  await page.waitForFunction(() => window.pliant.values("live_push_1.force.force[x]").at(-1) !== 0);
  while ((await moved(page)) < 0.05) await moreRows(page);
  await page.screenshot({ path: join(folder, "pushed.png") });
  assert.ok((await corner()).equals(before), "the view has turned");
});

await test("a link that is let go of is not pulled any more", async () => {
  await page.mouse.up();
  await page.keyboard.up("Control");
  assert.ok(await page.locator("#replay .push-label").isHidden());
  await page.waitForFunction(() =>
    ["x", "y", "z"].every(
      (axis) => window.pliant.values(`live_push_1.force.force[${axis}]`).at(-1) === 0,
    ),
  );
});

await test("the button Push does what Ctrl does", async () => {
  const button = page.getByRole("button", { name: "Push", exact: true });
  await button.click();
  const box = await grasp(page);
  await page.mouse.move(box.x + 0.1 * box.width, box.y + 0.3 * box.height, { steps: 4 });
  await page.waitForFunction(() => window.pliant.values("live_push_1.force.force[x]").at(-1) !== 0);
  await page.mouse.up();
  await button.click();
  assert.equal(await button.getAttribute("aria-pressed"), "false");
});

const kCompliance = "control.posture.compliance";
const identity = (gamma) => Array.from({ length: 49 }, (_, k) => (k % 8 ? 0 : gamma));
const field = (target) => target.getByLabel(`${kCompliance}, number`, { exact: true });

async function complianceBecomes(gamma) {
  for (;;) {
    const values = await other.parameters(kCompliance);
    if (JSON.stringify(values.get(kCompliance)) === JSON.stringify(identity(gamma))) return;
    await drawn(page);
  }
}

await test("a slider changes the compliance of the run", async () => {
  await page.getByLabel(kCompliance, { exact: true }).fill("0.5");
  await complianceBecomes(0.5);
  assert.equal(await field(page).inputValue(), "0.5");
});

await test("a number beyond the slider makes it longer", async () => {
  await field(page).fill("3");
  await field(page).press("Enter");
  await complianceBecomes(3);
  assert.equal(await page.getByLabel(kCompliance, { exact: true }).getAttribute("max"), "6");
});

await test("what another client sets is shown", async () => {
  other.client.setParameters([{ name: kCompliance, value: identity(0.25) }]);
  await page.waitForFunction(
    (name) => document.querySelector(`[aria-label="${name}, number"]`).value === "0.25",
    kCompliance,
  );
});

await test("one entry is set by itself", async () => {
  const row = page.locator(`[data-name="${kCompliance}"]`);
  await row.getByText("all entries").click();
  await row.getByLabel(`${kCompliance}, row 2, column 1`, { exact: true }).fill("0.1");
  await row.getByLabel(`${kCompliance}, row 2, column 1`, { exact: true }).press("Enter");
  for (;;) {
    const values = (await other.parameters(kCompliance)).get(kCompliance);
    if (values[1] === 0.1 && values[7] === 0) break;
    await drawn(page);
  }
  assert.equal(await field(page).inputValue(), "", "it is no multiple of the identity any more");
  await row.getByRole("button", { name: `${kCompliance} as at the start` }).click();
  await complianceBecomes(1);
});

await test("a parameter is found by a word of its name", async () => {
  const search = page.getByLabel("Find a parameter");
  await search.fill("live_push");
  const blocks = page.locator("#replay .block:visible");
  await search.fill("zzz");
  assert.equal(await blocks.count(), 0);
  await page.getByText("No parameter has such a name.").waitFor();
  await search.fill("");
  assert.ok((await blocks.count()) > 0);
});

await test("a page that is loaded again has all rows, the values, and what was chosen", async () => {
  await field(page).fill("0.75");
  await field(page).press("Enter");
  await complianceBecomes(0.75);
  await page.getByRole("button", { name: /^Take away the plot of control\.pose_error/ }).click();
  await page.getByLabel("Window").selectOption("5");
  const block = page.locator("#replay .block").first();
  await block.locator("summary").first().click();
  const before = await page.evaluate(() => window.pliant.values("time"));
  await page.reload();
  await ready(page);
  await page.waitForFunction((t) => window.pliant.values("time").at(-1) > t, before.at(-1));
  const after = await page.evaluate(() => window.pliant.values("time"));
  assert.equal(after[0], before[0]);
  // Rows come at 100 Hz; some may be late, none is left out.
  const pauses = after.slice(1).map((t, i) => t - after[i]);
  assert.ok(Math.max(...pauses) < 0.021, `${Math.max(...pauses)} s`);
  assert.equal(await plots(page).count(), 2);
  assert.equal(await page.getByLabel("Window").inputValue(), "5");
  assert.ok(await block.evaluate((element) => element.open));
  await page.waitForFunction(
    (name) => document.querySelector(`[aria-label="${name}, number"]`).value === "0.75",
    kCompliance,
  );
});

await test("it is light and dark, wide and narrow", async () => {
  for (const [name, viewport] of Object.entries({ wide: kWide, narrow: kNarrow }))
    for (const colorScheme of ["light", "dark"]) {
      await page.setViewportSize(viewport);
      await page.emulateMedia({ colorScheme });
      await drawn(page);
      await page.waitForFunction(() => document.documentElement.scrollWidth <= innerWidth);
      await page.screenshot({ path: join(folder, `${name}_${colorScheme}.png`) });
    }
  await page.setViewportSize(kWide);
});

await test("without WebGL the plots and the parameters work", async () => {
  const prepare = () => {
    const { getContext } = HTMLCanvasElement.prototype;
    HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
      return kind.startsWith("webgl") ? null : getContext.call(this, kind, ...rest);
    };
  };
  const { page, faults, close } = await open(browser, run.address, { viewport: kWide, prepare });
  await ready(page);
  await page.getByText("The 3-D view needs WebGL").waitFor();
  await moreRows(page, 20);
  assert.equal(await page.getByRole("button", { name: "Push", exact: true }).count(), 0);
  assert.ok(await field(page).isEnabled());
  assert.deepEqual(
    faults.filter((fault) => !/WebGL/.test(fault)),
    [],
  );
  await close();
});

await test("Stop ends the run, and the page stays to be looked at", async () => {
  await page.getByRole("button", { name: "Stop" }).click();
  await banner(page).getByText(/^The run has ended: it was asked to stop/).waitFor();
  await run.ended;
  assert.ok(await page.getByRole("button", { name: "Stop" }).isDisabled());
  assert.ok(await live(page).isDisabled());
  assert.ok(await field(page).isDisabled());
  await page.evaluate(() => window.pliant.seek(1));
  assert.equal(await time(page), 1);
  await page.getByLabel("Speed").selectOption("2");
  await page.getByRole("button", { name: "Play", exact: true }).click();
  await page.waitForFunction(() => window.pliant.time() > 1);
  await page.screenshot({ path: join(folder, "ended.png") });
});

await test("the page asked for itself alone, and logged no error", async () => {
  assert.deepEqual([...new Set(requests)], [run.address]);
  assert.deepEqual(faults, []);
});
await close();

// ---- a run that may not be touched, and one that is lost ---------------------------------------

const second = await show(pliant, scenario, ...kIdeal);
{
  const { page, close } = await open(browser, second.address, { viewport: kWide });
  await ready(page);

  await test("a page that may not change parameters says how that is allowed", async () => {
    await page.route(second.address, async (route) => {
      const answer = await route.fetch();
      const text = (await answer.text()).replace('"control":true', '"control":false');
      return route.fulfill({ response: answer, body: text });
    });
    await page.reload();
    await ready(page);
    await page.getByText("--control on the command line allows changes").waitFor();
    assert.ok(await field(page).isDisabled());
    await page.unroute(second.address);
    await page.reload();
    await ready(page);
  });

  await test("a process that is gone is told, and what has come stays", async () => {
    await moreRows(page, 100);
    second.kill("SIGKILL");
    await banner(page).getByText(/^The process that runs cannot be reached/).waitFor();
    assert.ok(await page.getByRole("button", { name: "Stop" }).isDisabled());
    await page.evaluate(() => window.pliant.seek(0.5));
    assert.equal(await time(page), 0.5);
  });
  await close();
}

await browser.close();
