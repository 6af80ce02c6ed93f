// Stacked time series: zoomed together, with one cursor and one time.

import uPlot from "uplot";

import { icon, make, nameText } from "./element.js";
import { unitsOf } from "./layout.js";
import { timeText, valueText } from "./number.js";
import { curveStyle } from "./palette.js";

const kFont = "12px system-ui, sans-serif";
const kAxisWidth = 70;
const kTimeAxisHeight = 44;
const kHeight = 172;
const kLineWidth = 1.4;
const kClickReach = 4; // pixels: what moves further is a drag
const kFlat = 1e-12; // values that differ by less are the same
const kClose = "M4 4l8 8M12 4l-8 8";

/// A plot of `names`: its legend, which shows the values at the cursor or at the time, and below it
/// the curves.
class Plot {
  constructor(plots, names, last) {
    this.plots = plots;
    this.run = plots.run;
    this.hidden = plots.hidden;
    this.columns = names.map((name) => this.run.byName.get(name));
    this.units = unitsOf(this.run, names);
    this.paths = [...new Set(this.columns.map((column) => column.path))];
    this.last = last;
    this.legend = make("div", { class: "legend" });
    this.canvas = make("div", { class: "curves" });
    this.now = make("div", { class: "now" });
    const units = this.units
      .filter(Boolean)
      .map((unit) => `in ${unit}`)
      .join(" and ");
    this.element = make(
      "figure",
      {
        class: "plot",
        tabindex: 0,
        role: "group",
        "aria-label":
          `Plot of ${this.paths.join(" and ")} ${units} over time; arrow keys move the ` +
          "time, plus and minus zoom, 0 shows all",
        onkeydown: (event) => plots.key(event, this),
      },
      make("div", { class: "head" }, this.legend, this.#closeButton()),
      this.canvas,
    );
  }

  #closeButton() {
    return make(
      "button",
      {
        type: "button",
        class: "plain close",
        title: "Take this plot away",
        "aria-label": `Take away the plot of ${this.paths.join(" and ")}`,
        onclick: () => this.plots.onClose(this.columns.map((column) => column.name)),
      },
      icon(kClose),
    );
  }

  // ---- legend ----------------------------------------------------------------------------------

  #styleOf(column) {
    const element = this.run.paths().get(column.path).indexOf(column);
    return curveStyle(this.plots.palette, element, this.paths.indexOf(column.path));
  }

  makeLegend() {
    this.legend.replaceChildren();
    this.values = new Map();
    for (const path of this.paths) {
      const columns = this.columns.filter((column) => column.path === path);
      const title = make(
        "div",
        { class: "title" },
        make("span", { class: "path" }, ...nameText(path)),
      );
      title.append(unitText(columns[0].unit));
      const letters = Math.max(...columns.map((column) => column.element.length), 4);
      const entries = make("div", { class: "entries", style: `--letters: ${letters}ch` });
      for (const column of columns) entries.append(this.#entry(column));
      this.legend.append(title, entries);
    }
    this.showValues(this.plots.clock.time);
  }

  #entry(column) {
    const { colour, dash } = this.#styleOf(column);
    const sample = document.createElementNS("http://www.w3.org/2000/svg", "svg");
    sample.setAttribute("class", "sample");
    sample.setAttribute("aria-hidden", "true");
    const line = document.createElementNS("http://www.w3.org/2000/svg", "line");
    for (const [name, value] of Object.entries({ x1: 0, x2: 18, y1: 5, y2: 5, stroke: colour }))
      line.setAttribute(name, value);
    line.setAttribute("stroke-dasharray", dash.join(" "));
    sample.append(line);
    const value = make("span", { class: "value" });
    this.values.set(column, value);
    const shown = () => !this.hidden.has(column.name);
    const button = make(
      "button",
      {
        type: "button",
        class: "entry",
        "aria-pressed": String(shown()),
        title: column.name,
        onclick: () => {
          if (shown()) this.hidden.add(column.name);
          else this.hidden.delete(column.name);
          button.setAttribute("aria-pressed", String(shown()));
          this.chart.setSeries(this.columns.indexOf(column) + 1, { show: shown() });
          this.plots.onHide?.();
        },
      },
      sample,
      make("span", { class: "element" }, column.element || "value"),
      value,
    );
    return button;
  }

  showValues(t) {
    for (const [column, element] of this.values)
      element.textContent = valueText(
        this.run.valueAt(column, t),
        column.greatest,
        column.step === 1,
      );
  }

  // ---- curves ----------------------------------------------------------------------------------

  make(width) {
    this.chart?.destroy();
    this.canvas.replaceChildren();
    this.makeLegend();
    this.chart = new uPlot(this.#options(width), this.data(), this.canvas);
    this.chart.over.append(this.now);
    this.#listen();
    this.showTime();
  }

  data() {
    const rows = this.run.rowsFor(...this.plots.window);
    return [
      this.run.times.subarray(...rows),
      ...this.columns.map((column) => withGaps(column.values.subarray(...rows))),
    ];
  }

  #options(width) {
    const { palette } = this.plots;
    const axis = {
      stroke: palette.grey,
      font: kFont,
      labelFont: kFont,
      grid: { stroke: palette.grid, width: 1 },
      ticks: { show: false },
    };
    const ofUnit = (unit, index) => ({
      ...axis,
      scale: `unit${index}`,
      side: index ? 1 : 3,
      label: unit || " ",
      labelSize: 18,
      labelGap: 0,
      size: kAxisWidth - 18,
      gap: 6,
      grid: { ...axis.grid, show: index === 0 },
      values: (_, ticks) => tickTexts(ticks),
      space: 28,
    });
    return {
      width,
      height: this.height,
      padding: [8, this.#roomOnTheRight(), this.last ? 0 : 8, 0],
      legend: { show: false },
      scales: {
        x: { time: false },
        ...Object.fromEntries(this.units.map((_, i) => [`unit${i}`, { range: spanOfValues }])),
      },
      series: [
        {},
        ...this.columns.map((column) => {
          const { colour, dash } = this.#styleOf(column);
          return {
            scale: `unit${this.units.indexOf(column.unit)}`,
            stroke: colour,
            dash,
            width: kLineWidth,
            show: !this.hidden.has(column.name),
            points: { show: false },
          };
        }),
      ],
      axes: [
        {
          ...axis,
          label: this.last ? "time [s]" : undefined,
          labelSize: 16,
          labelGap: 0,
          gap: 6,
          size: this.last ? kTimeAxisHeight - 16 : 0,
          values: (_, ticks) => (this.last ? tickTexts(ticks) : ticks.map(() => "")),
          space: 64,
        },
        ...this.units.map(ofUnit),
      ],
      cursor: {
        y: false,
        points: { size: 6, width: 1 },
        drag: { x: true, y: false, dist: kClickReach },
        sync: {
          key: "pliant",
          setSeries: false,
          filters: { pub: (type) => type === "mousemove" || type === "mouseleave" },
        },
        bind: { dblclick: () => () => this.plots.zoomTo(null, true) },
      },
      hooks: {
        drawClear: [(chart) => this.#drawBands(chart)],
        setScale: [(chart, key) => key === "x" && this.plots.zoomed(chart)],
        setCursor: [(chart) => this.#cursorMoved(chart)],
        draw: [() => this.showTime()],
      },
    };
  }

  /// All plots end where one does that has a second axis.
  #roomOnTheRight() {
    if (this.units.length > 1) return 0;
    return this.plots.anyRight ? kAxisWidth : 10;
  }

  get height() {
    return kHeight + (this.last ? kTimeAxisHeight : 0);
  }

  #drawBands(chart) {
    const { ctx, bbox } = chart;
    const { palette } = this.plots;
    const bands = this.run.description.bands ?? [];
    const edge = (t) =>
      Math.min(Math.max(chart.valToPos(t, "x", true), bbox.left), bbox.left + bbox.width);
    ctx.save();
    for (const { from, to, label } of bands) {
      const [left, right] = [edge(from), edge(to)];
      if (right <= left) continue;
      ctx.globalAlpha = 0.4;
      ctx.fillStyle = palette.grid;
      ctx.fillRect(left, bbox.top, right - left, bbox.height);
      if (!label || this.plots.plots[0] !== this) continue;
      ctx.globalAlpha = 1;
      ctx.fillStyle = palette.grey;
      ctx.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
      ctx.textBaseline = "top";
      ctx.textAlign = "left";
      const inset = 4 * devicePixelRatio;
      if (ctx.measureText(label).width + 2 * inset < right - left)
        ctx.fillText(label, left + inset, bbox.top + inset);
    }
    ctx.restore();
  }

  #cursorMoved(chart) {
    const { left } = chart.cursor;
    this.showValues(left >= 0 ? chart.posToVal(left, "x") : this.plots.clock.time);
    this.plots.pointed(left >= 0 ? chart.posToVal(left, "x") : null);
  }

  #listen() {
    const { over } = this.chart;
    let pressed = null;
    over.addEventListener("pointerdown", (event) => (pressed = event.clientX));
    over.addEventListener("click", (event) => {
      if (pressed === null || Math.abs(event.clientX - pressed) > kClickReach) return;
      const left = event.clientX - over.getBoundingClientRect().left;
      this.plots.clock.seek(this.chart.posToVal(left, "x"));
    });
  }

  showTime() {
    if (!this.chart) return;
    const left = this.chart.valToPos(this.plots.clock.time, "x");
    const inside = left >= -0.5 && left <= this.chart.over.clientWidth + 0.5;
    this.now.style.display = inside ? "" : "none";
    this.now.style.transform = `translateX(${left.toFixed(2)}px)`;
  }
}

/// All plots of a run, in `root`. `onClose` is told the names in a plot that is taken away,
/// `onZoom` whether less than all is seen and whether a hand in a plot has wanted so, `onHide` that a
/// curve is hidden or shown again.
export class Plots {
  constructor({ root, clock, onClose, onZoom, onPoint, onHide }) {
    Object.assign(this, { root, clock, onClose, onZoom, onPoint, onHide });
    this.plots = [];
    this.hidden = new Set();
    this.zoom = null;
    new ResizeObserver(() => this.#resize()).observe(root);
  }

  show(run, layout, palette) {
    if (run !== this.run && this.zoom && (this.zoom[0] >= run.to || this.zoom[1] <= run.from))
      this.zoom = null;
    for (const plot of this.plots) plot.chart?.destroy();
    this.run = run;
    this.palette = palette;
    this.hidden = new Set([...this.hidden].filter((name) => layout.flat().includes(name)));
    this.anyRight = layout.some((names) => unitsOf(run, names).length > 1);
    this.plots = layout.map((names, i) => new Plot(this, names, i === layout.length - 1));
    this.root.replaceChildren(...this.plots.map((plot) => plot.element));
    if (!layout.length)
      this.root.append(make("p", { class: "quiet" }, "No signal is chosen. “Signals” lists them."));
    this.width = Math.floor(this.root.clientWidth);
    const zoom = this.zoom;
    this.sharing = true; // a chart tells of its first scale too
    for (const plot of this.plots) plot.make(this.width);
    this.sharing = false;
    this.zoomTo(zoom);
  }

  #resize() {
    const width = Math.floor(this.root.clientWidth);
    if (!this.run || !width || width === this.width) return;
    this.width = width;
    for (const plot of this.plots) plot.chart.setSize({ width, height: plot.height });
  }

  showTime() {
    for (const plot of this.plots) {
      plot.showTime();
      if (!(plot.chart.cursor.left >= 0)) plot.showValues(this.clock.time);
    }
  }

  pointed(t) {
    if (this.onPoint)
      this.onPoint(t === null ? "" : `${timeText(t, this.run.to - this.run.from)} s`);
  }

  // ---- zoom ------------------------------------------------------------------------------------

  get window() {
    return this.zoom ?? [this.run.from, this.run.to];
  }

  /// One plot has another scale now: so have all.
  zoomed(chart) {
    const { min, max } = chart.scales.x;
    if (!this.sharing && min != null) this.zoomTo([min, max], true);
  }

  /// null: all of the run.
  zoomTo(zoom, byHand = false) {
    const { from, to } = this.run;
    if (zoom) zoom = [Math.max(zoom[0], from), Math.min(zoom[1], to)];
    const least = 4 * ((to - from) / Math.max(this.run.times.length, 4));
    if (zoom && !(zoom[1] - zoom[0] >= Math.min(least, to - from))) zoom = this.zoom;
    if (zoom && zoom[0] <= from && zoom[1] >= to) zoom = null;
    this.#setWindow(zoom, true);
    this.onZoom(zoom, byHand);
  }

  /// Shows a window of a run that goes on, which may reach beyond its last row.
  follow(window) {
    this.#setWindow(window, false);
  }

  /// Shows the rows that have come.
  refresh() {
    this.#setWindow(this.zoom, false);
  }

  #setWindow(zoom, unselect) {
    this.zoom = zoom;
    const [min, max] = this.window;
    this.sharing = true;
    for (const plot of this.plots)
      plot.chart.batch(() => {
        if (unselect) plot.chart.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
        if (this.run.grows) plot.chart.setData(plot.data(), false);
        plot.chart.setScale("x", { min, max: max > min ? max : min + 1 });
      });
    this.sharing = false;
  }

  /// Narrower by `factor` about the time, if that is seen, or else about the middle.
  zoomBy(factor) {
    const [min, max] = this.window;
    const { time } = this.clock;
    const about = time >= min && time <= max ? time : (min + max) / 2;
    this.zoomTo([about - (about - min) / factor, about + (max - about) / factor], true);
  }

  key(event, plot) {
    if (event.target !== plot.element || event.ctrlKey || event.metaKey || event.altKey) return;
    const [min, max] = this.window;
    const step = (max - min) / (event.shiftKey ? 20 : 200);
    const acts = {
      ArrowLeft: () => this.clock.seek(this.clock.time - step),
      ArrowRight: () => this.clock.seek(this.clock.time + step),
      Home: () => this.clock.seek(min),
      End: () => this.clock.seek(max),
      "+": () => this.zoomBy(1.5),
      "=": () => this.zoomBy(1.5),
      "-": () => this.zoomBy(1 / 1.5),
      0: () => this.zoomTo(null, true),
      Escape: () => this.zoomTo(null, true),
    };
    if (!acts[event.key]) return;
    acts[event.key]();
    event.preventDefault();
  }
}

/// What an axis spans; about values that do not differ it is a little wider than they are.
function spanOfValues(chart, least, greatest) {
  if (least === null) return [null, null];
  if (greatest - least > kFlat) return uPlot.rangeNum(least, greatest, 0.1, true);
  const around = Math.max(0.1 * Math.abs(least), 1e-3);
  return [least - around, greatest + around];
}

/// uPlot leaves a gap at null, not at NaN.
function withGaps(values) {
  return values.some(Number.isNaN)
    ? Array.from(values, (v) => (Number.isNaN(v) ? null : v))
    : values;
}

function unitText(unit) {
  return make("span", { class: "unit" }, unit ? `[${unit}]` : "");
}

/// All ticks with the digits of the finest.
function tickTexts(ticks) {
  const greatest = Math.max(...ticks.map(Math.abs));
  if (greatest >= 1e6 || (greatest > 0 && greatest < 1e-4))
    return ticks.map((v) =>
      v === 0 ? "0" : v.toExponential(1).replace(/e\+?/, "e").replace(/-/g, "−"),
    );
  const step = ticks.length > 1 ? Math.abs(ticks[1] - ticks[0]) : 1;
  let digits = 0;
  while (digits < 9 && Math.abs(step * 10 ** digits - Math.round(step * 10 ** digits)) > 1e-6)
    ++digits;
  return ticks.map((v) => v.toFixed(digits).replace("-", "−"));
}
