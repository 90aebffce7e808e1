// The eigenvalues' enclosures as boxes in the complex plane, whose axes are those of asinh: near 0 as they are, far from
// it by powers of ten, so that a box stays a box on its side of the imaginary axis.
import { element, shape } from "../src/elements.js";

const [side, margin] = [440, 44];

function powersUpTo(size, unit) {
  const result = [];
  for (let power = Math.log10(unit) + 2; 10 ** power <= size * 1.0001; power += 2) result.push(10 ** power);
  return result;
}

export function eigenvaluePlane(eigenvalues) {
  const ends = eigenvalues.flatMap(({ real, imaginary }) => [real.lo, real.hi, imaginary.lo, imaginary.hi].map(Math.abs));
  const nearest = Math.min(...eigenvalues.map(({ real }) => Math.max(Math.abs(real.lo), Math.abs(real.hi))));
  const unit = 10 ** Math.min(Math.max(Math.floor(Math.log10(nearest)), -9), 0);
  const size = Math.max(...ends) * 1.5;
  const place = (value) => Math.asinh(value / unit) / Math.asinh(size / unit);
  const rightmost = Math.max(...eigenvalues.map(({ real }) => real.hi));
  const reach = Math.max(place(rightmost) + 0.1, 0.3); // of the right half
  const x = (value) => margin + ((place(value) + 1) / (1 + reach)) * side;
  const y = (value) => 16 + ((1 - place(value)) / 2) * side;
  const labels = powersUpTo(size, unit).flatMap((power) => [-power, power]);
  labels.push(0);
  const text = (value) => value.toExponential(0).replace("e+0", "").replace("+", "").replaceAll("-", "\u2212");
  const grid = labels.flatMap((value) => {
    const isInside = x(value) <= margin + side;
    return [
      ...(isInside ? [
        shape("line", { class: "grid", x1: x(value), x2: x(value), y1: 16, y2: 16 + side }),
        shape("text", { x: x(value), y: side + 32, "text-anchor": "middle" }, text(value)),
      ] : []),
      shape("line", { class: "grid", x1: margin, x2: margin + side, y1: y(value), y2: y(value) }),
      shape("text", { x: margin - 4, y: y(value) + 4, "text-anchor": "end" }, text(value)),
    ];
  }); // prettier-ignore
  const boxes = eigenvalues.flatMap(({ real, imaginary, count }) => {
    const kind = real.hi < 0 ? "good" : real.lo > 0 ? "bad" : "undecided";
    const box = { x: x(real.lo), y: y(imaginary.hi), width: x(real.hi) - x(real.lo), height: y(imaginary.lo) - y(imaginary.hi) };
    const ring = { cx: box.x + box.width / 2, cy: box.y + box.height / 2, r: count === 1 ? 3.5 : 5.5 };
    return [shape("circle", { class: kind, ...ring }), shape("rect", { class: kind, ...box })];
  });
  const svg = shape(
    "svg",
    { class: "plane", viewBox: `0 0 ${side + margin + 12} ${side + 60}`, role: "img", "aria-label": "Enclosures of the eigenvalues in the complex plane" },
    shape("rect", { class: "growing", x: x(0), y: 16, width: margin + side - x(0), height: side }),
    ...grid,
    shape("line", { class: "axis", x1: x(0), x2: x(0), y1: 16, y2: 16 + side }),
    shape("line", { class: "axis", x1: margin, x2: margin + side, y1: y(0), y2: y(0) }),
    shape("text", { x: margin + side, y: 28, "text-anchor": "end" }, "grows"),
    shape("text", { x: x(0) - 6, y: 28, "text-anchor": "end" }, "dies out"),
    shape("text", { x: margin + side / 2, y: side + 50, "text-anchor": "middle" }, "real part, 1/s"),
    ...boxes,
  );
  const words = `Each eigenvalue lies in its box, in a ring that makes it visible. Left of the line a disturbance dies out, right of it grows; above and below the middle it swings. Scales are linear up to ${unit}/s and logarithmic beyond.`;
  return element("figure", {}, svg, element("figcaption", { class: "hint" }, words));
}
