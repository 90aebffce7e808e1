// A closed mesh where it stands: its signed distance from a point, found anew from all of its triangles
// (docs/mathematics.md, section 29). It needs no certificate.
import { Placement } from "./placement.js";
import { down, up } from "./real_numbers.js";
import { inside, open, outside } from "./set_tree.js";
import { TriangleTree, pointAt, sharesOfClosest } from "./triangle_tree.js";
import { WindingNumber, requireClosed } from "./winding_number.js";

// Numbers near the intervals.
const thin = (v) => v.map(({ lo }) => ({ lo, hi: lo }));

export class PlacedMesh {
  constructor(intervals, { mesh, translation, quaternion }) {
    requireClosed(mesh);
    this.intervals = intervals;
    this.placement = new Placement(intervals, { translation, quaternion });
    this.tree = new TriangleTree(mesh);
    this.winding = new WindingNumber(this.tree);
  }

  // The bounds of a point's signed distance, which the other functions take.
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
  // Takes a point alone: sets with meshes have no cells.
  over(centre) {
    const { reals } = this.intervals;
    const { lo, hi } = this.local(centre);
    if (reals.isBelow(reals.zero, lo)) return { place: outside };
    return { place: reals.isBelow(hi, reals.zero) ? inside : open };
  }

  // Bounds for all points of a box, in the mesh's frame.
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

  // The distance to the surface. `near` are the triangles that are not proven to be farther.
  distance(query) {
    const { reals } = this.intervals;
    const first = this.tree.triangles[this.tree.nearest(query.middle)];
    let hi = this.upperOf(query, first, this.proposal(query, first));
    let lo = reals.infinity;
    const near = [];
    for (const triangle of this.tree.within(query, reals.toNumber(reals.mul(hi, hi, up), up))) {
      const corners = this.tree.triangles[triangle];
      const least = lowerInBinary64(query.middle, corners) - reals.toNumber(query.displacement, up);
      if (least > reals.toNumber(hi, up)) continue;
      const proposal = this.proposal(query, corners);
      near.push(triangle);
      lo = reals.least(lo, this.lowerOf(query, corners, proposal));
      hi = reals.least(hi, this.upperOf(query, corners, proposal));
    }
    return { lo: near.length > 0 ? reals.least(lo, hi) : reals.zero, hi, near };
  }

  point(v) {
    return v.map((x) => this.intervals.exact(x));
  }

  // Shares of the corners in the point that is closest, about, and the way from there: proposals, which prove nothing.
  proposal({ at }, corners) {
    const q = thin(at);
    const [a, b, c] = corners.map((v) => this.point(v));
    return this.onFace(q, a, b, c) ?? this.onSides(q, [a, b, c]);
  }

  // null where the foot on the plane lies beside the triangle, about.
  onFace(q, a, b, c) {
    const { intervals } = this;
    const { reals } = intervals;
    const [qa, qb, qc] = [a, b, c].map((v) => thin(intervals.difference(v, q)));
    const way = thin(
      this.cross(thin(intervals.difference(b, a)), thin(intervals.difference(c, a))),
    );
    const areas = [this.cross(qb, qc), this.cross(qc, qa), this.cross(qa, qb)].map((area) => intervals.dot(area, way).lo);
    if (!areas.every((area) => reals.isBelow(reals.zero, area))) return null;
    const isBehind = reals.isBelow(reals.zero, intervals.dot(way, qa).lo);
    return {
      shares: areas.map((area) => reals.toNumber(area, down)),
      way: isBehind ? way.map((x) => intervals.negative(x)) : way,
    };
  }

  // The shortest of the ways from the three sides.
  onSides(q, corners) {
    const { intervals } = this;
    const { reals } = intervals;
    const sides = [0, 1, 2].map((k) => {
      const [from, to] = [corners[k], corners[(k + 1) % 3]];
      const [along, fromFirst] = [thin(intervals.difference(to, from)), thin(intervals.difference(q, from))];
      const square = intervals.dot(along, along);
      const foot = reals.isBelow(reals.zero, square.lo)
        ? reals.div(intervals.dot(fromFirst, along).lo, square.lo, down)
        : reals.zero;
      const share = reals.least(reals.greatest(foot, reals.zero), reals.one);
      const way = thin(fromFirst.map((x, i) => intervals.sub(x, intervals.mul({ lo: share, hi: share }, along[i]))));
      const shares = [0, 0, 0];
      shares[(k + 1) % 3] = reals.toNumber(share, down);
      shares[k] = reals.toNumber(reals.sub(reals.one, share, down), down);
      return { shares, way, square: intervals.dot(way, way).lo };
    });
    return sides.reduce((best, side) => (reals.isBelow(side.square, best.square) ? side : best));
  }

  cross(u, v) {
    const { intervals } = this;
    const entry = (i, j) => intervals.sub(intervals.mul(u[i], v[j]), intervals.mul(u[j], v[i]));
    return [entry(1, 2), entry(2, 0), entry(0, 1)];
  }

  // By the point of the triangle that has these shares: what is divided by their sum is exactly in it.
  upperOf({ at }, corners, { shares }) {
    const { intervals } = this;
    const { reals } = intervals;
    if (!shares.every((share) => share >= 0 && share < Infinity)) return reals.infinity;
    const [a, b, c] = this.point(shares);
    const sum = intervals.sum([a, b, c]);
    if (!reals.isBelow(reals.zero, sum.lo)) return reals.infinity;
    const way = [0, 1, 2].map((k) => {
      const [x, y, z] = corners.map((v) => intervals.exact(v[k]));
      const weighted = intervals.sum([intervals.mul(a, x), intervals.mul(b, y), intervals.mul(c, z)]);
      return intervals.sub(at[k], intervals.div(weighted, sum));
    });
    return intervals.length(way).hi;
  }

  // min n.(q - v) / |n| over the corners v, with the way as n, rounded down; 0 where that proves nothing.
  lowerOf({ at }, corners, { way }) {
    const { intervals } = this;
    const { reals } = intervals;
    const length = intervals.length(way);
    const heights = corners.map((v) => intervals.dot(way, intervals.difference(at, this.point(v))).lo);
    const least = heights.reduce((a, b) => reals.least(a, b));
    if (!reals.isBelow(reals.zero, length.lo) || !reals.isBelow(reals.zero, least)) return reals.zero;
    return reals.div(least, length.hi, down);
  }
}

// The same bound in binary64, from the middle, by the way to a point that binary64 proposes; 0 where it proves nothing.
// Let u be 2^-53. A difference, a product and two sums round by 4 u of |n| times the sum of a difference's components,
// root and quotient by 4 u more. 2^-46 of that sum is a good deal more, even if a browser's root were off by 2^-48.
// Nothing that matters underflows.
function lowerInBinary64(q, corners) {
  const n = pointAt(sharesOfClosest(q, corners), corners).map((x, k) => q[k] - x);
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
