// Whether a ball lies in a bent superquadric: where it is more curved than the boundary at the point of its sphere that
// comes nearest to that (docs/mathematics.md, section 9, "Points inside", whose letters these are). Half the squared
// gauge stays at most 1/2 on all ways from that point, by Taylor's theorem.
import { HalfSquareCurvature } from "./half_square_curvature.js";
import { down, up } from "./real_numbers.js";

const pieces = 8; // of the ways, for the integral of the second derivative
const mostTurn = 3; // less than half a turn

export class BentBall {
  // About the query, unbent, in the bent solid; `place` is, unbent, the point of its sphere that lies `apart` from it.
  constructor({ intervals, reals, bend, bounds }, query, { apart, place }) {
    Object.assign(this, { intervals, reals, bend, bounds, query, apart, place });
    this.one = intervals.exact(1);
    this.two = intervals.exact(2);
    this.curvature = intervals.abs(bend.curvature);
    this.radius = intervals.length(apart);
  }

  isContained() {
    const { intervals, reals, bounds } = this;
    if (bounds.isTapered || bounds.exponents.some((eps) => eps > 1)) return false;
    if (!this.measureTurn() || !this.measureStretch()) return false;
    this.curvatures = new HalfSquareCurvature(bounds, this.squaredStretch);
    const gradient = this.curvatures.gradient(this.centred(this.place));
    const normal = this.bend.turnedBack(this.bend.pulledBack(this.apart, this.place));
    const kappa = intervals.exact(this.proposedFactor(gradient, normal));
    const eta = intervals.difference(
      gradient,
      normal.map((component) => intervals.mul(kappa, component)),
    );
    const tau = intervals.div(intervals.mul(this.curvature, this.radius), this.stretch);
    const rest = intervals.mul(kappa, intervals.sub(this.one, tau)).lo;
    const excess = reals.sub(rest, this.largestCurvature(), down);
    if (!reals.isBelow(reals.zero, excess)) return false;
    const gauge = bounds.norm(this.centred(this.place), up);
    const lift = reals.div(this.squaredDual(eta).hi, excess, up);
    return reals.isAtMost(reals.add(reals.mul(gauge, gauge, up), lift, up), reals.one);
  }

  centred(place) {
    return this.bend.turnedBack(place);
  }

  // theta, seen from the centre of curvature: the sine is at most |k| radius / Wq. Whether theta is proven to be at most
  // an eighth of a turn, with the place less than half a turn from the query; gives theta^2 <= tan^2 theta.
  measureTurn() {
    const { intervals, reals, bend } = this;
    const stretch = bend.stretch(this.query);
    if (!reals.isBelow(reals.zero, stretch.lo) || !reals.isBelow(reals.zero, bend.stretch(this.place).lo)) return false;
    const sine = intervals.div(intervals.mul(this.curvature, this.radius), stretch).hi;
    const squared = reals.sub(reals.one, reals.mul(sine, sine, up), down);
    if (!reals.isBelow(reals.zero, squared)) return false;
    const tangent = reals.div(sine, reals.sqrt(squared, down), up);
    this.squaredTurn = reals.mul(tangent, tangent, up);
    // Along the axis the ball reaches theta / |k| far.
    this.reachAlong = reals.div(tangent, this.curvature.lo, up);
    const apart = intervals.abs(intervals.sub(bend.angle(this.place), bend.angle(this.query))).hi;
    return reals.isAtMost(this.squaredTurn, reals.one) && reals.isBelow(apart, reals.exact(mostTurn));
  }

  // a^2 = Wc Wq ((1 - theta^2/3) (1 - theta^2/2) - 2 theta^2/3); any smaller number is as right.
  measureStretch() {
    const { intervals, reals, bend } = this;
    const turn = { lo: this.squaredTurn, hi: this.squaredTurn };
    const share = (parts) => intervals.div(turn, intervals.exact(parts));
    const [third, half] = [share(3), share(2)];
    const left = intervals.mul(intervals.sub(this.one, third), intervals.sub(this.one, half));
    const flattened = intervals.sub(left, intervals.add(third, third));
    const stretches = intervals.mul(bend.stretch(this.place), bend.stretch(this.query));
    const squared = intervals.mul(stretches, flattened).lo;
    if (!reals.isBelow(reals.zero, squared)) return false;
    const root = reals.sqrt(squared, down);
    this.squaredStretch = reals.mul(root, root, down);
    this.stretch = { lo: root, hi: root };
    return true;
  }

  // Of a gradient, in the dual of the norm |e|^2 = e_r^2 + e_s^2 + a^2 e_z^2.
  squaredDual(v) {
    const { intervals } = this;
    const z = intervals.div(v[2], this.stretch);
    return intervals.sum([v[0], v[1], z].map((component) => intervals.square(component)));
  }

  // The multiple of the normal that is nearest to the gradient, about; any number that is not negative is as right.
  proposedFactor(gradient, normal) {
    const number = ({ lo }) => this.reals.toNumber(lo, down);
    const [g, n, a] = [gradient.map(number), normal.map(number), number(this.stretch)];
    const dual = (u, v) => u[0] * v[0] + u[1] * v[1] + (u[2] * v[2]) / (a * a);
    const factor = dual(n, g) / dual(n, n);
    return Number.isFinite(factor) ? Math.max(factor, 0) : 0;
  }

  // L: from the place to every point within the ball's reach of the query, (1 - s) integrated over each piece.
  largestCurvature() {
    const { intervals, reals } = this;
    const reach = [this.radius.hi, this.radius.hi, this.reachAlong];
    const from = this.centred(this.place);
    const ends = this.centred(this.query).map((coordinate, k) => ({
      lo: reals.sub(coordinate.lo, reach[k], down),
      hi: reals.add(coordinate.hi, reach[k], up),
    }));
    const at = (k, share) => {
      const rest = intervals.exact(1 - share);
      return intervals.add(intervals.mul(rest, from[k]), intervals.mul(intervals.exact(share), ends[k]));
    };
    let sum = reals.zero;
    for (let piece = 0; piece < pieces; ++piece) {
      const [begin, end] = [piece / pieces, (piece + 1) / pieces]; // exact, and so are their squares
      const box = [0, 1, 2].map((k) => intervals.hull(at(k, begin), at(k, end)));
      const weight = reals.exact((1 - begin) ** 2 - (1 - end) ** 2);
      sum = reals.add(sum, reals.mul(weight, this.curvatures.largestOver(box), up), up);
    }
    return sum;
  }
}
