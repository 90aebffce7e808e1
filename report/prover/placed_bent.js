// What vectors prove of a point and one bent primitive where it stands (docs/mathematics.md, section 9). Points of its
// own frame, about its centre, are given as they are and unbent.
import { Bend } from "./bend.js";
import { BentBall } from "./bent_ball.js";
import { Placement } from "./placement.js";
import { down, up } from "./real_numbers.js";
import { open, outside } from "./set_tree.js";
import { SuperquadricBounds } from "./superquadric_bounds.js";
import { TangentPlane } from "./tangent_plane.js";

export class PlacedBent {
  // Throws for bends that are not proven to be admitted: what is proven here holds of one-to-one bends alone.
  constructor(intervals, primitive) {
    Object.assign(this, { intervals, reals: intervals.reals });
    this.bounds = new SuperquadricBounds(intervals, primitive);
    this.placement = new Placement(intervals, primitive);
    this.bend = new Bend(intervals, primitive.bend);
    this.size = intervals.abs(this.bend.curvature); // |k|
    this.widest = intervals.mul(this.size, this.bounds.axes[2]).hi; // of the angles of the solid
    this.requireAdmitted();
    this.radius = this.circumradius();
    const ends = { lo: this.widest, hi: this.widest };
    this.cosineOfEnds = this.bend.trigonometry.cosine(ends);
    this.sineOfEnds = this.bend.trigonometry.sine(ends);
    this.toTurned = this.turnedRows();
    this.tangentPlane = new TangentPlane(intervals, this.bend, this.widest);
  }

  requireAdmitted() {
    const { intervals, reals, bend, bounds } = this;
    const extent = bounds.supportUp([bend.cosine, bend.sine, intervals.exact(0)]); // both ways: K is even in x and y
    const isNarrow = reals.isBelow(reals.mul(this.size.hi, extent, up), reals.one);
    if (isNarrow && reals.isBelow(this.widest, bend.trigonometry.halfTurn.lo)) return;
    throw new Error("a bend of the model is not proven to be one-to-one");
  }

  // About the centre: the axis bends without getting longer, and no point gets farther from it.
  circumradius() {
    const { intervals, bounds } = this;
    const [zero, one] = [intervals.exact(0), intervals.exact(1)];
    const side = (v) => ({ lo: this.reals.zero, hi: bounds.supportUp(v) });
    const aside = intervals.length([side([one, zero, zero]), side([zero, one, zero])]);
    return intervals.add(bounds.axes[2], aside).hi;
  }

  // From the model's frame to that along the bend.
  turnedRows() {
    const { toOwn } = this.placement;
    const columns = [0, 1, 2].map((k) => this.bend.turned(toOwn.map((row) => row[k])));
    return [0, 1, 2].map((row) => columns.map((column) => column[row]));
  }

  local(point) {
    const bent = this.bend.turned(this.placement.local(point));
    return { bent, unbent: this.bend.unbent(bent) };
  }
  // An unbent place in the frame of gauge and support function, about the focus.
  aboutFocus(unbent) {
    const [x, y, z] = this.bend.turnedBack(unbent);
    return [x, y, this.intervals.add(z, this.bounds.focus)];
  }

  lowerBySphere({ bent }) {
    return this.reals.sub(this.intervals.length(bent).lo, this.radius, down);
  }

  contains({ unbent }) {
    return unbent !== null && this.bounds.contains(this.aboutFocus(unbent));
  }
  // m sin A < |k Z| cos A says of points at the angle gamma of (m, k Z) that |gamma| > A, the angle of the ends.
  isBeyondEnds(bent) {
    const { intervals, reals, bend } = this;
    const inward = intervals.mul(bend.stretch(bent), this.sineOfEnds);
    const outward = intervals.mul(intervals.abs(bend.angle(bent)), this.cosineOfEnds);
    return reals.isBelow(intervals.sub(inward, outward).hi, reals.zero);
  }

  // Of the points centre + e, |e_k| <= half_k: where they lie, and that their own coordinates, unbent and about the
  // focus, are at + D e with one D of the interval matrix `derivative`, by the mean value theorem.
  over(centre, half) {
    const { intervals, reals, bend, bounds } = this;
    const cell = intervals.box(half);
    const fromCentre = intervals.difference(intervals.translated(centre, cell), this.placement.translation);
    if (reals.isBelow(this.radius, intervals.length(fromCentre).lo)) return { place: outside };
    const bent = bend.turned(this.placement.local(centre));
    const all = intervals.translated(bent, intervals.product(this.toTurned, cell));
    if (this.isBeyondEnds(all)) return { place: outside };
    const [place, widely] = [bend.unbent(bent), bend.unbent(all)];
    const slopes = place && widely && bend.unbending(widely);
    if (!slopes) return { place: open };
    const closely = intervals.translated(place, this.moved(slopes, cell));
    const range = intervals.common(widely, closely);
    const derivative = this.derivativeBy(bend.unbending(range));
    const at = this.aboutFocus(place);
    const straight = intervals.translated(at, intervals.product(derivative, cell));
    return { place: bounds.place(intervals.common(this.aboutFocus(range), straight)), at, derivative };
  }
  moved(slopes, cell) {
    return this.intervals.product(slopes, this.intervals.product(this.toTurned, cell));
  }
  // Of the own coordinates by the model's, from that of the unbent place by the bent one.
  derivativeBy(slopes) {
    const columns = [0, 1, 2].map((k) => {
      const column = this.toTurned.map((row) => row[k]);
      return this.bend.turnedBack(this.intervals.product(slopes, column));
    });
    return [0, 1, 2].map((row) => columns.map((column) => column[row]));
  }

  // p = q - v of the section; null where it cannot be unbent.
  proposed(w, v) {
    const apart = this.bend.turned(v).map((component) => this.intervals.negative(component));
    const place = this.bend.unbent([0, 1, 2].map((k) => this.intervals.add(w.bent[k], apart[k])));
    return place && { apart, place };
  }

  // |p - q|^2 - 2 (h(-n) + n.x0), n = B'(x0)^T (p - q): where the squared distance lies above that tangent plane.
  lowerByNormal(w, v) {
    const { intervals, reals, bend } = this;
    const found = w.unbent && this.proposed(w, v);
    if (!found) return reals.minusInfinity;
    const { apart, place } = found;
    const upper = this.distanceToImage(w, place);
    if (!this.tangentPlane.isBelow(w.unbent, place, upper)) return reals.minusInfinity;
    const n = bend.turnedBack(bend.pulledBack(apart, place));
    const behind = this.bounds.supportUp(n.map((component) => intervals.negative(component)));
    const loss = reals.add(behind, intervals.dot(n, this.aboutFocus(place)).hi, up);
    const squared = v.map((component) => intervals.square(component).lo).reduce((a, b) => reals.add(a, b, down));
    const left = reals.sub(squared, reals.add(loss, loss, up), down);
    return reals.isBelow(reals.zero, left) ? reals.sqrt(left, down) : reals.minusInfinity;
  }

  upperByNormal(w, v) {
    const found = this.proposed(w, v);
    return found ? this.distanceToImage(w, found.place) : this.reals.infinity;
  }

  // To the image of a place scaled to the surface, rounded up.
  distanceToImage(w, place) {
    const { intervals, reals, bend } = this;
    const x = this.aboutFocus(place);
    const gauge = this.bounds.gaugeUp(x);
    if (!reals.isBelow(gauge, reals.infinity)) return reals.infinity;
    const isPositive = reals.isBelow(reals.zero, gauge); // else x is the focus
    const [b1, b2, b3] = isPositive ? x.map((component) => intervals.div(component, { lo: gauge, hi: gauge })) : x;
    const image = bend.bent(bend.turned([b1, b2, intervals.sub(b3, this.bounds.focus)]));
    return intervals.length(intervals.difference(w.bent, image)).hi;
  }

  // Whether the ball of radius `radius` (a real number, positive) about w lies in it, v pointing away from where it
  // comes nearest to the boundary; null, nowhere.
  containsBall(w, radius, v) {
    const { intervals, reals } = this;
    if (w.unbent === null || v === null) return false;
    const longer = reals.div(radius, intervals.length(v).lo, up);
    const found = this.proposed(
      w,
      v.map((component) => intervals.mul(component, { lo: longer, hi: longer })), // of a ball at least as large
    );
    return found !== null && new BentBall(this, w.unbent, found).isContained();
  }
}
