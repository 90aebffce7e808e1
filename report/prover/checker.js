// What a certificate proves of one point (docs/mathematics.md, sections 2 and 12), and what that says of a claim.
import { containsBall } from "./contained_ball.js";
import { Intervals } from "./intervals.js";
import { Placement } from "./placement.js";
import { down, up } from "./real_numbers.js";
import { SuperquadricBounds } from "./superquadric_bounds.js";

class PlacedPrimitive {
  constructor(intervals, primitive) {
    this.intervals = intervals;
    this.bounds = new SuperquadricBounds(intervals, primitive);
    this.placement = new Placement(intervals, primitive);
  }

  // About the focus.
  local(point) {
    const [x, y, z] = this.placement.local(point);
    return [x, y, this.intervals.add(z, this.bounds.focus)];
  }

  // (v.w - h(v)) / |v|, rounded down.
  lowerByNormal(w, v) {
    const { intervals, bounds } = this;
    const { reals } = intervals;
    const height = reals.sub(intervals.dot(v, w).lo, bounds.supportUp(v), down);
    const length = intervals.length(v);
    return reals.div(height, reals.isBelow(height, reals.zero) ? length.lo : length.hi, down);
  }

  // The distance to the point of the solid on the ray from the focus through w - v, rounded up.
  upperByNormal(w, v) {
    const { intervals, bounds } = this;
    const { reals } = intervals;
    const x = intervals.difference(w, v);
    const gauge = bounds.gaugeUp(x);
    if (!reals.isBelow(reals.zero, gauge)) return reals.infinity;
    const b = x.map((component) => intervals.div(component, { lo: gauge, hi: gauge }));
    return intervals.length(intervals.difference(w, b)).hi;
  }

  // An upper end: `claimed` or less where that can be proven; v is an exact vector, not 0.
  upper(w, v, claimed) {
    const { bounds } = this;
    const { reals } = this.intervals;
    if (reals.isBelow(reals.zero, claimed)) {
      const byNormal = this.upperByNormal(w, v);
      if (reals.isAtMost(byNormal, claimed)) return byNormal;
    }
    if (!bounds.contains(w)) return this.upperByNormal(w, v);
    const claimsDepth = reals.isBelow(claimed, reals.zero);
    return claimsDepth && containsBall(bounds, w, reals.negative(claimed)) ? claimed : reals.zero;
  }
}

const isFinite3 = (v) => v.every(Number.isFinite);
const isUsable = ({ vector }) => isFinite3(vector) && vector.some((component) => component !== 0);

export class Checker {
  // `primitives` as the model's reader gives them; lives as long as `reals`, which serve nobody else.
  constructor(reals, primitives) {
    this.reals = reals;
    this.intervals = new Intervals(reals);
    reals.forgetFailures();
    this.primitives = primitives.map((primitive) => new PlacedPrimitive(this.intervals, primitive));
    if (reals.failed()) throw new Error("the model's numbers leave the range of the arithmetic");
  }

  // { point, lo, hi, radius, normals: [{ primitive, vector }], escape: point or null } gives "proved", "refuted" or
  // "unproved". The claim is of every point within `radius` of the given one, whose distances differ by no more.
  verdict(row) {
    const { reals } = this;
    const { lo, hi } = row;
    if (Number.isNaN(lo) || Number.isNaN(hi) || !isFinite3(row.point)) return "unproved";
    if (lo > hi) return "refuted";
    const mark = reals.mark();
    reals.forgetFailures();
    const verdict = this.judged(row);
    const failed = reals.failed();
    reals.release(mark);
    return failed ? "unproved" : verdict;
  }

  judged({ point, lo, hi, radius, normals, escape }) {
    const { reals, intervals } = this;
    const wanted = {
      lo: reals.add(reals.exact(lo), reals.exact(radius), up),
      hi: reals.sub(reals.exact(hi), reals.exact(radius), down),
    };
    const usable = normals.filter((normal) => normal.primitive < this.primitives.length && isUsable(normal));
    const x = point.map((coordinate) => intervals.exact(coordinate));
    const local = this.primitives.map((primitive) => primitive.local(x));
    // Of the given point, rounded outward to binary64, as enclosures are.
    const lower = this.lower(x, local, usable, escape);
    if (hi < reals.toNumber(lower, down)) return "refuted";
    const upper = this.upper(local, usable, wanted.hi);
    if (reals.toNumber(upper, up) < lo) return "refuted";
    return reals.isAtMost(wanted.lo, lower) && reals.isAtMost(upper, wanted.hi) ? "proved" : "unproved";
  }

  // The distance to a union is the least of those to its primitives where all are positive. Where they are not, an
  // escape says how deep the point is at most.
  lower(x, local, normals, escape) {
    const { reals, primitives } = this;
    const bounds = primitives.map(({ bounds }, k) => bounds.distanceDown(local[k]));
    for (const { primitive, vector } of normals) {
      const v = vector.map((component) => this.intervals.exact(component));
      bounds[primitive] = reals.greatest(bounds[primitive], primitives[primitive].lowerByNormal(local[primitive], v));
    }
    const least = bounds.reduce((a, b) => reals.least(a, b));
    if (reals.isBelow(reals.zero, least)) return least;
    const byNormals = primitives.length === 1 ? least : reals.minusInfinity;
    return escape && isFinite3(escape) ? reals.greatest(byNormals, this.lowerByEscape(x, escape)) : byNormals;
  }

  lowerByEscape(x, escape) {
    const { reals, intervals } = this;
    const w = escape.map((coordinate) => intervals.exact(coordinate));
    if (!this.primitives.every((primitive) => primitive.bounds.excludes(primitive.local(w))))
      return reals.minusInfinity;
    return reals.negative(intervals.length(intervals.difference(w, x)).hi);
  }

  upper(local, normals, claimed) {
    const { reals } = this;
    let least = reals.infinity;
    for (const { primitive, vector } of normals) {
      const v = vector.map((component) => this.intervals.exact(component));
      least = reals.least(least, this.primitives[primitive].upper(local[primitive], v, claimed));
      if (reals.isAtMost(least, claimed)) break;
    }
    return least;
  }
}
