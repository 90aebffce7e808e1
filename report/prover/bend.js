// The bend of a primitive, its inverse and their derivatives (docs/mathematics.md, section 9), about the primitive's
// centre. Places are [r, s, z] before and [R, S, Z] after it: along the bend, across it, along the axis.
import { Trigonometry } from "./trigonometry.js";

export class Bend {
  // Lives as long as `intervals.reals`.
  constructor(intervals, { curvature, angleDegrees }) {
    this.intervals = intervals;
    this.reals = intervals.reals;
    this.trigonometry = new Trigonometry(intervals);
    this.one = intervals.exact(1);
    this.curvature = intervals.exact(curvature);
    [this.cosine, this.sine] = this.trigonometry.ofDegrees(angleDegrees);
  }

  // Of a vector of the primitive's frame, its parts along the bend, across it, and along the axis.
  turned([x, y, z]) {
    const { intervals, cosine, sine } = this;
    return [
      intervals.add(intervals.mul(x, cosine), intervals.mul(y, sine)),
      intervals.sub(intervals.mul(y, cosine), intervals.mul(x, sine)),
      z,
    ];
  }
  turnedBack([r, s, z]) {
    const { intervals, cosine, sine } = this;
    return [
      intervals.sub(intervals.mul(r, cosine), intervals.mul(s, sine)),
      intervals.add(intervals.mul(r, sine), intervals.mul(s, cosine)),
      z,
    ];
  }

  // W = 1 - k r, and gamma = k z; of a place that is bent already, 1 - k R and k Z.
  stretch([r]) {
    return this.intervals.sub(this.one, this.intervals.mul(this.curvature, r));
  }
  angle([, , z]) {
    return this.intervals.mul(this.curvature, z);
  }

  // R = r cos gamma + z sin(gamma/2) sin(gamma/2)/(gamma/2), Z = W z sin(gamma)/gamma. By half the angle h: cos gamma =
  // 1 - 2 sin^2 h, and sin(gamma)/gamma = cos h sin(h)/h.
  bent(place) {
    const { intervals, trigonometry } = this;
    const [r, s, z] = place;
    const half = intervals.div(this.angle(place), intervals.exact(2));
    const [sine, cosine] = [trigonometry.sine(half), trigonometry.cosine(half)];
    const quotient = trigonometry.quotientOfSine(half);
    const squared = intervals.square(sine);
    const turn = intervals.sub(this.one, intervals.add(squared, squared));
    const rise = intervals.mul(z, quotient);
    return [
      intervals.add(intervals.mul(r, turn), intervals.mul(rise, sine)),
      s,
      intervals.mul(intervals.mul(this.stretch(place), rise), cosine),
    ];
  }

  // null where the place may lie in the half plane m <= 0, Z = 0, across which z jumps.
  unbent(place) {
    const { intervals, reals } = this;
    const [along, across, height] = place;
    const [m, rise] = [this.stretch(place), this.angle(place)];
    const stretch = intervals.length([m, rise]);
    const sum = intervals.add(stretch, m);
    if (!reals.isBelow(reals.zero, sum.lo)) return null;
    const twice = (a) => intervals.add(a, a);
    const squares = intervals.add(intervals.square(along), intervals.square(height));
    const numerator = intervals.sub(twice(along), intervals.mul(this.curvature, squares));
    const quotient = this.trigonometry.quotientOfArctangent(intervals.div(rise, sum));
    return [
      intervals.div(numerator, intervals.add(this.one, stretch)),
      across,
      intervals.mul(intervals.div(twice(height), sum), quotient),
    ];
  }

  // The transposed derivative of the bend at a place, times v.
  pulledBack([along, across, height], place) {
    const { intervals } = this;
    const [cosine, sine] = this.direction(place);
    return [
      intervals.sub(intervals.mul(cosine, along), intervals.mul(sine, height)),
      across,
      intervals.mul(this.stretch(place), intervals.add(intervals.mul(sine, along), intervals.mul(cosine, height))),
    ];
  }

  // The rows of the inverse's derivative where it has the values of a box; null where 1 - k r may be 0.
  unbending(place) {
    const { intervals, reals } = this;
    const stretch = this.stretch(place);
    if (!reals.isBelow(reals.zero, stretch.lo)) return null;
    const [cosine, sine] = this.direction(place);
    const zero = intervals.exact(0);
    return [
      [cosine, zero, intervals.negative(sine)],
      [zero, this.one, zero],
      [intervals.div(sine, stretch), zero, intervals.div(cosine, stretch)],
    ];
  }

  direction(place) {
    const angle = this.angle(place);
    return [this.trigonometry.cosine(angle), this.trigonometry.sine(angle)];
  }
}
