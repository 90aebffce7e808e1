// The checker of a page against the one of `verisq check`, row for row: true rows and forged ones, of points about
// bent, tapered and combined models. No row that is false by construction may be proved by either.
//   node tests/report/prover_test.mjs --program build/release/verisq --page report/dist/page.html --output /tmp/rows
//     --points 40
import { spawnSync } from "node:child_process";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { runInThisContext } from "node:vm";

const { values: options } = parseArgs({
  options: {
    program: { type: "string" },
    page: { type: "string" },
    output: { type: "string" },
    points: { type: "string", default: "40" }, // about each model
    tolerance: { type: "string", default: "1e-3" }, // covers have the more cells the smaller it is
    seed: { type: "string", default: "1" },
  },
});
const random = randomNumbers(options.seed);
const examples = join(dirname(fileURLToPath(import.meta.url)), "../../examples");
mkdirSync(options.output, { recursive: true });

const script = /<script id="verisq-prover"[^>]*>([^]*?)<\/script>/.exec(readFileSync(options.page, "utf8"))[1];
runInThisContext(script);
const { Checker, loadRealNumbers, modelOf } = globalThis.verisqProver;

// ---------------------------------------------------------------- points

function randomNumbers(seed) {
  let state = BigInt(seed) * 2862933555777941757n;
  return () => {
    state = (state * 6364136223846793005n + 1442695040888963407n) & ((1n << 64n) - 1n);
    return Number(state >> 11n) / 2 ** 53;
  };
}

// A point about the box of a primitive, as far out as it is large, more of them within; of meshes some on the surface
// or beside it.
function localPoint({ semiAxes, mesh }, k, random) {
  const reach = k % 3 === 0 ? 2 : 1;
  if (!mesh) return semiAxes.map((a) => reach * a * (2 * random() - 1));
  const corner = (n) => [...mesh.vertices.slice(3 * n, 3 * n + 3)];
  if (k % 5 === 1) return corner(mesh.triangles[k % mesh.triangles.length]);
  if (k % 5 === 2) {
    const first = 3 * (k % (mesh.triangles.length / 3));
    const [a, b, c] = [0, 1, 2].map((i) => corner(mesh.triangles[first + i]));
    return a.map((x, i) => x / 2 + b[i] / 4 + c[i] / 4 + (k % 10 === 2 ? 0 : 1e-9 * (random() - 0.5)));
  }
  const ends = (take) => [0, 1, 2].map((i) => take(...mesh.vertices.filter((_, n) => n % 3 === i)));
  const [lower, upper] = [ends(Math.min), ends(Math.max)];
  if (k % 5 === 3) {
    // Rays along x from there pass through a corner.
    const [, y, z] = corner(mesh.triangles[k % mesh.triangles.length]);
    return [lower[0] + (upper[0] - lower[0]) * random(), y, z];
  }
  return lower.map((least, i) => (least + upper[i]) / 2 + (reach * (upper[i] - least) * (2 * random() - 1)) / 2);
}

function pointsAbout(model, count, random) {
  const { primitives } = model;
  return Array.from({ length: count }, (_, k) => {
    const { translation, quaternion } = primitives[k % primitives.length];
    const local = localPoint(primitives[k % primitives.length], Math.floor(k / primitives.length), random);
    return turned(quaternion, local).map((coordinate, axis) => coordinate + translation[axis]);
  });
}

function turned([w, x, y, z], v) {
  const u = [x, y, z];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const squared = w * w + x * x + y * y + z * z;
  const t = cross(u, v).map((component) => (2 * component) / squared);
  const more = cross(u, t);
  return v.map((component, k) => component + w * t[k] + more[k]);
}

// ---------------------------------------------------------------- models

const bow = (superquadric, bend, more = {}) => ({ name: "bow", superquadric, bend, ...more });
const ball = (name, radius, translation) => ({
  name,
  superquadric: { semi_axes: [radius, radius, radius], exponents: [1, 1] },
  pose: { translation },
});
const pose = { translation: [0.3, -2, 5], quaternion: [0.4, -1, 0.2, 3] };
const format = "verisq-model/1";
const slender = { semi_axes: [0.5, 0.7, 2], exponents: [0.7, 0.4] };
const sheath = { semi_axes: [3, 2.5, 9], exponents: [0.3, 1.2] };

// A torus, whose triangles are long and thin where it is narrow, and the same turned inward about a second one.
function torus(radius, thickness, [around, along], first = 0) {
  const angle = (k, count) => (2 * Math.PI * k) / count;
  const vertices = [];
  const triangles = [];
  for (let i = 0; i < around; ++i) {
    for (let j = 0; j < along; ++j) {
      const out = radius + thickness * Math.cos(angle(j, along));
      vertices.push([out * Math.cos(angle(i, around)), out * Math.sin(angle(i, around)), thickness * Math.sin(angle(j, along))]);
      const at = (a, b) => first + (a % around) * along + (b % along);
      const [p, q, r, s] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
      triangles.push([p, q, r], [p, r, s]);
    }
  }
  return { vertices, triangles };
}
function nested() {
  const [outer, inner] = [torus(5, 2, [9, 7]), torus(5, 1, [7, 5], 63)];
  return {
    vertices: [...outer.vertices, ...inner.vertices],
    triangles: [...outer.triangles, ...inner.triangles.map(([a, b, c]) => [a, c, b])],
  };
}
const inward = () => {
  const { vertices, triangles } = torus(4, 2, [6, 5]);
  return { vertices, triangles: triangles.map(([a, b, c]) => [a, c, b]) };
};
const crossing = () => ({ ...torus(1, 2, [11, 8]) }); // through itself

const models = {
  "torus.json": JSON.stringify({ format, primitives: [{ name: "ring", mesh: torus(5, 2, [13, 8]) }] }),
  "nested.json": JSON.stringify({ format, primitives: [{ name: "pipe", mesh: { ...nested(), scale: 0.1 }, pose }] }),
  "inward.json": JSON.stringify({ format, primitives: [{ name: "ring", mesh: inward() }] }),
  "crossing.json": JSON.stringify({ format, primitives: [{ name: "apple", mesh: crossing(), pose }] }),
  "ring_and_head.json": JSON.stringify({
    format,
    primitives: [{ name: "ring", mesh: torus(5, 2, [13, 8]) }, ball("head", 3, [5, 1, 1])],
  }),
  "bent_tapered_stem.json": readFileSync(join(examples, "bent_tapered_stem.json"), "utf8"),
  "bent_stem.json": readFileSync(join(examples, "bent_stem.json"), "utf8"),
  "tapered_stem.json": readFileSync(join(examples, "tapered_stem.json"), "utf8"),
  "bow.json": JSON.stringify({
    format,
    primitives: [bow(slender, { curvature: 0.4, angle_deg: 30 }, { pose })],
  }),
  "strong.json": JSON.stringify({
    format,
    primitives: [bow({ ...slender, exponents: [1, 1] }, { curvature: -1.2, angle_deg: 270 })],
  }),
  "slight.json": JSON.stringify({
    format,
    primitives: [bow({ ...slender, taper: 1.7 }, { curvature: 1e-7, angle_deg: 180 }, { pose })],
  }),
  "overlapping.json": JSON.stringify({
    format,
    primitives: [
      bow(sheath, { curvature: 0.08, angle_deg: 123 }),
      ball("head", 3, [1, 0.5, 8]),
      ball("other", 2, [0, 2, 2]),
    ],
  }),
  "hollow.json": JSON.stringify({
    format,
    primitives: [bow(sheath, { curvature: 0.08, angle_deg: 123 }), ball("head", 3, [1, 0.5, 8])],
    csg: { difference: ["bow", "head"] },
  }),
};

// ---------------------------------------------------------------- rows of a .csv

function rowsOf(text) {
  const [header, ...lines] = text.trimEnd().split("\n");
  const keys = header.split(",");
  return lines.map((line) => {
    const fields = line.split(",");
    return Object.fromEntries(keys.map((key, k) => [key, fields[k]]));
  });
}

function csvOf(rows) {
  const keys = Object.keys(rows[0]);
  const lines = rows.map((row, index) => keys.map((key) => (key === "index" ? index : row[key])).join(","));
  return [keys.join(","), ...lines, ""].join("\n");
}

const pointOf = (row, what) =>
  String(row[`${what}_x`] ?? "") ? ["x", "y", "z"].map((axis) => Number(row[`${what}_${axis}`])) : null;

function normalsOf(row) {
  const first = row.primitive ? [{ primitive: Number(row.primitive), vector: pointOf(row, "normal") }] : [];
  const further = row.further_normals.split(" ").filter(Boolean);
  return [
    ...first,
    ...further.map((entry) => {
      const [primitive, ...vector] = entry.split(":").map(Number);
      return { primitive, vector };
    }),
  ];
}

// The digits say themselves where a cover ends: one cell more is left than halved.
function coverOf(digits) {
  const bits = [...(digits ?? "")].flatMap((digit) => [8, 4, 2, 1].map((bit) => (parseInt(digit, 16) & bit) !== 0));
  let left = 1;
  const end = bits.findIndex((isHalved) => (left += isHalved ? 1 : -1) === 0);
  return bits.slice(0, end + 1);
}

const claimOf = (point, row) => ({
  point,
  lo: numberOf(row.lo),
  hi: numberOf(row.hi),
  radius: 0,
  normals: normalsOf(row),
  escape: pointOf(row, "escape"),
  witness: pointOf(row, "witness"),
  cover: coverOf(row.cover),
});

// ---------------------------------------------------------------- forgeries

const past = 1e-12;

// A number with its fourth digit changed.
function otherDigit(text) {
  const places = [...text.split("e")[0]].flatMap((character, k) => (/\d/.test(character) ? [k] : []));
  const place = places[Math.min(3, places.length - 1)];
  return text.slice(0, place) + ((Number(text[place]) + 5) % 10) + text.slice(place + 1);
}
const changed = (row, key, make) => (row[key] ? { ...row, [key]: make(row[key]) } : row);
// As files have them: "inf" where nothing bounds an end. Of such a row no end can be moved.
const numberOf = (text) => Number(text.replace("inf", "Infinity"));
const withEnds = (row, ends) => {
  const [lo, hi] = ends(numberOf(row.lo), numberOf(row.hi));
  return Number.isFinite(lo) && Number.isFinite(hi) ? { ...row, lo: String(lo), hi: String(hi) } : row;
};

// Other vectors, three for each primitive, about as long as the distance or not.
function madeUp(row, count) {
  const size = Math.abs(numberOf(row.hi)) * (0.5 + random());
  const component = () => size * (2 * random() - 1);
  const vectors = Array.from({ length: 3 * count }, (_, k) =>
    [k % count, component(), component(), component()].join(":"),
  );
  const first = { primitive: "0", normal_x: component(), normal_y: component(), normal_z: component() };
  return Number.isFinite(size) ? { ...row, ...first, further_normals: vectors.join(" ") } : row;
}

// What each does to a row of a point, whether the claim is false by construction, and whether an end comes as near to
// the truth as the proofs are tight.
const forgeries = {
  none: { row: (row) => row },
  "lo past hi": { row: (row) => withEnds(row, (lo, hi) => [hi + past, hi + 1]), isFalse: true },
  "hi past lo": { row: (row) => withEnds(row, (lo) => [lo - 1, lo - past]), isFalse: true },
  "lo past hi, made up": {
    row: (row, count) => withEnds(madeUp(row, count), (lo, hi) => [hi + past, hi + 1]),
    isFalse: true,
  },
  "hi past lo, made up": {
    row: (row, count) => withEnds(madeUp(row, count), (lo) => [lo - 1, lo - past]),
    isFalse: true,
  },
  "reversed ends": { row: (row) => withEnds(row, (lo, hi) => [hi + past, lo]), isFalse: true },
  "hi hardly above lo": { row: (row) => withEnds(row, (lo, hi) => [lo, lo + 0.01 * (hi - lo)]), isNear: true },
  "lo hardly below hi": { row: (row) => withEnds(row, (lo, hi) => [hi - 0.01 * (hi - lo), hi]), isNear: true },
  "a vector": { row: (row) => changed(row, "normal_x", otherDigit) },
  "a sign": { row: (row) => changed(row, "normal_z", (text) => String(-Number(text))) },
  "a primitive": { row: (row, count) => changed(row, "primitive", (text) => String((Number(text) + 1) % (count + 1))) },
  "an escape": { row: (row) => changed(row, "escape_y", otherDigit) },
  "a witness": { row: (row) => changed(row, "witness_y", otherDigit) },
  "no further normals": { row: (row) => ({ ...row, further_normals: "" }) },
  "no cover": { row: (row) => ("cover" in row ? { ...row, cover: "" } : row) },
  "another cover": { row: (row) => changed(row, "cover", () => "0") },
  "a point": { point: ([x, y, z]) => [x + 1e-6, y - 1e-6, z] },
  "a model": {
    model: (text) => text.replace(/("curvature": ?)(-?[\d.]+)/, (_, key, digits) => `${key}${Number(digits) * 1.001}`),
  },
};

// ---------------------------------------------------------------- both checkers

const file = (name) => join(options.output, name);
function run(...args) {
  const { status, stdout, stderr } = spawnSync(options.program, [...args, "--no-progress"], { encoding: "utf8" });
  if (status !== 0 && status !== 3) throw new Error(`${args.join(" ")}: ${stderr}`);
  return stdout;
}
function writePoints(name, points) {
  writeFileSync(file(name), points.map((point) => point.join(",")).join("\n") + "\n");
}

// How many of the rows `verisq check` finds to have each verdict.
function countsOfCheck(model, cases) {
  writePoints(
    "checked_points.csv",
    cases.map(({ point }) => point),
  );
  writeFileSync(file("checked.csv"), csvOf(cases.map(({ row }) => row)));
  const found = JSON.parse(
    run("check", "--model", model, "--points", file("checked_points.csv"), "--map", file("checked.csv"), "--json"),
  );
  return { proved: found.proved, refuted: found.refuted, unproved: found.unproved };
}

const totals = { ends: 0, falseEnds: 0, rows: 0, forged: 0, false: 0, falseProved: 0, different: 0, closer: 0, seconds: 0 };

// Rows to which a verdict is given by the page are given to check all together, which has to agree on each.
function compare(reals, text, cases) {
  const name = file("model.json");
  writeFileSync(name, text);
  const checker = new Checker(reals, modelOf(text));
  const start = process.cpuUsage();
  const judged = cases.map((each) => ({ ...each, verdict: checker.verdict(claimOf(each.point, each.row)) }));
  totals.seconds += process.cpuUsage(start).user / 1e6;
  totals.rows += cases.length;
  for (const verdict of ["proved", "refuted", "unproved"]) {
    const alike = judged.filter((each) => each.verdict === verdict);
    if (alike.length === 0) continue;
    tellDifferent(name, alike, verdict);
    const ofKind = Object.keys(forgeries).map((kind) => alike.filter((each) => each.kind === kind).length);
    const kinds = Object.keys(forgeries).flatMap((kind, k) => (ofKind[k] > 0 ? [`${kind} ${ofKind[k]}`] : []));
    console.log(`  ${verdict}: ${kinds.join(", ")}`);
  }
  const known = judged.filter(({ kind, isChanged }) => forgeries[kind].isFalse && isChanged);
  totals.forged += judged.filter(({ kind }) => kind !== "none").length;
  totals.false += known.length;
  totals.falseProved += known.filter(({ verdict }) => verdict === "proved").length;
}

// Finds the rows of another verdict by halving. Of a forged row one checker may still prove what the other does not, by
// a cover, as their bounds over cells differ, or so near to the truth that roundings tell.
function tellDifferent(model, alike, verdict) {
  const counts = countsOfCheck(model, alike);
  if (counts[verdict] === alike.length) return;
  if (alike.length > 1) {
    const middle = alike.length >> 1;
    for (const half of [alike.slice(0, middle), alike.slice(middle)]) tellDifferent(model, half, verdict);
    return;
  }
  const [{ kind, point, row }] = alike;
  const found = Object.keys(counts).find((name) => counts[name] === 1);
  const mayDecide = kind !== "none" && (Boolean(row.cover) || forgeries[kind].isNear === true);
  const isCloser = mayDecide && [verdict, found].includes("unproved");
  totals[isCloser ? "closer" : "different"] += 1;
  console.log(`    ${found} by check, ${kind}: ${point.join()} ${isCloser ? "" : Object.values(row).join()}`);
}

const same = (unchanged) => unchanged;

function compareForged(reals, text, points, rows) {
  const count = modelOf(text).primitives.length;
  const casesOf = ([kind, { row = same, point = same }]) =>
    rows.map((each, k) => {
      const forged = row(each, count);
      return { kind, point: point(points[k]), row: forged, isChanged: forged.lo !== each.lo || forged.hi !== each.hi };
    });
  const kinds = Object.entries(forgeries);
  compare(reals, text, kinds.filter(([, { model }]) => !model).flatMap(casesOf));
  for (const forgery of kinds.filter(([, { model }]) => model && model(text) !== text)) {
    compare(reals, forgery[1].model(text), casesOf(forgery));
  }
}

// The two ends of a mesh's distance meet, so that a false one would hide behind the other: each is asked for alone.
function compareEndsOfMeshes(reals, text, points) {
  const checker = new Checker(reals, modelOf(text));
  const exact = (point) => point.map((x) => ({ lo: reals.exact(x), hi: reals.exact(x) }));
  for (const solid of checker.primitives.filter((primitive) => primitive.upperAlone)) {
    for (const point of points) {
      const query = solid.queryOf(solid.placement.local(exact(point)));
      const { lo, hi } = solid.distance(query);
      const alone = (changes) => Object.assign(Object.create(solid), changes).distance(query);
      const lower = alone({ upperOf: () => reals.exact(1e6) }).lo;
      const upper = alone({ lowerOf: () => reals.zero }).hi;
      const isNear = reals.toNumber(hi, 2) - reals.toNumber(lower, 3) <= 1e-14;
      totals.ends += 1;
      totals.falseEnds += reals.isAtMost(lower, hi) && reals.isAtMost(lo, upper) && isNear ? 0 : 1;
    }
  }
}

const reals = await loadRealNumbers();
for (const [name, text] of Object.entries(models)) {
  console.log(name);
  const model = modelOf(text);
  // Meshes need no covers, and take hardly any time.
  const count = Number(options.points) * (model.primitives.some(({ mesh }) => mesh) ? 5 : 1);
  const points = pointsAbout(model, count, random);
  writePoints("points.csv", points);
  writeFileSync(file(name), text);
  const inputs = ["--model", file(name), "--points", file("points.csv"), "--tol", options.tolerance];
  run("map", ...inputs, "--device", "host", "--certificates", "-o", file("map.csv"));
  compareEndsOfMeshes(reals, text, points);
  compareForged(reals, text, points, rowsOf(readFileSync(file("map.csv"), "utf8")));
}
console.log(`${totals.rows} rows, ${totals.forged} of them forged: ${totals.different} verdicts differ`);
console.log(
  `${totals.closer} forged rows, by covers or near the truth, one checker leaves unproved and the other does not`,
);
console.log(`${totals.false} rows are false: ${totals.falseProved} of them are proved`);
console.log(`${totals.ends} distances to meshes by one end alone: ${totals.falseEnds} are false or loose`);
console.log(`${(totals.rows / totals.seconds).toFixed(0)} rows a second of one core in JavaScript`);
process.exitCode = totals.different > 0 || totals.falseProved > 0 || totals.falseEnds > 0 ? 1 : 0;
