// A model file (docs/formats.md, section 2) as primitives and a set of them to prove with. Whatever else there is is
// refused in words.
import { nearestBinary64 } from "./decimal.js";
import { Numeral, parseJson } from "./json_text.js";

// What this page has no proofs for; the message ends "this page cannot prove ...".
export class CannotProve extends Error {}

const keys = {
  model: ["format", "units", "primitives", "csg", "landmarks", "areas"],
  primitive: ["name", "superquadric", "mesh", "bend", "pose"],
  mesh: ["file", "vertices", "triangles", "scale"],
  superquadric: ["semi_axes", "exponents", "taper"],
  bend: ["curvature", "angle_deg"],
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

// null where it moves nothing.
function bend(value) {
  if (value === undefined) return null;
  const entries = object(value, "bend");
  const curvature = number(entries.get("curvature"), "curvature");
  const angleDegrees = number(entries.get("angle_deg"), "angle_deg");
  return curvature === 0 ? null : { curvature, angleDegrees };
}

// A mesh of this text, or `read`, which verisq has read from the file that the text names.
function mesh(value, read) {
  const entries = object(value, "mesh");
  if (entries.has("file")) {
    if (!read) throw new Error("mesh: the page does not hold the mesh of the file");
    return read;
  }
  const scale = entries.has("scale") ? number(entries.get("scale"), "scale") : 1;
  const list = (key) => {
    if (!Array.isArray(entries.get(key))) throw new Error(`mesh: no ${key}`);
    return entries.get(key).flatMap((item) => numbers(item, 3, key));
  };
  return { vertices: list("vertices").map((x) => x * scale), triangles: list("triangles") };
}

function requireMesh({ vertices, triangles }) {
  const count = vertices.length / 3;
  if (!vertices.every(Number.isFinite)) throw new Error("mesh: a vertex is not finite");
  if (triangles.length === 0) throw new Error("mesh: no triangles");
  if (!triangles.every((n) => Number.isInteger(n) && n >= 0 && n < count)) throw new Error("mesh: no such vertex");
}

function primitive(value, read) {
  const entries = object(value, "primitive");
  if (entries.has("mesh")) {
    if (entries.has("superquadric") || entries.has("bend")) throw new Error("mesh: there is another solid beside it");
    const solid = { name: entries.get("name"), mesh: mesh(entries.get("mesh"), read), ...pose(entries.get("pose")) };
    requireMesh(solid.mesh);
    return solid;
  }
  return {
    name: entries.get("name"),
    ...superquadric(entries.get("superquadric")),
    bend: bend(entries.get("bend")),
    ...pose(entries.get("pose")),
  };
}

// Indices of primitives, and { operation, operands }.
function setOf(csg, names) {
  if (typeof csg === "string") {
    const index = names.indexOf(csg);
    if (index < 0) throw new Error(`csg: no primitive is called ${csg}`);
    return index;
  }
  const [operation, operands] = csg instanceof Map && csg.size === 1 ? [...csg][0] : [];
  const least = { union: 1, intersection: 1, difference: 2 }[operation];
  if (!Array.isArray(operands) || !(operands.length >= least)) throw new Error("csg: no set operation");
  return { operation, operands: operands.map((operand) => setOf(operand, names)) };
}

const isTreeOfUnions = (set) =>
  typeof set === "number" || (set.operation === "union" && set.operands.every(isTreeOfUnions));
const primitivesIn = (set) => (typeof set === "number" ? [set] : set.operands.flatMap(primitivesIn));

// Of lengths; empty where the model does not say.
export function unitsOf(text) {
  if (text === null) return "";
  return object(parseJson(text.replace(/^\ufeff/, "")), "model").get("units") ?? "";
}

// A mesh file as a model.
function modelOfMesh(mesh) {
  requireMesh(mesh);
  return { primitives: [{ name: "mesh", mesh, ...pose() }], set: 0, isUnion: true };
}

// { primitives: [{ name, semiAxes, exponents, taper, bend, translation, quaternion }, ...], set, isUnion }: whether the
// set is the union of all primitives. A primitive may have `mesh` in place of the four. `meshes` are those of files, by
// primitive; the text is null where a mesh file is the model.
export function modelOf(text, meshes = null) {
  if (text === null) return modelOfMesh(meshes[0]);
  const entries = object(parseJson(text.replace(/^\ufeff/, "")), "model");
  if (entries.get("format") !== "verisq-model/1") throw new Error("the model's format is not verisq-model/1");
  const list = entries.get("primitives");
  if (!Array.isArray(list) || list.length === 0) throw new Error("the model has no primitives");
  const primitives = list.map((item, k) => primitive(item, meshes?.[k]));
  const names = primitives.map(({ name }) => name);
  if (new Set(names).size !== names.length) throw new Error("the model's primitives do not have different names");
  const all = { operation: "union", operands: [...primitives.keys()] };
  const set = entries.has("csg") ? setOf(entries.get("csg"), names) : all;
  const isUnion = isTreeOfUnions(set) && new Set(primitivesIn(set)).size === primitives.length;
  if (!isUnion && primitives.some(({ mesh }) => mesh)) throw new CannotProve("set operations with meshes");
  return { primitives, set, isUnion };
}
