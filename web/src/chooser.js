// Which signals are plotted, and in which plot.

import { make, nameText } from "./element.js";
import { plotOf, takes, withNames, without } from "./layout.js";

/// A panel that lists all signals of a run by path. `changed` is told the new layout.
export class Chooser {
  constructor(changed) {
    this.changed = changed;
    this.open = new Set();
    this.search = make("input", {
      type: "search",
      placeholder: "Find a signal",
      "aria-label": "Find a signal",
      oninput: () => this.#filter(),
    });
    this.list = make("div", { class: "signals" });
    this.none = make("p", { class: "quiet", hidden: true }, "No signal has such a name.");
    this.element = make(
      "div",
      { class: "chooser", id: "replay-signals", hidden: true },
      this.search,
      this.list,
      this.none,
    );
  }

  show(run, layout) {
    this.run = run;
    this.layout = layout;
    const focus = this.list.contains(document.activeElement) && document.activeElement.dataset.key;
    const scroll = this.list.scrollTop;
    this.list.replaceChildren(
      ...[...run.paths()].map(([path, columns]) => this.#group(path, columns)),
    );
    this.list.scrollTop = scroll;
    if (focus) this.list.querySelector(`[data-key="${CSS.escape(focus)}"]`)?.focus();
    this.#filter();
  }

  #group(path, columns) {
    const names = columns.map((column) => column.name);
    const plotted = names.filter((name) => plotOf(this.layout, name) >= 0);
    const all = this.#check(`path ${path}`, names, plotted.length === names.length);
    all.indeterminate = plotted.length > 0 && plotted.length < names.length;
    const label = make(
      "label",
      {},
      all,
      make("span", { class: "path" }, ...nameText(path)),
      unitOf(columns[0]),
    );
    const row = make("div", { class: "row" }, label);
    const group = make("div", { class: "group", "data-words": words(path, columns) }, row);
    if (columns.length > 1) {
      const elements = make(
        "div",
        { class: "elements", hidden: !this.open.has(path) },
        ...columns.map((column) => this.#element(column)),
      );
      row.append(this.#opener(path, columns.length, elements));
      group.append(elements);
    }
    if (plotted.length) row.append(this.#plotSelect(path, plotted));
    return group;
  }

  #element(column) {
    const check = this.#check(column.name, [column.name], plotOf(this.layout, column.name) >= 0);
    return make("label", {}, check, column.element || column.name);
  }

  #check(key, names, checked) {
    const check = make("input", {
      type: "checkbox",
      "data-key": key,
      onchange: () => this.changed(check.checked ? this.#with(names) : without(this.layout, names)),
    });
    check.checked = checked;
    return check;
  }

  /// An element joins the others of its path; a path of which nothing is shown gets a plot.
  #with(names) {
    const path = this.run.byName.get(names[0]).path;
    const columns = this.run
      .paths()
      .get(path)
      .map((column) => column.name);
    const index = Math.max(...columns.map((name) => plotOf(this.layout, name)));
    const wanted = columns.filter(
      (name) => names.includes(name) || (index >= 0 && this.layout[index].includes(name)),
    );
    return withNames(this.layout, wanted, index);
  }

  #opener(path, count, elements) {
    const button = make(
      "button",
      {
        type: "button",
        class: "plain",
        "data-key": `open ${path}`,
        "aria-expanded": String(!elements.hidden),
        "aria-label": `Elements of ${path}`,
        onclick: () => {
          elements.hidden = !elements.hidden;
          button.setAttribute("aria-expanded", String(!elements.hidden));
          if (elements.hidden) this.open.delete(path);
          else this.open.add(path);
        },
      },
      `${count} elements`,
    );
    return button;
  }

  #plotSelect(path, names) {
    const here = plotOf(this.layout, names[0]);
    const options = this.layout.map((plot, i) =>
      make(
        "option",
        { value: i, selected: i === here, disabled: !takes(this.run, plot, names) },
        `plot ${i + 1}`,
      ),
    );
    const alone = this.layout[here].every((name) => names.includes(name));
    if (!alone) options.push(make("option", { value: -1 }, "a plot of its own"));
    const select = make(
      "select",
      {
        "aria-label": `Plot of ${path}`,
        "data-key": `plot ${path}`,
        disabled: options.length < 2,
        onchange: () => this.changed(withNames(this.layout, names, Number(select.value))),
      },
      ...options,
    );
    return select;
  }

  #filter() {
    const wanted = this.search.value.toLowerCase().split(/\s+/).filter(Boolean);
    let found = 0;
    for (const group of this.list.children) {
      group.hidden = !wanted.every((word) => group.dataset.words.includes(word));
      if (!group.hidden) ++found;
    }
    this.none.hidden = found > 0;
  }
}

function words(path, columns) {
  return [path, ...columns.map((column) => column.name), columns[0].unit].join(" ").toLowerCase();
}

function unitOf(column) {
  return make("span", { class: "unit" }, column.unit ? `[${column.unit}]` : "");
}
