// Sine, cosine and arctangent of intervals, and their quotients by the angle, which have no pole at 0.
import { down, up } from "./real_numbers.js";

const tiny = 2 ** -60; // below, the quotients' series are tighter than the quotients of rounded numbers

export class Trigonometry {
  // Lives as long as `intervals.reals`.
  constructor(intervals) {
    Object.assign(this, { intervals, reals: intervals.reals });
    this.halfTurn = this.reals.halfTurn();
    this.tiny = this.reals.exact(tiny);
  }

  sine(a) {
    return this.wave((x) => this.reals.sine(x), a);
  }
  cosine(a) {
    return this.wave((x) => this.reals.cosine(x), a);
  }
  // Of a function with values and slopes in [-1, 1]: from its value at the middle it goes no farther than the angle.
  wave(at, a) {
    const { reals, intervals } = this;
    if (a.lo === a.hi) return at(a.lo);
    const middle = intervals.middle(a);
    const way = reals.greatest(reals.sub(a.hi, middle, up), reals.sub(middle, a.lo, up));
    const value = at(middle);
    return {
      lo: reals.greatest(reals.negative(reals.one), reals.sub(value.lo, way, down)),
      hi: reals.least(reals.one, reals.add(value.hi, way, up)),
    };
  }

  // Rises.
  arctangent(a) {
    return { lo: this.reals.arctangent(a.lo).lo, hi: this.reals.arctangent(a.hi).hi };
  }

  // sin(a)/a: even, and it falls with |a| as far as half a turn.
  quotientOfSine(a) {
    const { reals } = this;
    const size = this.intervals.abs(a);
    if (!reals.isAtMost(size.hi, this.halfTurn.lo)) return { lo: reals.negative(reals.one), hi: reals.one };
    return this.fallingQuotient((x) => reals.sine(x), size, 6);
  }
  // atan(a)/a: even, and it falls with |a|.
  quotientOfArctangent(a) {
    return this.fallingQuotient((x) => this.reals.arctangent(x), this.intervals.abs(a), 3);
  }

  // f(a)/a of an f with a - a^3/divisor <= f(a) <= a, which falls over `size`, a >= 0.
  fallingQuotient(f, size, divisor) {
    const at = (a, side) => this.quotientAt(f, a, divisor, side);
    return { lo: at(size.hi, down), hi: at(size.lo, up) };
  }
  quotientAt(f, a, divisor, side) {
    const { reals } = this;
    if (reals.isBelow(this.tiny, a)) return reals.div(side === up ? f(a).hi : f(a).lo, a, side);
    if (side === up) return reals.one;
    return reals.sub(reals.one, reals.div(reals.mul(a, a, up), reals.exact(divisor), up), down);
  }

  // Cosine and sine of an angle in degrees, a binary64 number. The remainder by a right angle is exact.
  ofDegrees(degrees) {
    const { reals, intervals } = this;
    const remainder = degrees % 90;
    const quarters = ((Math.round((degrees % 360) / 90 - remainder / 90) % 4) + 4) % 4;
    const share = intervals.div(intervals.exact(remainder), intervals.exact(180));
    const angle = remainder === 0 ? intervals.exact(0) : intervals.mul(share, this.halfTurn);
    const [c, s] = [this.cosine(angle), this.sine(angle)];
    const minus = (a) => intervals.negative(a);
    return [
      [c, s],
      [minus(s), c],
      [minus(c), minus(s)],
      [s, minus(c)],
    ][quarters];
  }
}
