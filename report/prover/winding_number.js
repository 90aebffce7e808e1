// How often a closed mesh winds about a point, and whether a triangle holds it: in whole numbers, so that nothing is
// rounded (docs/mathematics.md, section 29).
import { partsOf } from "./decimal.js";

// A binary64 number is integer * 2^exponent.
function exponentOf(x) {
  let { significand, exponent } = partsOf(x);
  if (significand === 0n) return Infinity;
  while ((significand & 1n) === 0n) {
    significand >>= 1n;
    ++exponent;
  }
  return exponent;
}
function integerOf(x, exponent) {
  const parts = partsOf(x);
  const shift = BigInt(parts.exponent - exponent);
  const size = shift >= 0n ? parts.significand << shift : parts.significand >> -shift;
  return x < 0 ? -size : size;
}

const minus = (u, v) => u.map((component, k) => component - v[k]);
const cross = (u, v) => [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
const dot = (u, v) => u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
const signOf = (x) => (x > 0n ? 1 : x < 0n ? -1 : 0);

// A triangle about the point q: whole numbers, all scaled alike.
function aboutPoint(q, corners) {
  const exponent = Math.min(...[q, ...corners].flat().map(exponentOf), 0);
  const [at, ...others] = [q, ...corners].map((v) => v.map((x) => integerOf(x, exponent)));
  return others.map((v) => minus(v, at));
}

// How often the triangle's image in the plane of y and z winds about the origin. The origin is moved by (e, e^2) with
// an infinitely small e > 0: a corner at z = 0 lies below it, and a side through it lies to the left of it. The sign of
// a side is that of its way up, the same for both of its triangles.
function windingOfImage(corners) {
  let winding = 0;
  for (let k = 0; k < 3; ++k) {
    const [s, t] = [corners[k], corners[(k + 1) % 3]];
    const [isLow, goesLow] = [s[2] <= 0n, t[2] <= 0n];
    if (isLow === goesLow) continue;
    const [from, to] = isLow ? [s, t] : [t, s];
    const isToTheLeft = (to[1] - from[1]) * -from[2] + from[1] * (to[2] - from[2]) > 0n;
    if (isToTheLeft) winding += isLow ? 1 : -1;
  }
  return winding;
}

export class WindingNumber {
  constructor(tree) {
    this.tree = tree;
  }

  // Along the ray from q (three binary64 numbers) to larger x. No triangle may hold q.
  about(q) {
    let winding = 0;
    const isMet = ({ lower, upper }) =>
      q[0] <= upper[0] && lower[1] <= q[1] && q[1] <= upper[1] && lower[2] <= q[2] && q[2] <= upper[2];
    this.tree.visit(isMet, (triangle) => {
      const corners = aboutPoint(q, this.tree.triangles[triangle]);
      const ofImage = windingOfImage(corners);
      if (ofImage === 0) return;
      const normal = cross(minus(corners[1], corners[0]), minus(corners[2], corners[0]));
      // The ray meets the plane at x = normal.corner / normal.x.
      if (signOf(dot(normal, corners[0])) * signOf(normal[0]) > 0) winding += ofImage;
    });
    return winding;
  }

  // True if q lies on the triangle, which has an area.
  holds(q, triangle) {
    const [a, b, c] = aboutPoint(q, this.tree.triangles[triangle]);
    const normal = cross(minus(b, a), minus(c, a));
    if (dot(normal, a) !== 0n) return false;
    const signs = [cross(a, b), cross(b, c), cross(c, a)].map((area) => signOf(dot(area, normal)));
    return normal.some((component) => component !== 0n) && signs.every((sign) => sign >= 0);
  }
}

// Throws unless each edge is run through as often one way as the other; vertices are told apart by their coordinates.
export function requireClosed({ vertices, triangles }) {
  const places = new Map();
  const placeOf = (n) => {
    const key = `${vertices[3 * n]},${vertices[3 * n + 1]},${vertices[3 * n + 2]}`;
    if (!places.has(key)) places.set(key, places.size);
    return places.get(key);
  };
  const corners = Array.from(triangles, placeOf);
  const edges = new Map();
  corners.forEach((from, k) => {
    const to = corners[k % 3 === 2 ? k - 2 : k + 1];
    const key = Math.min(from, to) * places.size + Math.max(from, to);
    edges.set(key, (edges.get(key) ?? 0) + Math.sign(to - from));
  });
  if ([...edges.values()].some((balance) => balance !== 0)) throw new Error("mesh: its surface is not closed");
}
