// The parameters of a run that goes on: sliders, switches, buttons of modes.

import { make, nameText } from "./element.js";
import { makeControl } from "./parameter_controls.js";
import { throttled } from "./throttle.js";

const kPeriod = 50; // milliseconds from one change to the next
const kPlain = /::|^(number|number per joint|vector|matrix|bool|double|(unsigned )?int)$/; // no meaning
const kSettled = 300; // milliseconds after a change until what the run says is shown

/// `send(name, value)` passes on what the reader wants. What is allowed and what there is, is in the
/// page: {control, parameters, shown}. `memory` keeps which groups are open.
export class Parameters {
  constructor({ live, memory, send }) {
    Object.assign(this, { live, memory, send });
    this.open = new Set(memory.get("groups"));
    this.all = new Map(
      (live.parameters ?? []).map((about) => [about.name, new Parameter(about, this)]),
    );
    this.search = make("input", {
      type: "search",
      placeholder: "Find a parameter",
      "aria-label": "Find a parameter",
      oninput: () => this.#filter(),
    });
    this.none = make("p", { class: "quiet", hidden: true }, "No parameter has such a name.");
    this.alert = make("p", { role: "alert", hidden: true });
    this.element = make("section", { class: "parameters", hidden: !this.all.size });
    this.#build();
  }

  #build() {
    const shown = (this.live.shown ?? []).filter((name) => this.all.has(name));
    const groups = new Map();
    for (const [name, parameter] of this.all)
      if (!shown.includes(name)) {
        const block = name.slice(0, Math.max(name.lastIndexOf("."), 0));
        if (!groups.has(block)) groups.set(block, []);
        groups.get(block).push(parameter);
      }
    this.controls = ["first", "blocks"].map((name) =>
      make("fieldset", { class: name, disabled: !this.live.control }),
    );
    const [first, blocks] = this.controls;
    first.append(...shown.map((name) => this.all.get(name).row(name)));
    this.groups = [...groups].map(([block, parameters]) => this.#group(block, parameters));
    this.element.append(make("h3", {}, "Parameters"));
    if (!this.live.control)
      this.element.append(
        make(
          "p",
          { class: "quiet" },
          "They can only be read here: ",
          make("code", {}, "--control"),
          " on the command line allows changes.",
        ),
      );
    blocks.append(...this.groups.map(({ details }) => details));
    this.element.append(this.alert, first);
    for (const group of this.groups) this.#fill(group);
    if (this.groups.length) this.element.append(this.search, blocks, this.none);
  }

  #group(block, parameters) {
    const details = make(
      "details",
      { class: "block", open: this.open.has(block) },
      make(
        "summary",
        { onclick: () => this.#remember(block, !details.open) },
        make("span", { class: "path" }, ...nameText(block || "others")),
        make("span", { class: "unit" }, String(parameters.length)),
      ),
    );
    const group = { block, details, parameters };
    details.addEventListener("toggle", () => this.#fill(group));
    return group;
  }

  /// What the reader wants open. Asked at the click: a toggle comes later, when a search may have begun.
  #remember(block, open) {
    if (this.searching) return;
    if (open) this.open.add(block);
    else this.open.delete(block);
    this.memory.set("groups", [...this.open]);
  }

  /// Hundreds of controls are made when they are seen.
  #fill(group) {
    if (!group.details.open || group.filled) return;
    group.filled = true;
    const short = (name) => name.slice(group.block ? group.block.length + 1 : 0);
    group.details.append(...group.parameters.map((one) => one.row(short(one.about.name))));
    this.#filter();
  }

  #filter() {
    const wanted = this.search.value.toLowerCase().split(/\s+/).filter(Boolean);
    const matches = ({ words }) => wanted.every((word) => words.includes(word));
    this.searching = wanted.length > 0;
    let found = 0;
    for (const group of this.groups) {
      const count = group.parameters.filter(matches).length;
      found += count;
      group.details.hidden = count === 0;
      group.details.open = this.searching || this.open.has(group.block);
      this.#fillQuietly(group);
      for (const one of group.parameters) if (one.element) one.element.hidden = !matches(one);
    }
    this.none.hidden = found > 0;
  }

  #fillQuietly(group) {
    if (group.details.open && !group.details.hidden && !group.filled) this.#fill(group);
  }

  // ---- what the run says -----------------------------------------------------------------------

  get names() {
    return [...this.all.keys()];
  }

  /// Values that hold: [{name, value}].
  take(values) {
    for (const { name, value } of values) this.all.get(name)?.hear(value);
  }

  /// Something was refused.
  tell(message) {
    this.alert.textContent = message;
    this.alert.hidden = !message;
  }

  wants(name, value) {
    this.tell("");
    this.send(name, value);
  }

  /// Nobody listens any more.
  disable() {
    for (const fieldset of this.controls) fieldset.disabled = true;
  }
}

class Parameter {
  constructor(about, panel) {
    this.about = about;
    this.value = about.value;
    this.words = [about.name, about.about, about.unit].join(" ").toLowerCase();
    this.changed = -Infinity;
    this.pass = throttled(kPeriod, (value) => panel.wants(about.name, value));
  }

  /// Its line in the panel.
  row(title) {
    const { about } = this;
    this.control = makeControl({ ...about, value: this.value }, (value) => this.#want(value));
    this.again = make(
      "button",
      {
        type: "button",
        class: "plain again",
        title: `Back to what it was at the start of the run: ${textOf(about.value)}`,
        "aria-label": `${about.name} as at the start`,
        onclick: () => {
          this.control.show(about.value);
          this.#want(about.value);
        },
      },
      "reset",
    );
    this.element = make(
      "div",
      { class: `parameter ${about.kind}`, "data-name": about.name },
      make(
        "div",
        { class: "head" },
        make("span", { class: "path", title: about.name }, ...nameText(title)),
        make("span", { class: "unit" }, about.unit ? `[${about.unit}]` : ""),
        make("span", { class: "about" }, kPlain.test(about.about) ? "" : (about.about ?? "")),
        this.again,
      ),
      this.control.element,
    );
    this.#show();
    return this.element;
  }

  #show() {
    this.control?.show(this.value);
    this.#showAgain();
  }

  #showAgain() {
    if (this.again) this.again.hidden = textOf(this.value) === textOf(this.about.value);
  }

  #want(value) {
    this.value = value;
    this.changed = performance.now();
    this.#showAgain();
    this.pass(value);
  }

  /// While a slider moves, what the run says is of the past.
  hear(value) {
    if (value === undefined || value === null) return;
    this.heard = value;
    const wait = this.changed + kSettled - performance.now();
    clearTimeout(this.timer);
    if (wait > 0) this.timer = setTimeout(() => this.hear(this.heard), wait);
    else if (textOf(value) !== textOf(this.value)) {
      this.value = value;
      this.#show();
    }
  }
}

function textOf(value) {
  return Array.isArray(value) ? value.join(" ") : String(value);
}
