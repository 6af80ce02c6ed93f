// Play, speed and time.

import { icon, make } from "./element.js";
import { timeText } from "./number.js";

const kPlay = "M4 2.5v11l9-5.5z";
const kPause = "M4 2.5h3v11H4zM9 2.5h3v11H9z";
const kSpeeds = [0.1, 0.25, 0.5, 1, 2];
const kSteps = 10000;

export class Transport {
  constructor(clock) {
    this.clock = clock;
    this.button = make("button", { type: "button", class: "play", onclick: () => clock.toggle() });
    this.slider = make("input", {
      type: "range",
      min: 0,
      max: kSteps,
      step: 1,
      "aria-label": "Time",
      oninput: () =>
        clock.seek(clock.from + (this.slider.value / kSteps) * (clock.to - clock.from)),
    });
    this.time = make("output", { class: "time" });
    this.speed = make(
      "select",
      {
        "aria-label": "Speed",
        title: "Speed",
        onchange: () => clock.setSpeed(Number(this.speed.value)),
      },
      ...kSpeeds.map((speed) =>
        make("option", { value: speed, selected: speed === 1 }, `${speed}×`),
      ),
    );
    this.element = make(
      "div",
      { class: "transport", role: "group", "aria-label": "Replay" },
      this.button,
      this.slider,
      this.time,
      this.speed,
    );
    this.show();
  }

  show() {
    const { clock } = this;
    const span = clock.to - clock.from;
    if (this.moving !== clock.moving) {
      this.moving = clock.moving;
      this.button.replaceChildren(icon(this.moving ? kPause : kPlay));
      this.button.setAttribute("aria-label", this.moving ? "Pause" : "Play");
      this.button.title = this.moving ? "Pause (space)" : "Play (space)";
    }
    this.slider.value = span > 0 ? Math.round(((clock.time - clock.from) / span) * kSteps) : 0;
    const now = timeText(clock.time, span);
    this.slider.setAttribute("aria-valuetext", `${now} s`);
    const all = `${now} / ${timeText(clock.to, span)} s`;
    if (this.time.textContent !== all) this.time.textContent = all;
  }
}
