// Two uncertain parameters: what is proven of each cell of their box.
import { element, shape, swatch } from "../src/elements.js";
import { roundText } from "../src/numbers.js";

const [side, left, bottom] = [400, 78, 40];

// meanings: by verdict, { colour, words }.
export function parameterMap(cells, parameters, meanings) {
  const [across, upward] = parameters;
  const of = (cell, parameter) => cell.parameters[parameter.name];
  const extent = (parameter) => [
    Math.min(...cells.map((cell) => of(cell, parameter).lo)),
    Math.max(...cells.map((cell) => of(cell, parameter).hi)),
  ];
  const scale = ([lo, hi]) => (value) => (hi > lo ? (side * (value - lo)) / (hi - lo) : side / 2);
  const [acrossEnds, upwardEnds] = [extent(across), extent(upward)];
  const [x, y] = [scale(acrossEnds), scale(upwardEnds)];
  const rectangles = cells.map((cell) => {
    const [a, u] = [of(cell, across), of(cell, upward)];
    const place = { x: left + x(a.lo), y: side - y(u.hi), width: x(a.hi) - x(a.lo), height: y(u.hi) - y(u.lo) };
    return shape("rect", { class: "cell", ...place, fill: meanings[cell.verdict].colour });
  });
  const label = (at, anchor, words) => shape("text", { ...at, "text-anchor": anchor }, words);
  const named = ({ name, unit }) => (unit ? `${name}, ${unit}` : name);
  const svg = shape(
    "svg",
    { class: "map", viewBox: `0 -8 ${left + side + 20} ${side + bottom + 8}`, role: "img", "aria-label": "What is proven over the parameters" },
    ...rectangles,
    label({ x: left, y: side + 18 }, "start", roundText(acrossEnds[0])),
    label({ x: left + side, y: side + 18 }, "end", roundText(acrossEnds[1])),
    label({ x: left + side / 2, y: side + 18 }, "middle", named(across)),
    label({ x: left - 6, y: side }, "end", roundText(upwardEnds[0])),
    label({ x: left - 6, y: 10 }, "end", roundText(upwardEnds[1])),
    label({ x: left - 6, y: side / 2 }, "end", named(upward)),
  );
  const legend = Object.values(meanings).map(({ colour, words }) => element("li", {}, swatch(colour), ` ${words}`));
  return element("figure", {}, svg, element("figcaption", {}, element("ul", { class: "legend" }, ...legend)));
}

const [good, bad, open] = ["#4c9f70", "#e0654a", "#c3c8ce"];
export const standingMeanings = {
  stands: { colour: good, words: "proven: in equilibrium on all cylinders" },
  not_on_all: { colour: bad, words: "proven: no equilibrium on all cylinders near by" },
  open: { colour: open, words: "open" },
};
export const stabilityMeanings = {
  stable: { colour: good, words: "proven: small disturbances die out" },
  unstable: { colour: bad, words: "proven: some disturbances grow" },
  open: { colour: open, words: "open" },
};
