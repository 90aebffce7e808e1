// The moving body: play, pause, a slider of time, speed, and what is proven at the time shown.
import { element } from "../src/elements.js";
import { Drawing, magnifications } from "./figure.js";
import { intervalNode, lower, upper, widthText } from "./intervals.js";

const speeds = [1, 0.5, 0.25, 0.1];

function choice(label, options, chosen, choose) {
  const select = element("select", {}, ...options.map(([value, words]) => element("option", { value }, words)));
  select.value = String(chosen);
  select.addEventListener("change", () => choose(Number(select.value)));
  return element("label", {}, `${label} `, select);
}

// quantities: [{name, unit, of: slab => [lo, hi]}]; showTime is called with each time shown.
export class Player {
  constructor({ motion, reached, openWords, quantities, showTime }) {
    Object.assign(this, { motion, reached, openWords, quantities, showTime });
    this.drawing = new Drawing(motion.figure, motion.slabs.map(({ points }) => points), "The body from the side at the time shown");
    this.speed = 0.25;
    this.button = element("button", { type: "button", id: "play" }, "play");
    this.slider = element("input", { type: "range", id: "time", min: 0, max: motion.duration, step: "any", value: 0, "aria-label": "time" });
    this.reading = element("output", { id: "time-reading", for: "time" });
    this.button.addEventListener("click", () => (this.playing ? this.pause() : this.play()));
    this.slider.addEventListener("input", () => {
      this.pause();
      this.show(Number(this.slider.value));
    });
    this.rows = quantities.map(({ name, unit }) => {
      const [interval, width] = [intervalNode(), element("td", { class: "width" })];
      const row = element("tr", {}, element("th", { scope: "row" }, `${name}, ${unit}`), element("td", {}, interval), width);
      return { interval, width, row };
    });
    const head = element("tr", {}, ...["", "between", "width"].map((word) => element("th", { scope: "col" }, word)));
    this.table = element("table", { class: "now" }, element("caption", {}), element("tbody", {}, head, ...this.rows.map(({ row }) => row)));
    this.show(0);
  }

  nodes() {
    const controls = element(
      "div",
      { class: "bar" },
      this.button,
      this.slider,
      this.reading,
      choice("Speed", speeds.map((speed) => [speed, `\u00d7 ${speed}`]), this.speed, (speed) => (this.speed = speed)),
      choice("Movement drawn", magnifications.map((factor) => [factor, `\u00d7 ${factor}`]), 1, (factor) => {
        this.drawing.magnify(factor);
        this.show(this.time);
      }),
    ); // prettier-ignore
    return [element("div", { class: "player" }, this.drawing.svg, controls), this.table];
  }

  slabAt(time) {
    if (time > this.reached) return null;
    return this.motion.slabs.find(({ to }) => time < to) ?? this.motion.slabs.at(-1) ?? null;
  }

  show(time) {
    this.time = time;
    this.slider.value = time;
    const slab = this.slabAt(time);
    this.reading.value = `${time.toFixed(4)} s${slab ? "" : `: ${this.openWords}`}`;
    this.showTime(time);
    this.table.caption.textContent = slab ? `Proven at all times from ${slab.from} to ${slab.to} s` : `At ${time.toFixed(4)} s: ${this.openWords}`;
    if (slab) this.drawing.show(slab.points);
    else this.drawing.showNothing(this.openWords);
    this.rows.forEach(({ interval, width }, k) => {
      const [lo, hi] = slab ? this.quantities[k].of(slab) : [];
      interval.show(slab ? lower(lo) : undefined, slab ? upper(hi) : undefined);
      width.textContent = slab ? widthText(upper(hi) - lower(lo), this.quantities[k].unit) : "";
    });
  }

  play() {
    this.playing = true;
    this.button.textContent = "pause";
    if (this.time >= this.motion.duration) this.show(0);
    let before = performance.now();
    const advance = (now) => {
      if (!this.playing) return;
      this.show(Math.min(this.time + (this.speed * (now - before)) / 1000, this.motion.duration));
      before = now;
      if (this.time < this.motion.duration) requestAnimationFrame(advance);
      else this.pause();
    };
    requestAnimationFrame(advance);
  }

  pause() {
    this.playing = false;
    this.button.textContent = "play";
  }
}
