// What vectors prove of a point and one convex primitive where it stands (docs/mathematics.md, section 2). Its own
// frame is about the focus.
import { containsBall } from "./contained_ball.js";
import { Placement } from "./placement.js";
import { down } from "./real_numbers.js";
import { outside } from "./set_tree.js";
import { SuperquadricBounds } from "./superquadric_bounds.js";

export class PlacedSuperquadric {
  constructor(intervals, primitive) {
    this.intervals = intervals;
    this.bounds = new SuperquadricBounds(intervals, primitive);
    this.placement = new Placement(intervals, primitive);
    this.focus = this.placement.onAxis(intervals.negative(this.bounds.focus));
  }

  local(point) {
    const [x, y, z] = this.placement.local(point);
    return [x, y, this.intervals.add(z, this.bounds.focus)];
  }

  // At least this far, by the sphere.
  lowerBySphere(w) {
    return this.bounds.distanceDown(w);
  }

  contains(w) {
    return this.bounds.contains(w);
  }
  // Of the points centre + e, |e_k| <= half_k: where they lie, and that their own coordinates are at + D e with one D
  // of the interval matrix `derivative`.
  over(centre, half) {
    const { intervals, bounds } = this;
    const { reals } = intervals;
    const cell = intervals.box(half);
    const fromFocus = intervals.difference(intervals.translated(centre, cell), this.focus);
    if (reals.isBelow(bounds.radius, intervals.length(fromFocus).lo)) return { place: outside };
    const derivative = this.placement.toOwn;
    const at = this.local(centre);
    const place = bounds.place(intervals.translated(at, intervals.product(derivative, cell)));
    return { place, at, derivative };
  }

  // Whether the ball of radius `radius` (a real number, positive) about w lies in it; w does.
  containsBall(w, radius) {
    return containsBall(this.bounds, w, radius);
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
}
