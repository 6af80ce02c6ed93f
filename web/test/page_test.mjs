// The page in a browser: what it shows, what it answers to, and that it asks for nothing.
//
//   node page_test.mjs DIST FOLDER [BROWSER]     FOLDER takes the page and pictures of it

import assert from "node:assert/strict";
import { mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

import { drawn, launch, open, ready, seek } from "./browser.mjs";
import { samplePage } from "./sample_page.mjs";

const [dist, folder, executablePath] = process.argv.slice(2);
mkdirSync(folder, { recursive: true });
const sample = samplePage(dist);
const address = written("page.html", sample);

const browser = await launch(executablePath);
const kWide = { width: 1280, height: 800 };
const kNarrow = { width: 360, height: 700 };

// ---- what the tests are written in -------------------------------------------------------------

/// The address of a page in the folder.
function written(name, text) {
  const file = join(folder, name);
  writeFileSync(file, text);
  return pathToFileURL(file).href;
}

const time = (page) => page.evaluate(() => window.pliant.time());
const plots = (page) => page.locator("#replay .plot");
const curves = (page, i) => plots(page).nth(i).locator(".u-over");
const showAll = (page) => page.getByRole("button", { name: "Show all" });

const reader = await (await browser.newContext()).newPage();

/// The colours of a picture, each with its number of pixels.
function coloursOf(picture) {
  return reader.evaluate(async (base64) => {
    const bitmap = await createImageBitmap(
      await (await fetch(`data:image/png;base64,${base64}`)).blob(),
    );
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
    context.drawImage(bitmap, 0, 0);
    const { data } = context.getImageData(0, 0, bitmap.width, bitmap.height);
    const colours = {};
    for (let i = 0; i < data.length; i += 4) {
      const colour = `${data[i]},${data[i + 1]},${data[i + 2]}`;
      colours[colour] = (colours[colour] ?? 0) + 1;
    }
    return colours;
  }, picture.toString("base64"));
}

async function view(page) {
  await drawn(page);
  return page.locator("#replay canvas[role=img]").screenshot();
}

async function at(page, plot, share) {
  await curves(page, plot).scrollIntoViewIfNeeded();
  const box = await curves(page, plot).boundingBox();
  return [box.x + share * box.width, box.y + 0.6 * box.height];
}

/// The time that a click at a share of a plot's width goes to.
async function clicked(page, plot, share) {
  await page.mouse.click(...(await at(page, plot, share)));
  return time(page);
}

async function drag(page, plot, from, to) {
  await page.mouse.move(...(await at(page, plot, from)));
  await page.mouse.down();
  await page.mouse.move(...(await at(page, plot, to)), { steps: 4 });
  await page.mouse.up();
}

/// One pixel of a plot some 600 wide.
const near = (found, expected, span) =>
  assert.ok(Math.abs(found - expected) < span / 300, `${found} s, not ${expected} s`);

/// Counts what the page holds on the GPU, and the programs that it has ever compiled for it.
function countGpuObjects() {
  window.gpu = { held: 0, compiled: 0 };
  const context = WebGL2RenderingContext.prototype;
  for (const kind of ["Buffer", "VertexArray", "Program", "Texture"]) {
    const { [`create${kind}`]: create, [`delete${kind}`]: remove } = context;
    context[`create${kind}`] = function () {
      ++window.gpu.held;
      if (kind === "Program") ++window.gpu.compiled;
      return create.call(this);
    };
    context[`delete${kind}`] = function (object) {
      if (object) --window.gpu.held;
      return remove.call(this, object);
    };
  }
}

async function test(name, act) {
  await act();
  console.log(`ok  ${name}`);
}

// ---- one page, from opening to its second run --------------------------------------------------

const { page, requests, faults, close } = await open(browser, address, {
  viewport: kWide,
  colorScheme: "light",
  prepare: countGpuObjects,
});
await ready(page);

await test("the robot is drawn", async () => {
  const colours = Object.keys(await coloursOf(await view(page)));
  assert.ok(colours.length > 100, `${colours.length} colours`);
});

await test("the plots that the page asks for are shown, with unit and values", async () => {
  assert.equal(await plots(page).count(), 3);
  const legend = await plots(page).nth(1).locator(".legend").innerText();
  assert.match(legend, /qp\.torque\s*\[N·m\]/);
  assert.match(legend, /joint_7\s+[−\d.]+/);
});

await test("a click in a plot seeks, and the robot moves", async () => {
  const before = await view(page);
  near(await clicked(page, 1, 0.75), 4.5, 6);
  const after = await view(page);
  assert.ok(!before.equals(after), "the picture of the robot is the same");
  assert.match(await page.locator("#replay .time").innerText(), /^4\.\d+ \/ 6\.000 s$/);
});

await test("the force is shown while it acts", async () => {
  await seek(page, 1.25);
  assert.equal(await page.locator("#replay .forces").innerText(), "→push_1.force 29.7 N");
  await seek(page, 3);
  assert.equal(await page.locator("#replay .forces").innerText(), "");
});

await test("a time past the end is the end", async () => {
  await seek(page, 100);
  assert.equal(await time(page), 6);
});

await test("a drag zooms all plots, a double click shows all again", async () => {
  assert.ok(await showAll(page).isDisabled());
  await drag(page, 0, 0.25, 0.5);
  assert.ok(await showAll(page).isEnabled());
  near(await clicked(page, 2, 0.5), 2.25, 1.5);
  near(await clicked(page, 1, 0), 1.5, 1.5);
  await page.mouse.dblclick(...(await at(page, 1, 0.5)));
  assert.ok(await showAll(page).isDisabled());
  near(await clicked(page, 0, 0.5), 3, 6);
});

await test("a drag does not seek", async () => {
  await seek(page, 0.5);
  await drag(page, 1, 0.5, 0.75);
  assert.equal(await time(page), 0.5);
  await showAll(page).click();
});

await test("keys on a plot move the time and zoom", async () => {
  await seek(page, 3);
  await plots(page).first().focus();
  await page.keyboard.press("ArrowRight");
  near(await time(page), 3.03, 0.3);
  await page.keyboard.press("+");
  assert.ok(await showAll(page).isEnabled());
  await page.keyboard.press("0");
  assert.ok(await showAll(page).isDisabled());
  await page.keyboard.press("Home");
  assert.equal(await time(page), 0);
});

await test("space plays and pauses", async () => {
  await page.getByLabel("Speed").selectOption("0.1");
  await plots(page).first().focus();
  await page.keyboard.press("Space");
  await page.waitForFunction(() => window.pliant.time() > 0.01);
  await page.keyboard.press("Space");
  await page.getByRole("button", { name: "Play", exact: true }).waitFor();
  const stopped = await time(page);
  await drawn(page);
  assert.equal(await time(page), stopped);
});

await test("playing ends at the end, and begins again", async () => {
  await page.getByLabel("Speed").selectOption("2");
  await seek(page, 5.9);
  await page.getByRole("button", { name: "Play", exact: true }).click();
  await page.waitForFunction(() => window.pliant.time() === 6);
  await page.getByLabel("Speed").selectOption("0.1");
  await page.getByRole("button", { name: "Play", exact: true }).click();
  await page.waitForFunction(() => window.pliant.time() > 0 && window.pliant.time() < 5.9);
  await page.getByRole("button", { name: "Pause" }).click();
});

await test("the slider goes to a time", async () => {
  await page.getByRole("slider", { name: "Time" }).fill("5000");
  near(await time(page), 3, 6);
});

await test("a signal is found and plotted, moved and taken away", async () => {
  await page.getByRole("button", { name: "Signals" }).click();
  await page.keyboard.type("status");
  await page.getByRole("checkbox", { name: "qp.status" }).check();
  assert.equal(await plots(page).count(), 4);
  await page.getByLabel("Plot of qp.status", { exact: true }).selectOption("0");
  assert.equal(await plots(page).count(), 3);
  assert.match(await plots(page).first().locator(".legend").innerText(), /qp\.status/);
  await page.getByRole("checkbox", { name: "qp.status" }).uncheck();
  assert.doesNotMatch(await plots(page).first().locator(".legend").innerText(), /qp\.status/);
  await page.getByLabel("Find a signal").fill("pose error");
  await page.getByRole("button", { name: "Elements of pose.error" }).click();
  await page.getByRole("checkbox", { name: "z", exact: true }).check();
  assert.equal(await plots(page).count(), 4);
  await page.screenshot({ path: join(folder, "signals.png"), fullPage: true });
  await page.getByRole("button", { name: "Take away the plot of pose.error" }).click();
  assert.equal(await plots(page).count(), 3);
  await page.getByLabel("Find a signal").fill("nothing of the kind");
  await page.getByText("No signal has such a name.").waitFor();
  await page.getByLabel("Find a signal").fill("");
  await page.getByRole("button", { name: "Signals" }).click();
});

await test("a curve is hidden and shown by its name in the legend", async () => {
  const plot = plots(page).first();
  const before = await plot.locator("canvas").screenshot();
  await plot.getByRole("button", { name: "joint_4" }).click();
  assert.ok(!before.equals(await plot.locator("canvas").screenshot()));
  await plot.getByRole("button", { name: "joint_4", pressed: false }).click();
  await plot.getByRole("button", { name: "joint_4", pressed: true }).waitFor();
});

await test("the 3-D view turns by keys and by the mouse", async () => {
  const canvas = page.locator("#replay canvas[role=img]");
  await canvas.focus();
  const before = await view(page);
  await page.keyboard.press("ArrowLeft");
  const turned = await view(page);
  assert.ok(!before.equals(turned));
  const box = await canvas.boundingBox();
  await page.mouse.move(box.x + 0.5 * box.width, box.y + 0.5 * box.height);
  await page.mouse.down();
  await page.mouse.move(box.x + 0.7 * box.width, box.y + 0.55 * box.height, { steps: 3 });
  await page.mouse.up();
  assert.ok(!turned.equals(await view(page)));
  await page.getByRole("button", { name: "Reset view" }).click();
});

await test("another run has its own length, robot and plots", async () => {
  await seek(page, 5);
  const before = await view(page);
  await page.getByRole("tab", { name: /compliant/ }).click();
  await page.getByText("4001 rows").waitFor();
  assert.equal(
    await page.getByRole("tab", { selected: true }).innerText(),
    "compliant in the null space, Γ = 0.8 I",
  );
  assert.equal(await time(page), 4);
  await seek(page, 1.2);
  assert.ok(!before.equals(await view(page)));
  near(await clicked(page, 0, 0.5), 2, 4);
  await page.evaluate(() => window.pliant.run(0));
  await page.getByText("6001 rows").waitFor();
});

await test("a script that asks for a run too many is told how many there are", async () => {
  const said = /there is no run 2: the last is 1/;
  await assert.rejects(
    page.evaluate(() => window.pliant.run(2)),
    said,
  );
  assert.match(await page.getByRole("alert").innerText(), said);
  await page.evaluate(() => window.pliant.run(0));
  assert.equal(await page.getByRole("alert").count(), 0);
});

await test("the page follows light and dark", async () => {
  await seek(page, 1.2);
  await page.screenshot({ path: join(folder, "light.png"), fullPage: true });
  const curve = async () => coloursOf(await plots(page).first().locator("canvas").screenshot());
  assert.ok((await curve())["0,114,178"] > 50, "no curve in the blue of light pages");
  await page.emulateMedia({ colorScheme: "dark" });
  await drawn(page);
  const dark = await curve();
  assert.ok(dark["74,168,236"] > 50, "no curve in the blue of dark pages");
  assert.ok(dark["22,25,29"] > 1000, "the ground is not dark");
  await page.screenshot({ path: join(folder, "dark.png"), fullPage: true });
});

await test("a narrow window shows all without scrolling sideways", async () => {
  await page.setViewportSize(kNarrow);
  await drawn(page);
  await page.getByRole("button", { name: "Signals" }).click();
  await page.waitForFunction(() => document.documentElement.scrollWidth <= innerWidth);
  const widths = await page
    .locator("#replay .plot")
    .evaluateAll((all) => all.map((plot) => plot.getBoundingClientRect().right));
  assert.ok(
    widths.every((right) => right <= kNarrow.width),
    `${widths}`,
  );
  await page.screenshot({ path: join(folder, "narrow.png"), fullPage: true });
});

await test("runs and colours that come and go leave nothing on the GPU and compile nothing", async () => {
  const comeAndGo = async () => {
    await page.emulateMedia({ colorScheme: "light" });
    await page.evaluate(() => window.pliant.run(1));
    await page.emulateMedia({ colorScheme: "dark" });
    await page.evaluate(() => window.pliant.run(0));
    await drawn(page);
    return page.evaluate(() => window.gpu);
  };
  const first = await comeAndGo();
  assert.ok(first.held > 0, "nothing is counted");
  for (let i = 0; i < 2; ++i) assert.deepEqual(await comeAndGo(), first);
});

await test("paper has none of it", async () => {
  await page.emulateMedia({ media: "print" });
  assert.ok(await page.locator("#replay").isHidden());
});

await test("the page asks for nothing and logs no error", async () => {
  assert.deepEqual(requests, [address]);
  assert.deepEqual(faults, []);
});
await close();

// ---- where something is missing ----------------------------------------------------------------

await test("without WebGL the plots work, and a message says why there is no robot", async () => {
  const { page, close } = await open(browser, address, {
    viewport: kWide,
    prepare: () => {
      const { getContext } = HTMLCanvasElement.prototype;
      HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
        return kind.startsWith("webgl") ? null : getContext.call(this, kind, ...rest);
      };
    },
  });
  await ready(page);
  await page
    .getByText("The 3-D view needs WebGL, which this browser does not offer here.")
    .waitFor();
  near(await clicked(page, 0, 0.5), 3, 6);
  await close();
});

await test("without scripts the section is not there", async () => {
  const { page, close } = await open(browser, address, { javaScriptEnabled: false });
  await page.getByText("The text goes on below the replay.").waitFor();
  assert.ok(await page.locator("#replay").isHidden());
  await close();
});

await test("a force acts on the link that its column names", async () => {
  const swapped = sample.replace(
    '"frames":["base_link","shoulder_link","upper_link","elbow_link","forearm_link"',
    '"frames":["base_link","shoulder_link","upper_link","forearm_link","elbow_link"',
  );
  assert.notEqual(swapped, sample);
  const pictures = [];
  for (const text of [sample, swapped]) {
    const { page, close } = await open(browser, written("frames.html", text), { viewport: kWide });
    await ready(page);
    await seek(page, 1.25);
    pictures.push(await view(page));
    await close();
  }
  assert.ok(!pictures[0].equals(pictures[1]), "the arrow is at the same place");
});

await test("a robot that does not say where forces act is not shown, and why", async () => {
  const fails = async (text, said) => {
    const { page, close } = await open(browser, written("forces.html", text));
    await ready(page);
    assert.equal(
      await page.getByRole("note").innerText(),
      `The robot cannot be shown: ${said}. The plots work without it.`,
    );
    await close();
  };
  await fails(
    sample.replace('"frames":[', '"others":['),
    "forces act on links, but the robot has no “frames”",
  );
  await fails(
    sample.replace('"frames":["base_link"', '"frames":["nowhere"'),
    "the frame “nowhere” is no link of the robot",
  );
  await fails(
    sample.replace('"link":"push_1.force.link"', '"link":"push_1.link"'),
    "the force “push_1.force” needs a column “push_1.link”",
  );
});

await test("a page without the data of its run says so", async () => {
  const broken = written("broken.html", sample.replace('id="data-0"', 'id="elsewhere"'));
  const { page, close } = await open(browser, broken);
  await assert.rejects(ready(page), /the page has no element “data-0”/);
  assert.equal(
    await page.getByRole("alert").innerText(),
    "The run “stiff, Γ = 0” cannot be shown: the page has no element “data-0”.",
  );
  await close();
});

await test("a run that cannot be decoded is named, and the run before it stays", async () => {
  const cut = written("cut.html", sample.replace('id="data-1">', 'id="data-1">AAAA'));
  const { page, faults, close } = await open(browser, cut, { viewport: kWide });
  await ready(page);
  const alert = page.getByRole("alert");
  const [first, second] = await page.getByRole("tab").all();
  const message =
    "The run “compliant in the null space, Γ = 0.8 I” cannot be shown: " +
    "the data in “data-1” cannot be unpacked; make the report again.";
  const itsMessage = async () => {
    await alert.waitFor();
    assert.equal(await alert.innerText(), message);
    assert.equal(await first.getAttribute("aria-selected"), "true");
    await page.getByText("6001 rows").waitFor();
  };

  assert.equal(await alert.count(), 0);
  await second.click();
  await itsMessage();
  await page.screenshot({ path: join(folder, "cut.png") });
  await first.click();
  await alert.waitFor({ state: "hidden" });
  await page.keyboard.press("ArrowRight");
  await itsMessage();
  await first.click();
  await alert.waitFor({ state: "hidden" });
  await assert.rejects(
    page.evaluate(() => window.pliant.run(1)),
    /“data-1” cannot be unpacked/,
  );
  await itsMessage();
  assert.equal(faults.length, 2, "the console is told of the tab and of the key");
  await close();
});

await browser.close();
