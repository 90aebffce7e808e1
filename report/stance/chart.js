// Charts over time: tubes between their curves, and how wide they are.
import { element, shape } from "../src/elements.js";
import { roundText, ticks } from "../src/numbers.js";

const [width, height, left, right, top, bottom] = [640, 150, 74, 12, 8, 24];
const plotWidth = width - left - right;
const plotHeight = height - top - bottom;

// Times up to `duration`; from `reached` on there is nothing but a shade.
function frame(title, duration, reached) {
  const x = (time) => left + (plotWidth * time) / duration;
  const marks = ticks(0, duration).flatMap((time) => [
    shape("line", { class: "grid", x1: x(time), x2: x(time), y1: top, y2: top + plotHeight }),
    shape("text", { x: x(time), y: height - 8, "text-anchor": "middle" }, roundText(time)),
  ]);
  const open = shape("rect", { class: "open", x: x(reached), y: top, width: x(duration) - x(reached), height: plotHeight });
  const box = shape("rect", { class: "frame", x: left, y: top, width: plotWidth, height: plotHeight });
  const cursor = shape("line", { class: "cursor", y1: top, y2: top + plotHeight });
  const svg = shape("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": title }, ...marks, open, box);
  const node = element("figure", { class: "chart" }, element("figcaption", {}, title), svg);
  const showTime = (time) => {
    cursor.setAttribute("x1", x(time));
    cursor.setAttribute("x2", x(time));
  };
  const finish = (...shapes) => {
    svg.append(...shapes, cursor);
    showTime(0);
    return { node, showTime };
  };
  return { x, svg, finish };
}

function valueTicks(values, y, text) {
  return values.flatMap((value) => [
    shape("line", { class: "grid", x1: left, x2: left + plotWidth, y1: y(value), y2: y(value) }),
    shape("text", { x: left - 6, y: y(value) + 4, "text-anchor": "end" }, text(value)),
  ]);
}

// Where a motion opens, its last enclosures grow beyond all measure and would flatten the curve before them. The
// tightest enclosures of nine tenths of the time set the scale; an end that is more than 20 times their span away is
// cut off. host/stance/stance_pictures.cpp does the same.
export function shownRange(slabs) {
  const [shareOfTime, farthest] = [0.9, 20];
  const least = (values) => values.reduce((a, b) => Math.min(a, b));
  const greatest = (values) => values.reduce((a, b) => Math.max(a, b));
  const sorted = [...slabs].sort((a, b) => a.hi - a.lo - (b.hi - b.lo));
  const wanted = shareOfTime * slabs.reduce((sum, { from, to }) => sum + (to - from), 0);
  let time = 0;
  const tight = sorted.filter(({ from, to }) => {
    const counts = time < wanted;
    time += to - from;
    return counts;
  });
  const all = [least(slabs.map(({ lo }) => lo)), greatest(slabs.map(({ hi }) => hi))];
  const [lo, hi] = [least(tight.map((slab) => slab.lo)), greatest(tight.map((slab) => slab.hi))];
  const span = hi - lo;
  const lowest = all[0] < lo - farthest * span ? lo - span : all[0];
  const highest = all[1] > hi + farthest * span ? hi + span : all[1];
  return { lowest, highest, all, isCut: lowest > all[0] || highest < all[1] };
}

// slabs: [{from, to, lo, hi}].
export function tubeChart(title, unit, slabs, duration, reached) {
  const { lowest, highest, all, isCut } = shownRange(slabs);
  const size = Math.max(Math.abs(lowest), Math.abs(highest));
  // Where six digits do not tell ticks apart, they are differences from a round number.
  const base = highest - lowest < 1e-4 * size ? Number(((lowest + highest) / 2).toPrecision(8)) : 0;
  const margin = Math.max(0.06 * (highest - lowest), 1e-14 * size, 1e-300);
  const shown = (value) => Math.min(Math.max(value, lowest - margin), highest + margin);
  const y = (value) => top + plotHeight * (1 - (shown(value) - lowest + margin) / (highest - lowest + 2 * margin));
  const cut = isCut ? ` (cut off: the enclosures reach about [${all.map((end) => end.toExponential(2)).join(", ")}])` : "";
  const shownTitle = (base === 0 ? `${title}, ${unit}` : `${title}, ${unit}, less ${base}`) + cut;
  const { x, finish } = frame(shownTitle, duration, reached);
  const point = (time, value) => `${x(time).toFixed(2)},${y(value).toFixed(2)}`;
  const above = slabs.flatMap(({ from, to, hi }) => [point(from, hi), point(to, hi)]);
  const below = slabs.flatMap(({ from, to, lo }) => [point(from, lo), point(to, lo)]).reverse();
  const values = ticks(lowest - base, highest - base, 3).map((value) => value + base);
  return finish(
    ...valueTicks(values, y, (value) => roundText(Number((value - base).toPrecision(6)))),
    shape("polygon", { class: "tube", points: [...above, ...below].join(" ") }),
  );
}

// curves: [{name, widths: [{from, to, width}]}] in small units, over powers of ten.
export function widthChart(title, curves, duration, reached) {
  const all = curves.flatMap(({ widths }) => widths.map(({ width: each }) => each)).filter((each) => each > 0);
  if (all.length === 0) return null;
  const [least, most] = [Math.floor(Math.log10(Math.min(...all))), Math.ceil(Math.log10(Math.max(...all)))];
  const [from, to] = [least, Math.max(most, least + 1)];
  const y = (power) => top + plotHeight * (1 - (power - from) / (to - from));
  const { x, finish } = frame(title, duration, reached);
  const powers = ticks(from, to, 4).filter(Number.isInteger);
  const lines = curves.map(({ widths }, k) => {
    const points = widths
      .filter(({ width: each }) => each > 0)
      .flatMap((each) => [each.from, each.to].map((t) => `${x(t).toFixed(2)},${y(Math.log10(each.width)).toFixed(2)}`));
    return shape("polyline", { class: `curve curve-${k}`, points: points.join(" ") });
  });
  const chart = finish(...valueTicks(powers, y, (power) => `1e${power}`), ...lines);
  const names = curves.map(({ name }, k) =>
    element("span", {}, shape("svg", { class: "swatch", viewBox: "0 0 10 10" }, shape("path", { class: `curve curve-${k}`, d: "M0,5 h10" })), ` ${name} `));
  chart.node.append(element("p", { class: "hint" }, ...names));
  return chart;
}
