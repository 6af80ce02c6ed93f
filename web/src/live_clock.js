// The time of a run that goes on.

import { Clock } from "./clock.js";

/// A clock that follows the newest row of a run, until somebody looks at a time of the past.
export class LiveClock extends Clock {
  constructor(changed) {
    super(changed);
    this.running = true; // rows may still come
    this.following = true;
  }

  /// The run has rows from `from` to `to` now.
  setSpan(from, to) {
    this.from = from;
    this.to = to;
    const time = this.following ? to : this.time;
    this.time = Math.min(Math.max(time, from), to);
    this.changed();
  }

  follow() {
    if (!this.running) return;
    super.pause();
    this.following = true;
    this.setSpan(this.from, this.to);
  }

  /// Stays at the time that is shown.
  freeze() {
    if (!this.following) return;
    this.following = false;
    this.changed();
  }

  toggleFollowing() {
    if (!this.running) this.toggle();
    else if (this.moving) this.pause();
    else this.follow();
  }

  end() {
    this.running = false;
    this.freeze();
  }

  // ---- of a clock ------------------------------------------------------------------------------

  get moving() {
    return this.playing || this.following;
  }

  seek(time) {
    this.following = false;
    super.seek(time);
  }

  /// From the past to the newest row, which is followed then.
  play() {
    if (this.running && this.time >= this.to) this.follow();
    else super.play();
  }

  pause() {
    this.following = false;
    super.pause();
  }

  atEnd() {
    super.atEnd();
    if (this.running) this.following = true;
  }
}
