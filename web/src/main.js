// The interactive part of a report: plots of its runs and the robot that made them.

import { Clock } from "./clock.js";
import { make } from "./element.js";
import { carriedOver, firstLayout } from "./layout.js";
import { Run } from "./run.js";
import { failure, makeHelp, Stage } from "./stage.js";

const kKeys = [
  ["drag in a plot", "zooms all plots to that time"],
  ["double click", "shows all again"],
  ["click in a plot", "goes to that time"],
  ["space", "plays and pauses"],
  ["← → in a plot", "move the time, with Shift in larger steps"],
  ["+ − 0 in a plot", "zoom in, zoom out, show all"],
  ["drag in the 3-D view", "turns it; with the right button moves it"],
  ["wheel in the 3-D view", "zooms, after a click in it"],
];

class Replay {
  constructor(root, page) {
    this.page = page;
    this.loaded = page.runs.map(() => null);
    this.clock = new Clock(() => this.stage?.timeChanged());
    this.stage = new Stage({
      root,
      robot: page.robot,
      clock: this.clock,
      onSpace: () => this.clock.toggle(),
    });
    this.alert = make("p", { role: "alert", hidden: true });
    root.append(
      make("h2", {}, "Replay"),
      ...this.#makeTabs(),
      this.alert,
      this.stage.element,
      this.stage.note,
      makeHelp(kKeys),
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
    const { stage } = this;
    stage.element.setAttribute("role", this.tabs ? "tabpanel" : "group");
    const first = !stage.shown;
    const wanted = run.description.plots ?? this.page.plots;
    stage.note.textContent = noteOf(run);
    stage.show(run, first ? firstLayout(run, wanted) : carriedOver(stage.layout, run, wanted));
    this.clock.setSpan(run.from, run.to);
    if (first) this.clock.seek(run.from);
    await new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn)));
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
