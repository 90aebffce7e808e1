// A model file (docs/formats.md, section 2) as primitives to prove with: the union of convex superquadrics. Whatever
// else there is is refused in words.
import { nearestBinary64 } from "./decimal.js";
import { Numeral, parseJson } from "./json_text.js";

// What this page has no proofs for; the message ends "this page cannot prove ...".
export class CannotProve extends Error {}

const keys = {
  model: ["format", "units", "primitives", "csg", "landmarks", "areas"],
  primitive: ["name", "superquadric", "bend", "pose"],
  superquadric: ["semi_axes", "exponents", "taper"],
  pose: ["translation", "quaternion"],
};

function object(value, kind) {
  if (!(value instanceof Map)) throw new Error(`${kind}: not an object`);
  for (const key of value.keys()) if (!keys[kind].includes(key)) throw new Error(`${kind}: unknown key ${key}`);
  return value;
}

function number(value, what) {
  if (Array.isArray(value)) throw new CannotProve("models with intervals for numbers");
  if (!(value instanceof Numeral)) throw new Error(`${what}: not a number`);
  return nearestBinary64(value.text);
}

function numbers(value, count, what) {
  if (!Array.isArray(value) || value.length !== count) throw new Error(`${what}: not ${count} numbers`);
  return value.map((item) => number(item, what));
}

const isPositive = (x) => x > 0;

function superquadric(value) {
  const entries = object(value, "superquadric");
  const semiAxes = numbers(entries.get("semi_axes"), 3, "semi_axes");
  const exponents = numbers(entries.get("exponents"), 2, "exponents");
  const taper = entries.has("taper") ? number(entries.get("taper"), "taper") : 1;
  if (!semiAxes.every(isPositive)) throw new Error("semi_axes: not positive");
  if (!exponents.every((eps) => eps > 0 && eps <= 2)) throw new Error("exponents: not in (0, 2]");
  if (!(taper >= 0.01 && taper <= 100)) throw new Error("taper: not from 0.01 to 100");
  return { semiAxes, exponents, taper };
}

function pose(value) {
  const entries = value === undefined ? new Map() : object(value, "pose");
  const read = (key, count, otherwise) => (entries.has(key) ? numbers(entries.get(key), count, key) : otherwise);
  return { translation: read("translation", 3, [0, 0, 0]), quaternion: read("quaternion", 4, [1, 0, 0, 0]) };
}

function requireStraight(bend) {
  if (bend === undefined) return;
  if (!(bend instanceof Map) || number(bend.get("curvature"), "curvature") !== 0) {
    throw new CannotProve("bent superquadrics");
  }
}

function primitive(value) {
  const entries = object(value, "primitive");
  requireStraight(entries.get("bend"));
  return { name: entries.get("name"), ...superquadric(entries.get("superquadric")), ...pose(entries.get("pose")) };
}

// The names in a tree of unions.
function namesIn(csg) {
  if (typeof csg === "string") return [csg];
  const operands = csg instanceof Map && csg.size === 1 ? csg.get("union") : undefined;
  if (!Array.isArray(operands)) throw new CannotProve("set operations other than unions");
  return operands.flatMap(namesIn);
}

function requireUnionOfAll(csg, primitives) {
  if (csg === undefined) return;
  const names = new Set(namesIn(csg));
  if (!primitives.every(({ name }) => names.has(name))) throw new CannotProve("models that leave primitives out");
}

// Of lengths; empty where the model does not say.
export function unitsOf(text) {
  return object(parseJson(text.replace(/^\ufeff/, "")), "model").get("units") ?? "";
}

// [{ name, semiAxes, exponents, taper, translation, quaternion }, ...]
export function primitivesOf(text) {
  const entries = object(parseJson(text.replace(/^\ufeff/, "")), "model");
  if (entries.get("format") !== "verisq-model/1") throw new Error("the model's format is not verisq-model/1");
  const list = entries.get("primitives");
  if (!Array.isArray(list) || list.length === 0) throw new Error("the model has no primitives");
  const primitives = list.map(primitive);
  requireUnionOfAll(entries.get("csg"), primitives);
  return primitives;
}
