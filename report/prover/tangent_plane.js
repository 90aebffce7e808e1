// Whether the squared distance from a point to a bent solid's points lies, before the bend, above a tangent plane
// wherever that matters (docs/mathematics.md, section 9). Places are unbent.
import { down, up } from "./real_numbers.js";

const smallTurn = 2 ** -20; // below, phi's series is tighter than its quotient of rounded numbers

export class TangentPlane {
  // `widest` bounds the angles of the solid's points.
  constructor(intervals, bend, widest) {
    Object.assign(this, { intervals, reals: intervals.reals, bend, widest });
    const { halfTurn } = bend.trigonometry;
    const { reals } = this;
    this.fullTurn = reals.mul(halfTurn.lo, reals.two, down);
    this.threeQuarters = reals.mul(halfTurn.lo, reals.exact(1.5), down);
    this.quarter = { lo: reals.div(halfTurn.lo, reals.two, down), hi: reals.div(halfTurn.hi, reals.two, up) };
  }

  // That at the place x, on all points of the solid within `upper` of the query q; the nearest one is. The condition
  //   W0 (cos D - phi(d) sin D) >= Wq sin^2(D + d/2)
  // for all their turns d from x, D being x's turn from q.
  isBelow(q, x, upper) {
    const { intervals, reals, bend } = this;
    const { trigonometry } = bend;
    const apart = intervals.sub(bend.angle(x), bend.angle(q));
    // Within half a turn sin D has the sign of D.
    if (!reals.isBelow(intervals.abs(apart).hi, trigonometry.halfTurn.lo)) return false;
    const range = this.anglesWithin(q, upper);
    const steepest = this.phiUp(this.largestTurn(apart, range));
    if (steepest === null) return false;
    const slope = { lo: steepest, hi: steepest };
    const bending = intervals.sub(
      trigonometry.cosine(apart),
      intervals.mul(slope, intervals.abs(trigonometry.sine(apart))),
    );
    const risen = intervals.mul(bend.stretch(x), bending).lo;
    return reals.isAtMost(reals.mul(bend.stretch(q).hi, this.largestSquaredSine(apart, range), up), risen);
  }

  // Of the points that count, in which interval their angles lie about the query's: between the ends of the solid, and
  // seen from the centre of curvature, where that is farther than `upper`. Less than three quarters of a turn from the
  // query, an angle of which the sine is small and the cosine positive is that small itself.
  anglesWithin(q, upper) {
    const { intervals, reals, bend, widest } = this;
    const [angle, stretch] = [bend.angle(q), bend.stretch(q)];
    const ends = {
      lo: reals.sub(reals.negative(widest), angle.hi, down),
      hi: reals.sub(widest, angle.lo, up),
    };
    const reach = reals.mul(intervals.abs(bend.curvature).hi, upper, up);
    const farthest = reals.add(widest, intervals.abs(angle).hi, up);
    if (!reals.isBelow(reach, stretch.lo) || !reals.isBelow(farthest, this.threeQuarters)) return ends;
    const seen = this.arcsineUp(reals.div(reach, stretch.lo, up));
    return { lo: reals.greatest(ends.lo, reals.negative(seen)), hi: reals.least(ends.hi, seen) };
  }

  // Of a number in [0, 1], by the arctangent.
  arcsineUp(sine) {
    const { reals } = this;
    const square = reals.sub(reals.one, reals.mul(sine, sine, up), down);
    if (!reals.isBelow(reals.zero, square)) return this.quarter.hi;
    return reals.arctangent(reals.div(sine, reals.sqrt(square, down), up)).hi;
  }

  // The largest turn d of D's sign, which has the largest phi(d) sin D; those of the other sign make it negative.
  largestTurn(apart, range) {
    const { reals } = this;
    let turn = reals.zero;
    if (reals.isBelow(reals.zero, apart.hi)) turn = reals.greatest(turn, reals.sub(range.hi, apart.lo, up));
    if (reals.isBelow(apart.lo, reals.zero)) turn = reals.greatest(turn, reals.sub(apart.hi, range.lo, up));
    return turn;
  }

  // phi(d) = (d - sin d)/(1 - cos d), which rises; d >= 0. null beyond its pole, a full turn.
  phiUp(turn) {
    const { reals } = this;
    if (!reals.isBelow(turn, this.fullTurn)) return null;
    if (reals.isBelow(turn, reals.exact(smallTurn))) {
      // d - sin d <= d^3/6, 1 - cos d >= d^2/2 - d^4/24
      const fall = reals.sub(reals.one, reals.div(reals.mul(turn, turn, up), reals.exact(12), up), down);
      return reals.div(turn, reals.mul(reals.exact(3), fall, down), up);
    }
    const versine = reals.sub(reals.one, reals.cosine(turn).hi, down);
    if (!reals.isBelow(reals.zero, versine)) return null;
    return reals.div(reals.sub(turn, reals.sine(turn).lo, up), versine, up);
  }

  // Of D + d/2, the middle of x's turn and a point's from the query.
  largestSquaredSine(apart, range) {
    const { intervals, reals } = this;
    const twice = intervals.abs(intervals.add(apart, range)).hi;
    const angle = reals.div(twice, reals.two, up);
    if (!reals.isBelow(angle, this.quarter.lo)) return reals.one;
    const sine = reals.sine(angle).hi;
    return reals.mul(sine, sine, up);
  }
}
