// @ts-check
/** The slider of a record: play, stop, seek, marks. */

import { element } from "./panel.js";

/** @typedef {{t: number, text: string, bad?: boolean, x: number, y: number, run: number}} Mark */

export class Replay {
  /** @param {import("./timeline.js").Timeline} timeline */
  constructor(timeline) {
    this.timeline = timeline;
    this.isOn = false;
    this.plays = false;
    this.clock = 0;
    this.rate = 1;
    this.slider = /** @type {HTMLInputElement} */ (element("slider"));
    this.slider.oninput = () => {
      this.plays = false;
      this.clock = Number(this.slider.value);
    };
    element("play").onclick = () => this.toggle();
    const rate = /** @type {HTMLSelectElement} */ (element("rate"));
    rate.onchange = () => {
      this.rate = Number(rate.value);
    };
  }

  begin() {
    this.isOn = true;
    this.plays = true;
    this.clock = this.timeline.first;
    element("replay").hidden = false;
    document.body.classList.add("replays");
    this.slider.min = String(this.timeline.first);
    this.slider.max = String(this.timeline.last);
  }

  toggle() {
    this.plays = !this.plays;
    if (this.plays && this.clock >= this.timeline.last) this.clock = this.timeline.first;
  }

  /** @param {number} clock in s */
  seek(clock) {
    this.clock = Math.min(this.timeline.last, Math.max(this.timeline.first, clock));
    this.plays = false;
  }

  /** Return the clock after some time has passed. @param {number} dt in s */
  advance(dt) {
    if (this.plays) this.clock = Math.min(this.timeline.last, this.clock + dt * this.rate);
    if (this.clock >= this.timeline.last) this.plays = false;
    return this.clock;
  }

  /** Return whether a key was for the record. @param {string} code */
  key(code) {
    if (!this.isOn) return false;
    if (code === "Space") this.toggle();
    else if (code === "ArrowLeft" || code === "ArrowRight") {
      const at = this.timeline.index(this.clock) + (code === "ArrowRight" ? 1 : -1);
      const frame = this.timeline.frames[Math.max(0, Math.min(this.timeline.frames.length - 1, at))];
      this.seek(frame.clock);
    } else return false;
    return true;
  }

  show() {
    if (!this.isOn) return;
    this.slider.value = String(this.clock);
    element("play").textContent = this.plays ? "❚❚" : "▶";
    element("clock").textContent = `${this.clock.toFixed(1)} / ${this.timeline.last.toFixed(1)} s`;
  }

  /** @param {Mark[]} marks */
  showMarks(marks) {
    if (!this.isOn) return;
    const span = this.timeline.last - this.timeline.first || 1;
    element("ticks").replaceChildren(
      ...marks.map((mark) => {
        const button = document.createElement("button");
        button.style.left = `${(100 * (mark.t - this.timeline.first)) / span}%`;
        button.title = `${mark.t.toFixed(1)} s: ${mark.text}`;
        button.setAttribute("aria-label", button.title);
        button.classList.toggle("second", mark.run > 0);
        button.onclick = () => this.seek(mark.t - 2);
        return button;
      }),
    );
  }
}
