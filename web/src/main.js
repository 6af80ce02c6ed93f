// The interactive part of a report: plots of its runs and the robot that made them.

import { Chooser } from "./chooser.js";
import { Clock } from "./clock.js";
import { make } from "./element.js";
import { carriedOver, firstLayout } from "./layout.js";
import { readPalette, watchScheme } from "./palette.js";
import { Plots } from "./plots.js";
import { RobotView } from "./robot_view.js";
import { Run } from "./run.js";
import { Transport } from "./transport.js";

class Replay {
  constructor(root, page) {
    this.root = root;
    this.page = page;
    this.loaded = page.runs.map(() => null);
    this.palette = readPalette();
    this.clock = new Clock(() => this.#timeChanged());
    this.transport = new Transport(this.clock);
    this.chooser = new Chooser((layout) => this.#setLayout(layout));
    this.panels = make("div", { class: "plots" });
    this.plots = new Plots({
      root: this.panels,
      clock: this.clock,
      onClose: (names) =>
        this.#setLayout(this.layout.filter((plot) => !plot.some((name) => names.includes(name)))),
      onZoom: (zoom) => (this.all.disabled = !zoom),
      onPoint: (text) => (this.pointer.textContent = text),
    });
    this.note = make("p", { class: "quiet" });
    this.alert = make("p", { role: "alert", hidden: true });
    this.#build();
    watchScheme(() => this.#recolour());
    document.addEventListener("keydown", (event) => this.#key(event));
    new IntersectionObserver(([entry]) => (this.inSight = entry.isIntersecting)).observe(root);
  }

  // ---- the page --------------------------------------------------------------------------------

  #build() {
    this.signals = make(
      "button",
      {
        type: "button",
        "aria-expanded": "false",
        "aria-controls": this.chooser.element.id,
        onclick: () => {
          this.chooser.element.hidden = !this.chooser.element.hidden;
          this.signals.setAttribute("aria-expanded", String(!this.chooser.element.hidden));
          if (!this.chooser.element.hidden) this.chooser.search.focus();
        },
      },
      "Signals",
    );
    this.all = make(
      "button",
      { type: "button", disabled: true, onclick: () => this.plots.zoomTo(null) },
      "Show all",
    );
    this.pointer = make("span", { class: "pointer", "aria-hidden": "true" });
    const tools = make("div", { class: "tools" }, this.signals, this.all, this.pointer);
    const left = make("div", { class: "left" }, tools, this.chooser.element, this.panels);
    const right = make("div", { class: "right" }, this.#makeView(), this.transport.element);
    this.stage = make("div", { class: "stage", id: "replay-stage" }, right, left);
    this.root.append(
      make("h2", {}, "Replay"),
      ...this.#makeTabs(),
      this.alert,
      this.stage,
      this.note,
      makeHelp(),
    );
  }

  #makeTabs() {
    if (this.page.runs.length < 2) return [];
    this.tabs = this.page.runs.map((run, i) =>
      make(
        "button",
        {
          type: "button",
          role: "tab",
          "aria-controls": "replay-stage",
          onclick: () => this.select(i),
        },
        run.title,
      ),
    );
    return [
      make(
        "div",
        {
          class: "tabs",
          role: "tablist",
          "aria-label": "Run",
          onkeydown: (event) => {
            const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
            if (!step) return;
            const count = this.tabs.length;
            const next = (this.tabs.indexOf(document.activeElement) + step + count) % count;
            this.tabs[next].focus();
            this.select(next);
            event.preventDefault();
          },
        },
        ...this.tabs,
      ),
    ];
  }

  #makeView() {
    const frame = make("div", { class: "view" });
    const { robot } = this.page;
    if (!robot?.links?.length) {
      frame.hidden = true;
      return frame;
    }
    const canvas = make("canvas", {
      tabindex: 0,
      role: "img",
      "aria-label": "The robot in 3-D. Arrow keys turn the view, plus and minus zoom, 0 resets it.",
    });
    frame.append(canvas);
    try {
      this.view = new RobotView(robot, canvas);
    } catch (error) {
      this.#noView(frame, error);
      return frame;
    }
    this.forces = make("div", { class: "forces" });
    const path = make(
      "button",
      {
        type: "button",
        "aria-pressed": "true",
        title: "The path of the last link",
        onclick: () => {
          const shown = path.getAttribute("aria-pressed") !== "true";
          path.setAttribute("aria-pressed", String(shown));
          this.view.showTrace(shown);
        },
      },
      "Path",
    );
    const reset = make(
      "button",
      { type: "button", onclick: () => this.view.resetCamera() },
      "Reset view",
    );
    frame.append(this.forces, make("div", { class: "view-tools" }, path, reset));
    new ResizeObserver(() => this.view?.resize()).observe(canvas);
    return frame;
  }

  #noView(frame, error) {
    this.view = null;
    const reason = /webgl/i.test(error.message)
      ? "The 3-D view needs WebGL, which this browser does not offer here."
      : `The robot cannot be shown: ${error.message}.`;
    frame.replaceChildren(
      make("p", { class: "quiet", role: "note" }, `${reason} The plots work without it.`),
    );
    frame.classList.add("without");
  }

  // ---- a run -----------------------------------------------------------------------------------

  /// Shows a run, or says to the reader why not and leaves what is shown. The error goes on to the
  /// script that asked, or to the console.
  async select(index) {
    this.wanted = index;
    try {
      await this.#run(index);
      if (this.wanted === index) this.alert.hidden = true;
    } catch (error) {
      if (this.wanted === index) this.#tell(index, error);
      throw error;
    }
  }

  #tell(index, error) {
    const run = this.page.runs[index];
    const what = this.tabs && run ? `The run “${run.title}”` : "The replay";
    this.alert.textContent = failure(what, error);
    this.alert.hidden = false;
  }

  async #run(index) {
    if (!this.page.runs[index])
      throw new Error(`there is no run ${index}: the last is ${this.page.runs.length - 1}`);
    this.clock.pause();
    this.loaded[index] ??= Run.load(this.page.runs[index]);
    const run = await this.loaded[index];
    if (this.wanted !== index) return;
    this.tabs?.forEach((tab, i) => {
      tab.setAttribute("aria-selected", String(i === index));
      tab.tabIndex = i === index ? 0 : -1;
    });
    this.stage.setAttribute("role", this.tabs ? "tabpanel" : "group");
    this.stage.setAttribute("aria-label", run.title || "Run");
    const first = !this.shown;
    this.shown = run;
    const wanted = run.description.plots ?? this.page.plots;
    this.layout = first ? firstLayout(run, wanted) : carriedOver(this.layout, run, wanted);
    this.note.textContent = noteOf(run);
    this.#showPlots();
    try {
      this.view?.setRun(run, this.palette);
    } catch (error) {
      this.#noView(this.root.querySelector(".view"), error);
    }
    this.clock.setSpan(run.from, run.to);
    if (first) this.clock.seek(run.from);
    await new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn)));
  }

  #setLayout(layout) {
    this.layout = layout;
    this.#showPlots();
  }

  #showPlots() {
    this.plots.show(this.shown, this.layout, this.palette);
    this.chooser.show(this.shown, this.layout);
  }

  #recolour() {
    this.palette = readPalette();
    if (!this.shown) return;
    this.#showPlots();
    this.view?.setPalette(this.palette);
  }

  // ---- the time --------------------------------------------------------------------------------

  #timeChanged() {
    this.transport?.show();
    if (!this.shown) return;
    this.plots.showTime();
    if (!this.view) return;
    this.view.setTime(this.clock.time);
    this.forces.replaceChildren(
      ...this.view
        .forces(this.clock.time)
        .map(({ name, size }) =>
          make(
            "div",
            {},
            make("span", { class: "arrow", "aria-hidden": "true" }, "→"),
            `${name} ${size}`,
          ),
        ),
    );
  }

  /// Space plays and pauses, unless it means something where the focus is.
  #key(event) {
    if (event.key !== " " || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.target.closest?.("input:not([type=range]), select, textarea, button, a, summary"))
      return;
    if (!this.inSight || (event.target !== document.body && !this.root.contains(event.target)))
      return;
    event.preventDefault();
    this.clock.toggle();
  }
}

function noteOf(run) {
  const { rows, decimation } = run.description;
  const share = run.bits === 16 ? "65 534" : "16 777 214";
  const shown = decimation ? `${decimation[0].toUpperCase()}${decimation.slice(1)}` : "";
  return (
    `${rows ?? run.times.length} rows. ${shown}${shown && !shown.endsWith(".") ? "." : ""} ` +
    `Values are rounded to 1/${share} of what their signal spans.`
  );
}

function makeHelp() {
  const keys = [
    ["drag in a plot", "zooms all plots to that time"],
    ["double click", "shows all again"],
    ["click in a plot", "goes to that time"],
    ["space", "plays and pauses"],
    ["← → in a plot", "move the time, with Shift in larger steps"],
    ["+ − 0 in a plot", "zoom in, zoom out, show all"],
    ["drag in the 3-D view", "turns it; with the right button moves it"],
    ["wheel in the 3-D view", "zooms, after a click in it"],
  ];
  return make(
    "details",
    { class: "help" },
    make("summary", {}, "Mouse and keys"),
    make(
      "dl",
      {},
      ...keys.map(([key, act]) => make("div", {}, make("dt", {}, key), make("dd", {}, act))),
    ),
  );
}

function failure(what, error) {
  return `${what} cannot be shown: ${error.message.replace(/\.$/, "")}.`;
}

// ---- start -------------------------------------------------------------------------------------

function start() {
  const root = document.getElementById("replay");
  const source = document.getElementById("runs");
  if (!root || !source) return;
  try {
    const page = JSON.parse(source.textContent);
    if (!page.runs?.length) return;
    if (typeof DecompressionStream === "undefined")
      throw new Error("this browser is too old to unpack it (it has no DecompressionStream)");
    const replay = new Replay(root, page);
    window.pliant = {
      time: () => replay.clock.time,
      seek: (t) => replay.clock.seek(t),
      run: (index) => replay.select(index),
      ready: replay.select(0),
    };
  } catch (error) {
    root.append(make("p", { role: "alert" }, failure("The replay", error)));
    throw error;
  }
}

start();
