// Numbers to colours. Signed distances have a diverging scale around zero, safe for the colour-blind: cool where
// positive, warm (a warning) where negative, with a jump at zero, because the sign decides.
import { roundStep } from "./numbers.js";

const outside = ["#dfeaf1", "#b3d1e4", "#7db1d3", "#4288bb", "#2468a8", "#174a80"];
const inside = ["#ffc67d", "#fb9a4b", "#ec6a2c", "#c93f1c", "#9e2318", "#701414"];
const widths = ["#fde725", "#9fda3a", "#4ac16d", "#1fa187", "#277f8e", "#365c8d", "#46327e", "#440154"]; // viridis
const statuses = ["#3b82b8", "#2a9d77", "#e6a01c"];
const verdicts = ["#c3c8ce", "#2a9d77", "#c2261a", "#e6a01c"];
const areas = [
  "#4477aa",
  "#ee9944",
  "#228833",
  "#cc6688",
  "#66ccee",
  "#999933",
  "#aa3377",
  "#882255",
  "#44aa99",
  "#ddcc77",
];

export const unboundedColour = "#8b8f96";
export const tableSize = 512; // even: zero lies between two entries

const channels = (colour) => [1, 3, 5].map((start) => parseInt(colour.slice(start, start + 2), 16));

function blend(anchors, t) {
  const place = Math.min(Math.max(t, 0), 1) * (anchors.length - 1);
  const k = Math.min(Math.floor(place), anchors.length - 2);
  const [from, to] = [channels(anchors[k]), channels(anchors[k + 1])];
  return from.map((value, channel) => Math.round(value + (to[channel] - value) * (place - k)));
}

const css = ([red, green, blue]) => `rgb(${red}, ${green}, ${blue})`;

function tableOf(colourAt) {
  const table = new Uint8Array(4 * tableSize);
  for (let k = 0; k < tableSize; ++k) table.set([...colourAt((k + 0.5) / tableSize), 255], 4 * k);
  return table;
}

function signedScale(limit) {
  const colourAt = (t) => (t < 0.5 ? blend(inside, 1 - 2 * t) : blend(outside, 2 * t - 1));
  const at = (value) => css(value < 0 ? blend(inside, -value / limit) : blend(outside, value / limit));
  return { axis: "signed", from: -limit, to: limit, table: tableOf(colourAt), at };
}

function widthScale({ least, greatest }) {
  const span = Math.max(greatest - least, 1e-9);
  const colourAt = (t) => blend(widths, t);
  return {
    axis: "logarithm",
    from: least,
    to: least + span,
    table: tableOf(colourAt),
    at: (value) => css(colourAt((value - least) / span)),
  };
}

function categoryScale({ id, categories }) {
  const palette = { status: statuses, proof: verdicts }[id] ?? areas;
  const colour = (category) => channels(palette[category % palette.length]);
  const count = categories.length;
  const colourAt = (t) => colour(Math.min(Math.floor(t * count), count - 1));
  return { axis: "category", from: -0.5, to: count - 0.5, table: tableOf(colourAt), at: (value) => css(colour(value)) };
}

function boundedScaleOf(quantity, limit) {
  if (quantity.axis === "signed") return signedScale(limit);
  return quantity.axis === "logarithm" ? widthScale(quantity) : categoryScale(quantity);
}

// `from` and `to` are the coordinates at the ends of `table`, RGBA of 8 bits; `at` is the CSS colour of a coordinate.
// `limit` is the greatest distance with a colour of its own; only signed quantities need one.
export function scaleOf(quantity, limit) {
  const scale = boundedScaleOf(quantity, limit);
  return { ...scale, at: (value) => (Number.isFinite(value) ? scale.at(value) : unboundedColour) };
}

// A round limit that leaves about one vertex in fifty beyond the scale: few far ones must not take its contrast.
export function usualLimit(quantity, count) {
  const stride = Math.max(1, Math.floor(count / 20000));
  const sizes = [];
  for (let vertex = 0; vertex < count; vertex += stride) {
    const size = Math.abs(quantity.coordinate(vertex));
    if (Number.isFinite(size)) sizes.push(size);
  }
  sizes.sort((a, b) => a - b);
  const size = sizes[Math.floor(0.98 * (sizes.length - 1))];
  return size > 0 ? roundUp(size) : 1;
}

// To a multiple of a tenth to a fifth of it.
function roundUp(size) {
  const step = roundStep(size / 10);
  return Number((Math.ceil(size / step) * step).toPrecision(3));
}
