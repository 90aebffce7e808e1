// How often each value of the shown quantity occurs, in the colours of the picture. A bin under the pointer, or chosen
// with the arrow keys, is highlighted in the picture.
import { element, shape, swatch } from "./elements.js";
import { countText, powerText, roundStep, roundText, shareText, ticks, withUnits } from "./numbers.js";

const width = 340;
const height = 130;
const bottom = 20;
const wantedBins = 40;

// Edges are multiples of a round step, so zero is an edge.
function binsOf({ least, greatest, axis, coordinate }, count) {
  const step =
    axis === "category" ? 1 : roundStep(Math.max((greatest - least) / wantedBins, Math.abs(greatest) * 1e-12, 1e-300));
  const start = Math.floor(least / step);
  const counts = new Array(Math.floor(greatest / step) - start + 1).fill(0);
  let unbounded = 0;
  for (let vertex = 0; vertex < count; ++vertex) {
    const value = coordinate(vertex);
    if (Number.isFinite(value)) ++counts[Math.floor(value / step) - start];
    else ++unbounded;
  }
  const bins = counts.map((vertices, k) => ({ from: (start + k) * step, to: (start + k + 1) * step, vertices }));
  return { bins, unbounded };
}

const middle = ({ from, to }) => (from + to) / 2;

export class Histogram {
  // `onChoice` gets the chosen bin, or undefined.
  constructor(parent, reading, { count, units }, onChoice) {
    Object.assign(this, { parent, reading, count, units, onChoice });
    parent.tabIndex = 0;
    parent.setAttribute("role", "group");
    parent.setAttribute("aria-label", "Distribution: left and right arrow keys choose a bin");
    parent.addEventListener("keydown", (event) => this.press(event));
    parent.addEventListener("pointerleave", () => this.choose(undefined));
    parent.addEventListener("blur", () => this.choose(undefined));
  }

  show(quantity) {
    this.quantity = quantity;
    Object.assign(this, binsOf(quantity, this.count));
    this.chosen = undefined;
  }

  // Call after `show` and whenever colours have changed.
  draw(scale) {
    this.scale = scale;
    this.marks = [];
    this.parent.replaceChildren(scale.axis === "category" ? this.rows() : this.chart());
    this.read();
  }

  chart() {
    const { bins, scale } = this;
    const [from, to] = [bins[0].from, bins[bins.length - 1].to];
    const x = (value) => ((value - from) / (to - from)) * width;
    const tallest = Math.max(1, ...bins.map(({ vertices }) => vertices));
    const bars = bins.flatMap((bin, k) => {
      const size = bin.vertices === 0 ? 0 : Math.max(2, (bin.vertices / tallest) * (height - 4));
      const place = { x: x(bin.from), width: x(bin.to) - x(bin.from) };
      const mark = shape(
        "g",
        { class: "bin" },
        shape("rect", { ...place, y: 0, height: height, class: "target" }),
        shape("rect", {
          x: place.x + 0.4,
          width: Math.max(0.6, place.width - 0.8),
          y: height - size,
          height: size,
          fill: scale.at(middle(bin)),
          class: "size",
        }),
      );
      return [this.listen(mark, k)];
    });
    const isLogarithm = scale.axis === "logarithm";
    const labels = ticks(from, to, isLogarithm ? 4 : 6)
      .filter((value) => !isLogarithm || Number.isInteger(value))
      .flatMap((value) => [
        shape("line", { x1: x(value), x2: x(value), y1: height, y2: height + 4 }),
        shape("text", { x: x(value), y: height + 14 }, isLogarithm ? powerText(value) : roundText(value)),
      ]);
    const zero =
      scale.axis === "signed" && from < 0 && to > 0
        ? [shape("line", { class: "zero", x1: x(0), x2: x(0), y1: 0, y2: height })]
        : [];
    return shape(
      "svg",
      { viewBox: `-14 0 ${width + 28} ${height + bottom}`, role: "img", "aria-label": this.description() },
      ...bars,
      shape("line", { class: "axis", x1: 0, x2: width, y1: height, y2: height }),
      ...labels,
      ...zero,
    );
  }

  rows() {
    const { bins, scale, quantity, count } = this;
    const tallest = Math.max(1, ...bins.map(({ vertices }) => vertices));
    return element(
      "div",
      { class: "rows" },
      ...bins.map((bin, k) => {
        const size = shape(
          "svg",
          { class: "size", viewBox: "0 0 100 4", preserveAspectRatio: "none", "aria-hidden": "true" },
          shape("rect", { width: (100 * bin.vertices) / tallest, height: 4, fill: scale.at(k) }),
        );
        const numbers = element(
          "span",
          { class: "numbers" },
          `${countText(bin.vertices)} \u00b7 ${shareText(bin.vertices, count)}`,
        );
        return this.listen(
          element(
            "div",
            { class: "bin row" },
            swatch(scale.at(k)),
            element("span", {}, quantity.categories[k]),
            numbers,
            size,
          ),
          k,
        );
      }),
    );
  }

  listen(mark, k) {
    mark.addEventListener("pointerenter", () => this.choose(k));
    this.marks[k] = mark;
    return mark;
  }

  choose(k) {
    if (k === this.chosen) return;
    this.marks[this.chosen]?.classList.remove("chosen");
    this.chosen = k;
    this.marks[k]?.classList.add("chosen");
    this.read();
    // Categories are drawn with half a unit of room.
    const bin = this.bins[k];
    this.onChoice(bin && this.scale.axis === "category" ? { from: bin.from - 0.5, to: bin.from + 0.5 } : bin);
  }

  press(event) {
    const last = this.bins.length - 1;
    const present = this.chosen;
    const next = {
      ArrowRight: Math.min((present ?? -1) + 1, last),
      ArrowLeft: Math.max((present ?? last + 1) - 1, 0),
      Home: 0,
      End: last,
      Escape: undefined,
    };
    if (!(event.key in next)) return;
    event.preventDefault();
    this.choose(next[event.key]);
  }

  intervalText({ from, to }) {
    if (this.scale.axis === "category") return this.quantity.categories[from];
    if (this.scale.axis === "logarithm")
      return withUnits(`${powerText(Number(from.toFixed(6)))} to ${powerText(Number(to.toFixed(6)))}`, this.units);
    return withUnits(`${roundText(from)} to ${roundText(to)}`, this.units);
  }

  description() {
    return `${this.quantity.label} of ${countText(this.count)} vertices`;
  }

  read() {
    const bin = this.bins[this.chosen];
    const others = this.unbounded > 0 ? `; ${countText(this.unbounded)} not bounded` : "";
    this.reading.textContent = bin
      ? `${this.intervalText(bin)}: ${countText(bin.vertices)} vertices, ${shareText(bin.vertices, this.count)}`
      : this.description() + others;
  }
}
