// Controls of one parameter, by its kind. Each has an element, and `show(value)` that sets it.

import { make, nameText } from "./element.js";

const kMostButtons = 6;

/// `change(value)` is called with what the reader wants.
export function makeControl(about, change) {
  const options = { label: about.name, change };
  switch (about.kind) {
    case "flag":
      return new Switch(options);
    case "word":
      return about.words.length > kMostButtons
        ? new Choice(options, about.words)
        : new Buttons(options, about.words);
    case "number":
      return new Slider({ ...options, whole: about.whole }, about.value);
    case "matrix":
      return about.rows === about.cols ? new SquareMatrix(options, about) : new List(options, about);
    case "numbers":
      return new List(options, about);
    default:
      throw new Error(`the parameter ${about.name} is of an unknown kind, “${about.kind}”`);
  }
}

// ---- numbers -----------------------------------------------------------------------------------

/// A number as one would type it.
export function numberText(value) {
  return Number.isFinite(value) ? String(Number(value.toPrecision(6))) : "";
}

/// What a slider spans that begins at a value: [least, greatest].
export function spanOf(value) {
  const greatest = 2 * Math.max(Math.abs(value) || 0, 1);
  return [value < 0 ? -greatest : 0, greatest];
}

/// A slider and a field for the number itself; a number beyond the slider makes it longer.
export class Slider {
  constructor({ label, change, text, whole }, start) {
    this.change = change;
    this.whole = whole;
    [this.least, this.greatest] = spanOf(start);
    this.range = make("input", {
      type: "range",
      step: "any",
      "aria-label": label,
      oninput: () => this.#wanted(this.#rounded(Number(this.range.value))),
    });
    this.field = make("input", {
      type: "number",
      step: "any",
      "aria-label": `${label}, number`,
      onchange: () => this.#typed(),
    });
    this.element = make("div", { class: "slider" }, this.range, this.field);
    if (text) this.element.prepend(make("span", { class: "of" }, text));
    this.show(start);
  }

  /// To a thousandth of what the slider spans.
  #rounded(value) {
    if (this.whole) return Math.round(value);
    const digits = 3 - Math.ceil(Math.log10(this.greatest - this.least));
    return Number(value.toFixed(Math.min(Math.max(digits, 0), 12)));
  }

  #typed() {
    if (this.field.value === "" || !Number.isFinite(Number(this.field.value)))
      return this.show(this.value);
    this.#wanted(Number(this.field.value));
  }

  #wanted(value) {
    this.show(value);
    this.change(value);
  }

  /// undefined: there is no one value.
  show(value) {
    this.value = value;
    if (value > this.greatest) this.greatest = 2 * value;
    if (value < this.least) this.least = -Math.max(this.greatest, 2 * Math.abs(value));
    this.greatest = Math.max(this.greatest, -this.least);
    this.range.min = this.least;
    this.range.max = this.greatest;
    this.range.value = Number.isFinite(value) ? value : 0;
    this.range.setAttribute("aria-valuetext", numberText(value) || "differing values");
    const text = numberText(value);
    if (this.field.value !== text) this.field.value = text;
    this.field.placeholder = value === undefined ? "various" : "–";
  }
}

function allEqual(values) {
  return values.every((value) => value === values[0]);
}

/// A part that is closed at first and made when it is opened.
function disclosure(title, makeContent) {
  const details = make(
    "details",
    {
      class: "more",
      ontoggle: () => {
        if (details.open && details.children.length === 1) details.append(...makeContent());
      },
    },
    make("summary", {}, title),
  );
  return details;
}

/// Numbers one by one, and one slider for all where all are equal at first.
class List {
  constructor({ label, change }, about) {
    this.values = [...about.value];
    this.singles = [];
    const set = (values) => {
      this.show(values);
      change(values);
    };
    this.element = make("div", { class: "many" });
    if (allEqual(about.value) && about.value.length > 1) {
      this.common = new Slider(
        { label, change: (value) => set(this.values.map(() => value)) },
        about.value[0],
      );
      this.element.append(this.common.element);
    }
    const names = this.values.map((_, i) => about.elements?.[i] ?? String(i + 1));
    const single = (name, i) =>
      new Slider(
        {
          label: `${label}, ${name}`,
          text: name,
          change: (value) => set(this.values.with(i, value)),
        },
        this.values[i],
      );
    this.element.append(
      disclosure(`${names.length} elements`, () => {
        this.singles = names.map(single);
        return this.singles.map((one) => one.element);
      }),
    );
  }

  show(values) {
    this.values = [...values];
    this.common?.show(allEqual(values) ? values[0] : undefined);
    this.singles.forEach((slider, i) => slider.show(values[i]));
  }
}

/// γ of γ I where the matrix is that at first; its diagonal, and all of it. Columns stand one after
/// the other.
class SquareMatrix {
  constructor({ label, change }, about) {
    this.size = about.rows;
    this.values = [...about.value];
    this.diagonal = [];
    this.entries = [];
    const set = (values) => {
      this.show(values);
      change(values);
    };
    this.element = make("div", { class: "many" });
    const gamma = multipleOfIdentity(this.values, this.size);
    if (gamma !== undefined) {
      this.common = new Slider(
        {
          label,
          text: "γ of γ I",
          change: (value) =>
            set(this.values.map((_, k) => (k % (this.size + 1) === 0 ? value : 0))),
        },
        gamma,
      );
      this.element.append(this.common.element);
    }
    const indices = Array.from({ length: this.size }, (_, i) => i);
    const at = (row, col) => col * this.size + row;
    const onDiagonal = (i) => {
      const name = about.elements?.[i] ?? `${i + 1}, ${i + 1}`;
      const options = {
        label: `${label}, ${name}`,
        text: name,
        change: (value) => set(this.values.with(at(i, i), value)),
      };
      return new Slider(options, this.values[at(i, i)]);
    };
    const entry = (row, col) => {
      const field = make("input", {
        type: "number",
        step: "any",
        "aria-label": `${label}, row ${row + 1}, column ${col + 1}`,
        onchange: () => {
          const value = Number(field.value);
          if (field.value === "" || !Number.isFinite(value)) this.show(this.values);
          else set(this.values.with(at(row, col), value));
        },
      });
      field.value = numberText(this.values[at(row, col)]);
      this.entries.push({ field, index: at(row, col) });
      return field;
    };
    this.element.append(
      disclosure("diagonal", () => {
        this.diagonal = indices.map(onDiagonal);
        return this.diagonal.map((one) => one.element);
      }),
      disclosure("all entries", () => [
        make(
          "div",
          { class: "matrix", style: `--columns: ${this.size}` },
          ...indices.flatMap((row) => indices.map((col) => entry(row, col))),
        ),
      ]),
    );
  }

  show(values) {
    this.values = [...values];
    this.common?.show(multipleOfIdentity(values, this.size));
    this.diagonal.forEach((slider, i) => slider.show(values[i * (this.size + 1)]));
    for (const { field, index } of this.entries) field.value = numberText(values[index]);
  }
}

/// γ if a square matrix is γ I, else undefined.
export function multipleOfIdentity(values, size) {
  const wanted = (k) => (k % (size + 1) === 0 ? values[0] : 0);
  return values.every((value, k) => value === wanted(k)) ? values[0] : undefined;
}

// ---- words and flags ---------------------------------------------------------------------------

class Switch {
  constructor({ label, change }) {
    this.element = make("button", {
      type: "button",
      role: "switch",
      class: "switch",
      "aria-label": label,
      onclick: () => {
        this.show(!this.value);
        change(this.value);
      },
    });
  }

  show(value) {
    this.value = value;
    this.element.setAttribute("aria-checked", String(value));
    this.element.textContent = value ? "on" : "off";
  }
}

class Buttons {
  constructor({ label, change }, words) {
    this.buttons = words.map((word) =>
      make(
        "button",
        {
          type: "button",
          onclick: () => {
            this.show(word);
            change(word);
          },
        },
        ...nameText(word),
      ),
    );
    this.words = words;
    this.element = make(
      "div",
      { class: "words", role: "group", "aria-label": label },
      ...this.buttons,
    );
  }

  show(value) {
    this.buttons.forEach((button, i) =>
      button.setAttribute("aria-pressed", String(this.words[i] === value)),
    );
  }
}

class Choice {
  constructor({ label, change }, words) {
    this.element = make(
      "select",
      { "aria-label": label, onchange: () => change(this.element.value) },
      ...words.map((word) => make("option", { value: word }, word)),
    );
  }

  show(value) {
    this.element.value = value;
  }
}
