// The legend over the picture: which colour means which number.
import { element, shape, swatch } from "./elements.js";
import { powerText, roundText, ticks } from "./numbers.js";
import { unboundedColour } from "./colours.js";

const height = 200;
const width = 14;
const steps = 100;

// Only the half of a signed scale that occurs is shown, and an end is pointed where numbers go on beyond it.
function shownPart(scale, quantity) {
  if (scale.axis !== "signed") return { from: scale.from, to: scale.to };
  return { from: quantity.least < 0 ? scale.from : 0, to: quantity.greatest > 0 || quantity.least >= 0 ? scale.to : 0 };
}

function bar(scale, quantity) {
  const { from, to } = shownPart(scale, quantity);
  const y = (value) => height * (1 - (value - from) / (to - from));
  const step = (to - from) / steps;
  const pieces = Array.from({ length: steps }, (_, k) =>
    shape("rect", {
      x: 0,
      width,
      y: y(from + (k + 1) * step),
      height: height / steps + 0.3,
      fill: scale.at(from + (k + 0.5) * step),
    }),
  );
  const text = scale.axis === "logarithm" ? powerText : roundText;
  const marks = ticks(from, to).flatMap((value) => [
    shape("line", { x1: width, x2: width + 4, y1: y(value), y2: y(value) }),
    shape("text", { x: width + 8, y: y(value) }, text(value)),
  ]);
  const beyond = [];
  if (quantity.greatest > to)
    beyond.push(shape("path", { d: `M0,-1 L${width / 2},-9 L${width},-1 Z`, fill: scale.at(to) }));
  if (quantity.least < from) {
    beyond.push(
      shape("path", {
        d: `M0,${height + 1} L${width / 2},${height + 9} L${width},${height + 1} Z`,
        fill: scale.at(from),
      }),
    );
  }
  return shape(
    "svg",
    {
      viewBox: `-1 -12 76 ${height + 24}`,
      width: 76,
      height: height + 24,
      role: "img",
      "aria-label": `Colour scale from ${text(from)} to ${text(to)}`,
    },
    ...pieces,
    ...marks,
    ...beyond,
  );
}

const key = (colour, words) => element("p", { class: "key" }, swatch(colour), words);

export function drawLegend(parent, quantity, scale, units, hasUnbounded) {
  const heading = element(
    "p",
    { class: "name" },
    quantity.label,
    units && scale.axis !== "category" ? element("span", { class: "units" }, ` ${units}`) : "",
  );
  const body =
    scale.axis === "category"
      ? quantity.categories.map((name, k) => key(scale.at(k), quantity.id === "status" ? name.split(":")[0] : name))
      : [bar(scale, quantity)];
  if (hasUnbounded) body.push(key(unboundedColour, "not bounded"));
  parent.replaceChildren(heading, ...body);
}
