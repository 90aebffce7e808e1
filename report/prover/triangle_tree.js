// A tree of boxes about triangles, in binary64: the triangle that is nearest, about, and all that may be as near.
const mostInLeaf = 4;
const inner = (u, v) => u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
const minus = (u, v) => [u[0] - v[0], u[1] - v[1], u[2] - v[2]];

// Shares of the corners in the point of the triangle that is closest to q, about (Ericson, Real-Time Collision
// Detection, 2005, section 5.1.5).
export function sharesOfClosest(q, [a, b, c]) {
  const [ab, ac, aq] = [minus(b, a), minus(c, a), minus(q, a)];
  const [abq, acq] = [inner(ab, aq), inner(ac, aq)];
  if (abq <= 0 && acq <= 0) return [1, 0, 0];
  const bq = minus(q, b);
  const [abqB, acqB] = [inner(ab, bq), inner(ac, bq)];
  if (abqB >= 0 && acqB <= abqB) return [0, 1, 0];
  const ofC = abq * acqB - abqB * acq;
  if (ofC <= 0 && abq >= 0 && abqB <= 0) return [-abqB, abq, 0];
  const cq = minus(q, c);
  const [abqC, acqC] = [inner(ab, cq), inner(ac, cq)];
  if (acqC >= 0 && abqC <= acqC) return [0, 0, 1];
  const ofB = abqC * acq - abq * acqC;
  if (ofB <= 0 && acq >= 0 && acqC <= 0) return [-acqC, 0, acq];
  const ofA = abqB * acqC - abqC * acqB;
  if (ofA <= 0 && acqB - abqB >= 0 && abqC - acqC >= 0) return [0, abqC - acqC, acqB - abqB];
  return [ofA, ofB, ofC];
}

// A point of the triangle by such shares, about.
export function pointAt(shares, corners) {
  const sum = shares[0] + shares[1] + shares[2];
  return [0, 1, 2].map((k) => (shares[0] * corners[0][k] + shares[1] * corners[1][k] + shares[2] * corners[2][k]) / sum);
}

export class TriangleTree {
  // vertices: 3 numbers each; triangles: 3 indices of vertices each.
  constructor({ vertices, triangles }) {
    const corner = (n) => [vertices[3 * n], vertices[3 * n + 1], vertices[3 * n + 2]];
    this.triangles = Array.from({ length: triangles.length / 3 }, (_, k) =>
      [0, 1, 2].map((i) => corner(triangles[3 * k + i])),
    );
    const items = this.triangles.map((corners, triangle) => ({
      triangle,
      lower: [0, 1, 2].map((k) => Math.min(...corners.map((v) => v[k]))),
      upper: [0, 1, 2].map((k) => Math.max(...corners.map((v) => v[k]))),
    }));
    this.root = this.node(items);
  }

  // Halves by the middles along the longest edge.
  node(items) {
    const lower = [0, 1, 2].map((k) => items.reduce((least, item) => Math.min(least, item.lower[k]), Infinity));
    const upper = [0, 1, 2].map((k) => items.reduce((most, item) => Math.max(most, item.upper[k]), -Infinity));
    if (items.length <= mostInLeaf) return { lower, upper, items };
    const edges = minus(upper, lower);
    const axis = edges.indexOf(Math.max(...edges));
    const middle = (item) => item.lower[axis] / 2 + item.upper[axis] / 2;
    items.sort((one, other) => middle(one) - middle(other));
    const half = items.length >> 1;
    return { lower, upper, parts: [this.node(items.slice(0, half)), this.node(items.slice(half))] };
  }

  // Calls take(triangle) for all in boxes that may, and some more.
  visit(mayBe, take, node = this.root) {
    if (!mayBe(node)) return;
    if (node.items) {
      for (const item of node.items) if (mayBe(item)) take(item.triangle);
    } else for (const part of node.parts) this.visit(mayBe, take, part);
  }

  // The nearest triangle, about.
  nearest(q) {
    const found = { square: Infinity, triangle: 0 };
    this.approach(q, this.root, found);
    return found.triangle;
  }
  approach(q, node, found) {
    if (node.items) {
      for (const { triangle } of node.items) {
        const corners = this.triangles[triangle];
        const way = minus(q, pointAt(sharesOfClosest(q, corners), corners));
        const square = inner(way, way);
        if (square < found.square) Object.assign(found, { square, triangle });
      }
      return;
    }
    const parts = node.parts.map((part) => ({ part, square: squareDown({ lower: q, upper: q }, part) }));
    if (parts[1].square < parts[0].square) parts.reverse();
    for (const { part, square } of parts) if (square < found.square) this.approach(q, part, found);
  }

  // Triangles, all whose distance from the box about a point is at most the root of `square` among them.
  within(box, square) {
    const found = [];
    this.visit(
      (node) => squareDown(box, node) <= square,
      (triangle) => found.push(triangle),
    );
    return found;
  }
}

// At most the squared distance of two boxes. A difference, a square and a sum round by 2^-53 each; what underflows or
// overflows comes out less than it is, or beyond every finite number.
function squareDown(a, b) {
  let sum = 0;
  for (let k = 0; k < 3; ++k) {
    const way = Math.max(b.lower[k] - a.upper[k], a.lower[k] - b.upper[k], 0);
    sum += way * way;
  }
  return sum * (1 - 2 ** -48);
}
