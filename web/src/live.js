// The page of a run that goes on: its plots, the robot, its parameters, and a hand to push it with.

import { Connection } from "./connection.js";
import { make } from "./element.js";
import { carriedOver, firstLayout } from "./layout.js";
import { LiveClock } from "./live_clock.js";
import { LiveRun } from "./live_run.js";
import { Memory } from "./memory.js";
import { watchScheme } from "./palette.js";
import { Parameters } from "./parameters.js";
import { Push } from "./push.js";
import { decodeRows } from "./rows.js";
import { failure, makeHelp, Stage } from "./stage.js";

const kFrame = 1000 / 15; // milliseconds from one picture to the next
const kWindows = ["5", "10", "30", "all"]; // [s]
const kBack = 0.5; // [s]: no run goes back in time
const kRefusalShown = 10000; // milliseconds
const kOnceMore = 30000; // milliseconds in which the page is not loaded twice

const kKeys = [
  ["space", "holds the picture, and follows the run again"],
  ["click in a plot", "goes to that time"],
  ["drag in a plot", "zooms all plots to that time"],
  ["double click", "shows all"],
  ["← → in a plot", "move the time, with Shift in larger steps"],
  ["+ − 0 in a plot", "zoom in, zoom out, show all"],
  ["drag in the 3-D view", "turns it; with the right button moves it"],
  ["wheel in the 3-D view", "zooms, after a click in it"],
];

class Live {
  constructor(root, page) {
    this.page = page;
    this.live = page.live;
    this.memory = new Memory();
    this.window = kWindows.includes(this.memory.get("window")) ? this.memory.get("window") : "10";
    this.state = { state: "connecting" };
    this.clock = new LiveClock(() => this.#timeChanged());
    this.stage = new Stage({
      root,
      robot: page.robot,
      clock: this.clock,
      onSpace: () => this.clock.toggleFollowing(),
      onZoom: (zoom, byHand) => this.#zoomed(zoom, byHand),
      onChange: () => this.#remember(),
    });
    this.parameters = new Parameters({
      live: this.live,
      memory: this.memory,
      send: (name, value) => this.connection?.setParameter(name, value),
    });
    this.#build(root);
    this.#makePush();
  }

  // ---- the page --------------------------------------------------------------------------------

  #build(root) {
    const act = (name, topic, title) =>
      make(
        "button",
        { type: "button", title, disabled: true, onclick: () => this.connection.publish(topic, {}) },
        name,
      );
    this.stop = act("Stop", "/pliant/stop", "Ends the run");
    this.stop.classList.add("stop");
    this.acknowledge = act("Acknowledge", "/pliant/acknowledge", "Tells the supervisor to go on");
    this.acknowledge.hidden = !this.live.supervised;
    this.said = make("p", { class: "said", role: "status" });
    this.banner = make("p", { class: "banner", role: "status", hidden: true });
    this.alert = make("p", { role: "alert", hidden: true });
    this.follow = make(
      "button",
      {
        type: "button",
        class: "follow",
        title: "Follows the run (space)",
        onclick: () => this.clock.toggleFollowing(),
      },
      "Live",
    );
    this.windows = make(
      "select",
      {
        "aria-label": "Window",
        title: "What is seen while the run is followed",
        onchange: () => this.#setWindow(this.windows.value),
      },
      ...kWindows.map((window) =>
        make(
          "option",
          { value: window, selected: window === this.window },
          window === "all" ? "all" : `last ${window} s`,
        ),
      ),
    );
    const { stage } = this;
    stage.tools.prepend(this.follow, this.windows);
    stage.right.append(this.parameters.element);
    stage.panels.addEventListener("pointerdown", ({ target, pointerType }) => {
      if (pointerType !== "touch" && target.closest(".u-over")) this.clock.freeze();
    });
    const title = this.live.title || "A run";
    const heading = document.querySelector("h1") ?? make("h1", {}, title);
    const buttons = make("div", { class: "acts" }, this.acknowledge, this.stop);
    const about = make("div", { class: "about-run" }, heading, this.said);
    const keys = this.live.push
      ? [...kKeys, ["Ctrl and drag a link", "pushes it: 200 N/m, at most 60 N"]]
      : kKeys;
    root.classList.add("live");
    root.append(
      make("div", { class: "live-head" }, about, buttons),
      this.banner,
      this.alert,
      stage.element,
      stage.note,
      makeHelp(keys),
    );
    this.#say();
  }

  #makePush() {
    const { view, frame, viewTools, palette } = this.stage;
    if (!this.live.push || !view) return;
    this.push = new Push({
      view,
      frame,
      begin: () => {
        if (!this.going) return false;
        this.clock.follow();
        return true;
      },
      send: (message) => this.connection?.publish("/push", message),
    });
    this.push.setColour(palette.amber);
    watchScheme(() => this.push.setColour(this.stage.palette.amber));
    viewTools.prepend(this.push.button);
  }

  #say() {
    const { state, time, pace, late, dropped, safety } = this.state;
    const { duration } = this.live;
    const parts = [{ running: "running", ended: "ended", connecting: "connecting" }[state] ?? state];
    if (Number.isFinite(time))
      parts.push(`${time.toFixed(1)} s${duration ? ` of ${duration} s` : ""}`);
    if (state === "running" && Number.isFinite(pace)) parts.push(`pace ${pace.toFixed(2)}`);
    if (safety) parts.push(`supervisor: ${safety}`);
    if (late) parts.push(`${late} ticks late`);
    if (dropped) parts.push(`${dropped} rows dropped`);
    const dot = make("span", { class: `dot ${this.going ? "on" : ""}`, "aria-hidden": "true" });
    this.said.replaceChildren(dot, parts.join(" · "));
    this.stop.disabled = !this.going;
    this.acknowledge.disabled = !this.going || !this.live.control;
    if (this.push) this.push.button.disabled = !this.going;
  }

  /// Something that was wanted cannot be.
  #refused(message) {
    if (this.parameters.names.some((name) => message.includes(name)))
      return this.parameters.tell(message);
    this.alert.textContent = message;
    this.alert.hidden = false;
    clearTimeout(this.alertTimer);
    this.alertTimer = setTimeout(() => (this.alert.hidden = true), kRefusalShown);
  }

  #tell(text) {
    this.banner.textContent = text;
    this.banner.hidden = !text;
  }

  /// Rows come, and what is sent is heard.
  get going() {
    return Boolean(this.connection?.isOpen) && this.state.state !== "ended";
  }

  #remember() {
    this.memory.set("layout", this.stage.layout);
    this.memory.set("hidden", [...this.stage.plots.hidden]);
  }

  // ---- the run ---------------------------------------------------------------------------------

  async begin() {
    const { stage, page } = this;
    const run = await LiveRun.load(page.runs[0]);
    this.run = run;
    const wanted = run.description.plots ?? page.plots;
    const kept = this.memory.get("layout");
    const shown = kept ? carriedOver(kept, run, wanted) : firstLayout(run, wanted);
    stage.plots.hidden = new Set(this.memory.get("hidden"));
    stage.element.setAttribute("role", "group");
    stage.show(run, shown);
    this.#draw();
    this.connection = new Connection(new URL("/", location.href.replace(/^http/, "ws")).href, {
      opened: (session, first) => this.#opened(session, first),
      lost: () => this.#lost(),
      rows: (data, first) => this.#rows(data, first),
      state: (state) => this.#stateIs(state),
      values: (values) => this.parameters.take(values),
      status: ({ level, message }) => level > 0 && this.#refused(message),
    });
    await new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn)));
  }

  #opened(session, first) {
    if (!first && session !== this.session) return this.#loadAgain();
    this.session = session;
    if (this.state.state !== "ended") {
      this.state = { ...this.state, state: "running" };
      this.#tell("");
    }
    this.connection.watchParameters(this.parameters.names);
    this.#say();
  }

  #lost() {
    this.push?.release();
    if (this.state.state !== "ended") {
      this.state = { ...this.state, state: "no connection" };
      this.#tell(
        "The process that runs cannot be reached. This page keeps what it has, and looks for it " +
          "again and again.",
      );
    }
    this.#say();
  }

  #rows(data, first) {
    const width = this.run.columns.length + 1;
    const numbers = decodeRows(data, width);
    const { to } = this.run;
    const { missing } = this.run.append(numbers);
    if (first && numbers[numbers.length - width] < to - kBack) this.#loadAgain(); // another run
    if (missing > 0) this.missing = (this.missing ?? 0) + missing;
    if (first && missing > 0) this.#loadAgain();
    this.#drawSoon();
  }

  #stateIs(state) {
    const ended = state.state === "ended" && this.state.state !== "ended";
    this.state = state;
    if (ended) this.#ended();
    this.#say();
  }

  #ended() {
    const { time, reason } = this.state;
    this.push?.release();
    this.connection.rest();
    this.parameters.disable();
    this.follow.disabled = this.windows.disabled = true;
    this.clock.end();
    const why = reason ? `: ${reason.replace(/\.$/, "")}` : "";
    const isSaid = /\d s\b/.test(why);
    const when = Number.isFinite(time) && !isSaid ? ` at ${time.toFixed(2)} s` : "";
    this.#tell(`The run has ended${when}${why}. This page keeps what it has and plays it again.`);
    this.#drawSoon();
  }

  /// What is missing here is in the page as it would be now.
  #loadAgain() {
    const last = this.memory.get("loaded") ?? 0;
    if (Date.now() - last < kOnceMore) return;
    this.memory.set("loaded", Date.now());
    this.connection.rest();
    location.reload();
  }

  // ---- what is seen ----------------------------------------------------------------------------

  /// Rows of the window that is followed.
  get followed() {
    const { from, to } = this.run;
    if (this.window === "all") return null;
    const seconds = Number(this.window);
    return [Math.max(from, to - seconds), Math.max(to, from + seconds)];
  }

  #setWindow(window) {
    this.window = window;
    this.windows.value = window;
    this.memory.set("window", window);
    this.clock.follow();
    this.#followChanged();
  }

  #zoomed(zoom, byHand) {
    if (!byHand) return;
    if (!zoom && this.clock.following) return this.#setWindow("all");
    this.clock.freeze();
    this.#traceWindow();
  }

  #traceWindow() {
    this.stage.view?.trace(...this.stage.plots.window);
    this.stage.view?.setTime(this.clock.time);
  }

  #timeChanged() {
    if (!this.run) return;
    const { clock, stage } = this;
    if (this.following !== clock.following) this.#followChanged();
    if (!clock.following) this.#keepInSight();
    stage.timeChanged();
  }

  #followChanged() {
    const { clock, stage } = this;
    this.following = clock.following;
    this.follow.setAttribute("aria-pressed", String(clock.following));
    if (clock.following) {
      stage.plots.follow(this.followed);
      stage.all.disabled = this.window === "all";
    }
    this.#traceWindow();
  }

  #keepInSight() {
    const { plots } = this.stage;
    const [from, to] = plots.window;
    const { time } = this.clock;
    if (time >= from && time <= to) return;
    const ahead = this.clock.playing ? 0.1 : 0.5;
    const begin = time - ahead * (to - from);
    plots.zoomTo([begin, begin + to - from]);
    this.#traceWindow();
  }

  // ---- pictures --------------------------------------------------------------------------------

  /// Pictures that take long leave time for others.
  #drawSoon() {
    if (this.waiting) return;
    this.waiting = true;
    const wait = (this.drawn ?? 0) + Math.max(kFrame, 2 * (this.cost ?? 0)) - performance.now();
    setTimeout(() => requestAnimationFrame(() => this.#draw()), Math.max(wait, 0));
  }

  #draw() {
    const begin = performance.now();
    this.waiting = false;
    const { run, clock, stage } = this;
    const before = clock.to;
    if (clock.following) stage.view?.extendTrace((this.followed ?? [run.from])[0]);
    clock.setSpan(run.from, run.to);
    if (clock.following) stage.plots.follow(this.followed);
    else if (!stage.plots.zoom || stage.plots.zoom[1] >= before) stage.plots.refresh();
    stage.note.textContent = noteOf(run, this.missing);
    this.drawn = performance.now();
    this.cost = this.drawn - begin;
  }
}

function noteOf(run, missing) {
  const thinned =
    run.thinnedUntil === null
      ? ""
      : ` Before ${run.thinnedUntil.toFixed(1)} s rows are left out, so that the page stays small; ` +
        "a log has them all.";
  const lost = missing
    ? ` ${missing.toFixed(1)} s are missing: the page was away for long, or slower than the run.`
    : "";
  return `${run.times.length} rows.${thinned}${lost}`;
}

// ---- start -------------------------------------------------------------------------------------

function start() {
  const root = document.getElementById("replay");
  const source = document.getElementById("runs");
  if (!root || !source) return;
  // Else browsers ask for one, which there is not.
  if (!document.querySelector("link[rel~=icon]"))
    document.head.append(make("link", { rel: "icon", href: "data:," }));
  try {
    const page = JSON.parse(source.textContent);
    if (typeof DecompressionStream === "undefined")
      throw new Error("this browser is too old to unpack it (it has no DecompressionStream)");
    const live = new Live(root, page);
    window.pliant = {
      time: () => live.clock.time,
      seek: (t) => live.clock.seek(t),
      following: () => live.clock.following,
      rows: () => live.run?.times.length ?? 0,
      values: (name) =>
        Array.from(name === "time" ? live.run.times : live.run.byName.get(name).values),
      ready: live.begin().catch((error) => {
        live.alert.textContent = failure("The run", error);
        live.alert.hidden = false;
        throw error;
      }),
    };
  } catch (error) {
    root.append(make("p", { role: "alert" }, failure("The run", error)));
    throw error;
  }
}

start();
