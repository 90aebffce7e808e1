// Enclosures as text whose digits the reader chooses: few, rounded outward, or all, exact.
import { element } from "../src/elements.js";
import { enclosureText, exactText, textAbove, textBelow } from "../src/numbers.js";

const shown = new Set();
let withAllDigits = false;

// JSON has no infinities: there, an end is null.
export const lower = (end) => end ?? -Infinity;
export const upper = (end) => end ?? Infinity;

// So many that the ends differ in the last two or three, and no more than a phone has room for.
function digitsFor(lo, hi) {
  const size = Math.max(Math.abs(lo), Math.abs(hi));
  if (!(hi > lo) || !Number.isFinite(size)) return 10;
  return Math.min(Math.max(Math.ceil(Math.log10(size / (hi - lo))) + 2, 5), 12);
}

export function intervalText(lo, hi) {
  if (lo === hi) return exactText(lo);
  return withAllDigits ? `[${exactText(lo)}, ${exactText(hi)}]` : enclosureText(lo, hi, digitsFor(lo, hi));
}

// What it contains may be set again: interval.show(lo, hi).
export function intervalNode(lo, hi) {
  const node = element("span", { class: "interval" });
  const write = () => (node.textContent = node.lo === undefined ? "" : intervalText(node.lo, node.hi));
  node.show = (from, to) => {
    [node.lo, node.hi] = [from, to];
    node.title = from === undefined ? "" : `[${exactText(from)}, ${exactText(to)}]`;
    write();
  };
  shown.add(write);
  node.show(lo, hi);
  return node;
}

export function showAllDigits(all) {
  withAllDigits = all;
  for (const write of shown) write();
}

// Of a length computed from ends: its own rounding errors are far below a part in 10^15.
export const surelyAbove = (number, digits = 4) => textAbove(number * (1 + 4e-16), digits);
export const surelyBelow = (number, digits = 4) => textBelow(number * (1 - 4e-16), digits);

// A width in words that a hand can feel: mm, mrad.
export function widthText(width, unit) {
  const small = { m: "mm", rad: "mrad", "m/s": "mm/s", "rad/s": "mrad/s" }[unit];
  return small ? `${surelyAbove(1000 * width)} ${small}` : `${surelyAbove(width)} ${unit}`;
}

// Rows of [label, node or text, unit].
export function intervalTable(caption, rows) {
  const line = ([label, content, unit]) =>
    element("tr", {}, element("th", { scope: "row" }, label), element("td", {}, content, unit ? ` ${unit}` : ""));
  return element("table", {}, element("caption", {}, caption), element("tbody", {}, ...rows.map(line)));
}
