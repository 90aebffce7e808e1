// The body from the side: lines and discs in the middle of their enclosures, and around them what surely contains them.
import { shape } from "../src/elements.js";

const middle = ([xlo, xhi, ylo, yhi]) => [(xlo + xhi) / 2, (ylo + yhi) / 2];
const corners = ([xlo, xhi, ylo, yhi]) => [[xlo, ylo], [xhi, ylo], [xhi, yhi], [xlo, yhi]]; // prettier-ignore

// Andrew's monotone chain.
function hull(points) {
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const chain = (list) => {
    const kept = [];
    for (const p of list) {
      while (kept.length > 1) {
        const [[ax, ay], [bx, by]] = kept.slice(-2);
        if ((bx - ax) * (p[1] - ay) - (by - ay) * (p[0] - ax) > 0) break;
        kept.pop();
      }
      kept.push(p);
    }
    return kept.slice(0, -1);
  };
  return [...chain(sorted), ...chain(sorted.reverse())];
}

// Displacements of a point from where its reference is, times a factor: a linear map, under which a box still contains
// its point.
function magnified([xlo, xhi, ylo, yhi], reference, factor) {
  const [x, y] = middle(reference);
  const away = (value, from) => from + factor * (value - from);
  return [away(xlo, x), away(xhi, x), away(ylo, y), away(yhi, y)];
}

function magnifiedPoints(points, reference, factor) {
  const each = (list, references) => list.map((box, k) => magnified(box, references[k], factor));
  return {
    bodies: each(points.bodies, reference.bodies),
    cylinders: each(points.cylinders, reference.cylinders),
    trunk: magnified(points.trunk, reference.trunk, factor),
  };
}

// A drawing of millimetres, y up: figure is what is drawn, frames all points that it may show.
export class Drawing {
  constructor(figure, frames, label) {
    this.figure = figure;
    this.frames = frames;
    this.factor = 1;
    this.ground = shape("g", { class: "ground" });
    this.body = shape("g");
    this.svg = shape("svg", { class: "figure", role: "img", "aria-label": label }, this.ground, this.body);
    this.magnify(1);
  }

  magnify(factor) {
    this.factor = factor;
    let [left, right, top] = [Infinity, -Infinity, 0];
    for (const frame of this.frames) {
      const points = magnifiedPoints(frame, this.frames[0], factor);
      const discs = points.cylinders.map((box, k) => this.around(box, k));
      for (const [xlo, xhi, , yhi] of [...points.bodies, points.trunk, ...discs]) {
        [left, right, top] = [Math.min(left, xlo), Math.max(right, xhi), Math.max(top, yhi)];
      }
    }
    const margin = 0.08 * top;
    left = Math.min(left - margin, (left + right) / 2 - 0.35 * top); // room for the forces' numbers
    right = Math.max(right + margin, left + 0.7 * top);
    const mm = (metres) => (1000 * metres).toFixed(2);
    this.svg.setAttribute("viewBox", [mm(left), mm(-top - margin), mm(right - left), mm(top + 2 * margin)].join(" "));
    const floor = { x: mm(left), width: mm(right - left), y: 0, height: mm(margin) };
    this.ground.replaceChildren(shape("rect", floor), shape("line", { x1: floor.x, x2: mm(right), y1: 0, y2: 0 }));
  }

  around([xlo, xhi, ylo, yhi], k) {
    const radius = this.figure.cylinders[k].radius[1];
    return [xlo - radius, xhi + radius, ylo - radius, yhi + radius];
  }

  // `marks` are drawn on top.
  show(frame, marks = []) {
    const points = magnifiedPoints(frame, this.frames[0], this.factor);
    const at = ([x, y]) => `${(1000 * x).toFixed(3)},${(-1000 * y).toFixed(3)}`;
    const [sure, plain] = [[], []];
    const limb = (a, b, kind) => {
      sure.push(shape("polygon", { class: "sure", points: hull([...corners(a), ...corners(b)]).map(at).join(" ") }));
      plain.push(shape("polyline", { class: kind, points: [middle(a), middle(b)].map(at).join(" ") }));
    };
    const dot = (box, kind, radius) => {
      const [x, y] = middle(box);
      plain.push(shape("circle", { class: kind, cx: 1000 * x, cy: -1000 * y, r: 1000 * radius }));
    };
    points.cylinders.forEach((box, k) => {
      const [xlo, xhi, ylo, yhi] = this.around(box, k);
      const rx = 1000 * this.figure.cylinders[k].radius[1];
      const place = { x: 1000 * xlo, y: -1000 * yhi, width: 1000 * (xhi - xlo), height: 1000 * (yhi - ylo), rx };
      sure.push(shape("rect", { class: "sure", ...place }));
      dot(box, "disc", this.figure.cylinders[k].radius[0]);
    });
    this.figure.bodies.forEach(({ parent }, b) => {
      if (parent !== null) limb(points.bodies[parent], points.bodies[b], "limb");
    });
    limb(points.bodies[0], points.trunk, "limb");
    points.bodies.forEach((box) => dot(box, "joint", 0.012));
    dot(points.trunk, "mass", 0.03);
    this.body.replaceChildren(...sure, ...plain, ...marks);
  }

  // Of what is not proven there is no picture.
  showNothing(words) {
    const [x, y, width, height] = this.svg.getAttribute("viewBox").split(" ").map(Number);
    const text = { class: "open", x: x + width / 2, y: y + height / 2, "font-size": height / 9 };
    this.body.replaceChildren(shape("text", text, words));
  }
}

// An arrow upward from the ground; 1 N is 1 mm.
export function forceMark(x, { lo, hi }) {
  const place = 1000 * x;
  const length = (lo + hi) / 2;
  return shape(
    "g",
    { class: "force" },
    shape("line", { x1: place, x2: place, y1: 0, y2: -length }),
    shape("path", { d: `M${place},${-length - 24} l-12,28 h24 z` }),
  );
}

// Where the ground's force acts as a whole: a bar as wide as its enclosure over a triangle.
export function pressureMark({ lo, hi }) {
  const [from, to] = [1000 * lo, 1000 * hi];
  const x = (from + to) / 2;
  return shape(
    "g",
    { class: "pressure" },
    shape("path", { d: `M${x},8 l-16,30 h32 z` }),
    shape("rect", { x: from, width: to - from, y: 4, height: 8 }),
  );
}

// Radio buttons would take a row each on a phone.
export const magnifications = [1, 10, 100, 1000];
