// One vertex in words: its exact interval, which side of the implant it is on, who proved it, its area.
import { element, swatch } from "./elements.js";
import { sideOf } from "./facts.js";
import { exactText, textAbove, withUnits } from "./numbers.js";
import { statusNames, verdicts } from "./quantities.js";

const sideWords = ({ solidName }) => ({
  outside: `proven outside the ${solidName}`,
  inside: `proven inside the ${solidName}`,
  undecided: "undecided: the interval contains 0",
});

function interval(report, vertex) {
  return element(
    "p",
    { class: "interval" },
    "[",
    element("span", { class: "lo" }, exactText(report.lo[vertex])),
    ", ",
    element("span", { class: "hi" }, exactText(report.hi[vertex])),
    "]",
    report.units ? element("span", { class: "units" }, ` ${report.units}`) : "",
  );
}

const headline = (vertex, colour) => element("p", { class: "name" }, swatch(colour), `Vertex ${vertex}`);

// For the pointer: the few facts that fit beside it.
export function shortDescription(report, vertex, colour) {
  const words = [statusNames[report.status[vertex]]];
  if (report.areas) words.push(report.areas.names[report.areas.of[vertex]]);
  return [headline(vertex, colour), interval(report, vertex), element("p", { class: "words" }, words.join(" \u00b7 "))];
}

export function fullDescription(report, vertex, colour) {
  const { lo, hi, status, areas, centre, bone, units } = report;
  // The difference is rounded to nearest, so the exact width may be the next number.
  const width = hi[vertex] - lo[vertex];
  const place = [0, 1, 2].map((axis) => Number((centre[axis] + bone.positions[3 * vertex + axis]).toPrecision(5)));
  const rows = [
    ["width", withUnits(width === 0 ? "0" : `\u2264 ${textAbove(width * (1 + 2 ** -50), 3)}`, units)],
    ["status", statusNames[status[vertex]]],
  ];
  if (report.proof) rows.push(["in this browser", verdicts[report.verdicts[vertex]]]);
  if (areas) rows.push(["area", areas.names[areas.of[vertex]]]);
  rows.push(["place, about", `(${place.join(", ")})`]);
  const side = sideOf(lo[vertex], hi[vertex]);
  return [
    headline(vertex, colour),
    interval(report, vertex),
    element("p", { class: `side ${side}` }, sideWords(report)[side]),
    element("dl", {}, ...rows.flatMap(([name, value]) => [element("dt", {}, name), element("dd", {}, value)])),
  ];
}
