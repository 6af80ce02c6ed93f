// The time of the replay.

/// Calls `changed` whenever time, playing or speed change.
export class Clock {
  constructor(changed) {
    this.changed = changed;
    this.from = this.to = this.time = 0;
    this.speed = 1;
    this.playing = false;
  }

  setSpan(from, to) {
    this.from = from;
    this.to = to;
    this.seek(this.time);
  }

  seek(time) {
    this.time = Math.min(Math.max(Number.isFinite(time) ? time : this.from, this.from), this.to);
    this.changed();
  }

  setSpeed(speed) {
    this.speed = speed;
    this.changed();
  }

  get moving() {
    return this.playing;
  }

  toggle() {
    if (this.moving) this.pause();
    else this.play();
  }

  play() {
    if (this.playing || !(this.to > this.from)) return;
    if (this.time >= this.to) this.time = this.from;
    this.playing = true;
    let last = performance.now();
    const frame = (now) => {
      const passed = Math.max(now - last, 0) / 1000;
      last = now;
      this.time = Math.min(this.time + passed * this.speed, this.to);
      if (this.time >= this.to) this.atEnd();
      else this.frame = requestAnimationFrame(frame);
      this.changed();
    };
    this.frame = requestAnimationFrame(frame);
    this.changed();
  }

  atEnd() {
    this.playing = false;
  }

  pause() {
    this.playing = false;
    cancelAnimationFrame(this.frame);
    this.changed();
  }
}
