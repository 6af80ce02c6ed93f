// A run to look at: its plots, and beside them the robot at the time that is marked in them.

import { Chooser } from "./chooser.js";
import { make } from "./element.js";
import { readPalette, watchScheme } from "./palette.js";
import { Plots } from "./plots.js";
import { RobotView } from "./robot_view.js";
import { Transport } from "./transport.js";

/// `root` is the section that holds it; `clock` tells it by `timeChanged` when its time has changed.
/// `onZoom` is told what of the run is seen and whether a hand in a plot has wanted so, `onChange`
/// that the reader has chosen what is shown, `onSpace` that space was pressed.
export class Stage {
  constructor({ root, robot, clock, onSpace, onZoom, onChange }) {
    Object.assign(this, { root, clock, onSpace, onZoom, onChange });
    this.palette = readPalette();
    this.transport = new Transport(clock);
    this.chooser = new Chooser((layout) => this.setLayout(layout));
    this.panels = make("div", { class: "plots" });
    this.plots = new Plots({
      root: this.panels,
      clock,
      onClose: (names) =>
        this.setLayout(this.layout.filter((plot) => !plot.some((name) => names.includes(name)))),
      onZoom: (zoom, byHand) => {
        this.all.disabled = !zoom;
        this.onZoom?.(zoom, byHand);
      },
      onPoint: (text) => (this.pointer.textContent = text),
      onHide: () => this.onChange?.(),
    });
    this.note = make("p", { class: "quiet" });
    this.#build(robot);
    watchScheme(() => this.#recolour());
    document.addEventListener("keydown", (event) => this.#key(event));
    new IntersectionObserver(([entry]) => (this.inSight = entry.isIntersecting)).observe(root);
  }

  // ---- the page --------------------------------------------------------------------------------

  #build(robot) {
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
      { type: "button", disabled: true, onclick: () => this.plots.zoomTo(null, true) },
      "Show all",
    );
    this.pointer = make("span", { class: "pointer", "aria-hidden": "true" });
    this.tools = make("div", { class: "tools" }, this.signals, this.all, this.pointer);
    this.left = make("div", { class: "left" }, this.tools, this.chooser.element, this.panels);
    this.right = make("div", { class: "right" }, this.#makeView(robot), this.transport.element);
    this.element = make("div", { class: "stage", id: "replay-stage" }, this.right, this.left);
  }

  #makeView(robot) {
    const frame = make("div", { class: "view" });
    this.frame = frame;
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
      this.#noView(error);
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
    this.viewTools = make("div", { class: "view-tools" }, path, reset);
    frame.append(this.forces, this.viewTools);
    new ResizeObserver(() => this.view?.resize()).observe(canvas);
    return frame;
  }

  #noView(error) {
    this.view = null;
    const reason = /webgl/i.test(error.message)
      ? "The 3-D view needs WebGL, which this browser does not offer here."
      : `The robot cannot be shown: ${error.message}.`;
    this.frame.replaceChildren(
      make("p", { class: "quiet", role: "note" }, `${reason} The plots work without it.`),
    );
    this.frame.classList.add("without");
  }

  // ---- what is shown ---------------------------------------------------------------------------

  show(run, layout) {
    this.shown = run;
    this.layout = layout;
    this.element.setAttribute("aria-label", run.title || "Run");
    this.#showPlots();
    try {
      this.view?.setRun(run, this.palette);
    } catch (error) {
      this.#noView(error);
    }
  }

  setLayout(layout) {
    this.layout = layout;
    this.#showPlots();
    this.onChange?.();
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

  timeChanged() {
    this.transport.show();
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

  /// Space is for the clock, unless it means something where the focus is.
  #key(event) {
    if (event.key !== " " || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.target.closest?.("input:not([type=range]), select, textarea, button, a, summary"))
      return;
    if (!this.inSight || (event.target !== document.body && !this.root.contains(event.target)))
      return;
    event.preventDefault();
    this.onSpace();
  }
}

/// What mouse and keys do: pairs of what is done and what that does.
export function makeHelp(keys) {
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

export function failure(what, error) {
  return `${what} cannot be shown: ${error.message.replace(/\.$/, "")}.`;
}
