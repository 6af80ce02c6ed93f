// A browser for the tests of pages. It draws without a GPU, also the 3-D view: so it does everywhere
// the same, and composing in software is several times faster than on an emulated GPU.

import { chromium } from "playwright-core";

export function launch(executablePath = "/usr/bin/chromium") {
  return chromium.launch({
    executablePath,
    args: ["--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader"],
  });
}

/// The page at an address, with a list of what it has asked for and what has gone wrong in it.
/// `prepare` runs in it before its own scripts.
export async function open(browser, address, { prepare, ...options } = {}) {
  const context = await browser.newContext(options);
  context.setDefaultTimeout(120000);
  const page = await context.newPage();
  const requests = [];
  const faults = [];
  await context.route("**/*", (route) => {
    requests.push(route.request().url());
    return route.continue();
  });
  page.on("pageerror", (error) => faults.push(error.message));
  page.on("console", (message) => message.type() === "error" && faults.push(message.text()));
  if (prepare) await page.addInitScript(prepare);
  await page.goto(address);
  return { page, requests, faults, close: () => context.close() };
}

/// Once what the page has changed is drawn.
export function drawn(page) {
  return page.evaluate(
    () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))),
  );
}

/// Once the first run of the replay is shown; fails if it cannot be.
export function ready(page) {
  return page.evaluate(() => window.pliant.ready);
}

/// Goes to a time of the replay.
export async function seek(page, time) {
  await page.evaluate((t) => window.pliant.seek(t), time);
  await drawn(page);
}
