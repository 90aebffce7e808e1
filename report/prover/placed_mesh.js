// A closed mesh where it stands: its signed distance from a point, found anew from all of its triangles
// (docs/mathematics.md, section 29). It needs no certificate.
import { Placement } from "./placement.js";
import { down, up } from "./real_numbers.js";
import { inside, open, outside } from "./set_tree.js";
import { TriangleTree, pointAt, sharesOfClosest } from "./triangle_tree.js";
import { WindingNumber, requireClosed } from "./winding_number.js";

export class PlacedMesh {
  constructor(intervals, { mesh, translation, quaternion }) {
    requireClosed(mesh);
    this.intervals = intervals;
    this.placement = new Placement(intervals, { translation, quaternion });
    this.tree = new TriangleTree(mesh);
    this.winding = new WindingNumber(this.tree);
  }

  // What the other functions take of a point: bounds of its signed distance.
  local(point) {
    return this.signedDistance(this.placement.local(point));
  }
  lowerBySphere({ lo }) {
    return lo;
  }
  lowerByNormal({ lo }) {
    return lo;
  }
  upperAlone({ hi }) {
    return hi;
  }
  // Of a point alone, whatever `half` is: sets with meshes have no cells.
  over(centre) {
    const { reals } = this.intervals;
    const { lo, hi } = this.local(centre);
    if (reals.isBelow(reals.zero, lo)) return { place: outside };
    return { place: reals.isBelow(hi, reals.zero) ? inside : open };
  }

  // Of a box about a point, in the mesh's frame.
  signedDistance(at) {
    const { reals } = this.intervals;
    const query = this.queryOf(at);
    if (![...query.lower, ...query.upper].every(Number.isFinite)) return { lo: reals.minusInfinity, hi: reals.infinity };
    const { lo, hi, near } = this.distance(query);
    if (reals.isBelow(query.displacement, lo)) {
      const isInside = this.winding.about(query.middle) !== 0;
      return isInside ? { lo: reals.negative(hi), hi: reals.negative(lo) } : { lo, hi };
    }
    const isOn = query.isExact && near.some((triangle) => this.winding.holds(query.middle, triangle));
    return isOn ? { lo: reals.zero, hi: reals.zero } : { lo: reals.negative(hi), hi };
  }

  // The box rounded outward to binary64, a binary64 point in or near it, and how far that is from the box's points.
  queryOf(at) {
    const { intervals } = this;
    const { reals } = intervals;
    const middle = at.map((component) => reals.toNumber(intervals.middle(component), down));
    const off = intervals.difference(
      at,
      middle.map((x) => intervals.exact(x)),
    );
    const displacement = intervals.length(off).hi;
    return {
      at,
      middle,
      displacement,
      isExact: reals.isAtMost(displacement, reals.zero),
      lower: at.map(({ lo }) => reals.toNumber(lo, down)),
      upper: at.map(({ hi }) => reals.toNumber(hi, up)),
    };
  }

  // Of the surface. `near` are the triangles that are not proven to be farther.
  distance(query) {
    const { reals } = this.intervals;
    const first = this.tree.triangles[this.tree.nearest(query.middle)];
    let hi = this.upperOf(query, first, sharesOfClosest(query.middle, first));
    let lo = reals.infinity;
    const near = [];
    for (const triangle of this.tree.within(query, reals.toNumber(reals.mul(hi, hi, up), up))) {
      const corners = this.tree.triangles[triangle];
      const shares = sharesOfClosest(query.middle, corners);
      if (lowerInBinary64(query.middle, corners, shares) - reals.toNumber(query.displacement, up) > reals.toNumber(hi, up))
        continue;
      near.push(triangle);
      lo = reals.least(lo, this.lowerOf(query, corners, shares));
      hi = reals.least(hi, this.upperOf(query, corners, shares));
    }
    return { lo: near.length > 0 ? reals.least(lo, hi) : reals.zero, hi, near };
  }

  // By the point of the triangle that has these shares: what is divided by their sum is exactly in it.
  upperOf({ at }, corners, shares) {
    const { intervals } = this;
    const { reals } = intervals;
    const isUsable = shares.every((share) => share >= 0 && share < Infinity);
    const [a, b, c] = (isUsable ? shares : [1, 1, 1]).map((share) => intervals.exact(share));
    const sum = intervals.sum([a, b, c]);
    if (!reals.isBelow(reals.zero, sum.lo)) return reals.infinity;
    const way = [0, 1, 2].map((k) => {
      const [x, y, z] = corners.map((v) => intervals.exact(v[k]));
      const weighted = intervals.sum([intervals.mul(a, x), intervals.mul(b, y), intervals.mul(c, z)]);
      return intervals.sub(at[k], intervals.div(weighted, sum));
    });
    return intervals.length(way).hi;
  }

  // The best that the normal of the face, of the proposed side or corner, and the way to the proposed point prove.
  lowerOf(query, corners, shares) {
    const { reals } = this.intervals;
    const proposed = this.wayTo(query, corners, shares);
    const direct = this.exactVector(pointAt(shares, corners).map((x, k) => query.middle[k] - x));
    return reals.greatest(this.lowerBy(query, corners, proposed), this.lowerBy(query, corners, direct));
  }

  exactVector(v) {
    return v.every(Number.isFinite) ? v.map((x) => this.intervals.exact(x)) : null;
  }

  // A vector of numbers, about at right angles to the face or side, towards the point; any would do.
  wayTo({ at, middle }, corners, shares) {
    const { intervals } = this;
    const { reals } = intervals;
    const point = (v) => v.map((x) => intervals.exact(x));
    const thin = (v) => v.map(({ lo }) => ({ lo, hi: lo }));
    const used = corners.filter((_, k) => shares[k] > 0).map(point);
    const fromFirst = thin(intervals.difference(at, used[0] ?? point(corners[0])));
    if (used.length < 2) return fromFirst;
    const along = thin(intervals.difference(used[1], used[0]));
    if (used.length === 2) {
      const square = intervals.dot(along, along);
      if (!reals.isBelow(reals.zero, square.lo)) return null;
      const share = thin([intervals.div(intervals.dot(fromFirst, along), square)])[0];
      return thin(fromFirst.map((x, k) => intervals.sub(x, intervals.mul(share, along[k]))));
    }
    const other = thin(intervals.difference(used[2], used[0]));
    const product = (i, j) => intervals.sub(intervals.mul(along[i], other[j]), intervals.mul(along[j], other[i]));
    const normal = thin([product(1, 2), product(2, 0), product(0, 1)]);
    return intervals.isNegative(intervals.dot(normal, fromFirst)) ? normal.map((x) => intervals.negative(x)) : normal;
  }

  // min n.(q - v) / |n| over the corners v, rounded down; 0 where that proves nothing.
  lowerBy({ at }, corners, n) {
    const { intervals } = this;
    const { reals } = intervals;
    if (!n) return reals.zero;
    const length = intervals.length(n);
    if (!reals.isBelow(reals.zero, length.lo)) return reals.zero;
    const heights = corners.map(
      (v) =>
        intervals.dot(
          n,
          intervals.difference(
            at,
            v.map((x) => intervals.exact(x)),
          ),
        ).lo,
    );
    const least = heights.reduce((a, b) => reals.least(a, b));
    return reals.isBelow(reals.zero, least) ? reals.div(least, length.hi, down) : reals.zero;
  }
}

// The same bound by the way to the proposed point, in binary64, from the middle; 0 where it proves nothing. Let u be
// 2^-53. A difference, a product and two sums round by 4 u of |n| times the sum of a difference's components, root and
// quotient by 4 u more: 2^-46 of that sum is a good deal more. Nothing that matters underflows.
function lowerInBinary64(q, corners, shares) {
  const n = pointAt(shares, corners).map((x, k) => q[k] - x);
  const square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
  let [least, longest] = [Infinity, 0];
  for (const v of corners) {
    const way = [q[0] - v[0], q[1] - v[1], q[2] - v[2]];
    least = Math.min(least, n[0] * way[0] + n[1] * way[1] + n[2] * way[2]);
    longest = Math.max(longest, Math.abs(way[0]) + Math.abs(way[1]) + Math.abs(way[2]));
  }
  if (!(square > 2 ** -900 && square < Infinity && longest > 2 ** -400)) return 0;
  return least / Math.sqrt(square) - 2 ** -46 * longest;
}
