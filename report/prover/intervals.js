// Intervals of real numbers, rounded outward, and vectors of three of them.
import { down, up } from "./real_numbers.js";

export class Intervals {
  constructor(reals) {
    this.reals = reals;
  }

  exact(x) {
    const number = this.reals.exact(x);
    return { lo: number, hi: number };
  }

  add(a, b) {
    return { lo: this.reals.add(a.lo, b.lo, down), hi: this.reals.add(a.hi, b.hi, up) };
  }
  sub(a, b) {
    return { lo: this.reals.sub(a.lo, b.hi, down), hi: this.reals.sub(a.hi, b.lo, up) };
  }
  // By signs, which tell the two products that are needed.
  mul(a, b) {
    const { reals } = this;
    const product = (low, high) => ({ lo: reals.mul(low[0], low[1], down), hi: reals.mul(high[0], high[1], up) });
    if (this.isPositive(a)) {
      if (this.isPositive(b)) return product([a.lo, b.lo], [a.hi, b.hi]);
      if (this.isNegative(b)) return product([a.hi, b.lo], [a.lo, b.hi]);
      return product([a.hi, b.lo], [a.hi, b.hi]);
    }
    if (this.isNegative(a)) return this.negative(this.mul(this.negative(a), b));
    if (this.isPositive(b) || this.isNegative(b)) return this.mul(b, a);
    return {
      lo: reals.least(reals.mul(a.lo, b.hi, down), reals.mul(a.hi, b.lo, down)),
      hi: reals.greatest(reals.mul(a.lo, b.lo, up), reals.mul(a.hi, b.hi, up)),
    };
  }
  // 0 is both; what is not a number is neither.
  isPositive(a) {
    return this.reals.isAtMost(this.reals.zero, a.lo);
  }
  isNegative(a) {
    return this.reals.isAtMost(a.hi, this.reals.zero);
  }
  // Of a divisor that is proven to be positive.
  div(a, b) {
    const { reals } = this;
    if (!reals.isBelow(reals.zero, b.lo)) throw new Error("a divisor is not proven to be positive");
    return {
      lo: reals.least(reals.div(a.lo, b.lo, down), reals.div(a.lo, b.hi, down)),
      hi: reals.greatest(reals.div(a.hi, b.lo, up), reals.div(a.hi, b.hi, up)),
    };
  }
  abs(a) {
    const { reals } = this;
    if (this.isPositive(a)) return a;
    if (this.isNegative(a)) return this.negative(a);
    return { lo: reals.zero, hi: reals.greatest(reals.negative(a.lo), a.hi) };
  }
  square(a) {
    const { reals } = this;
    const { lo, hi } = this.abs(a);
    return { lo: reals.mul(lo, lo, down), hi: reals.mul(hi, hi, up) };
  }

  negative(a) {
    return { lo: this.reals.negative(a.hi), hi: this.reals.negative(a.lo) };
  }
  // A number of a, about in its middle.
  middle(a) {
    const { reals } = this;
    if (a.lo === a.hi) return a.lo;
    const half = reals.div(reals.add(a.lo, a.hi, down), reals.two, down);
    return reals.least(reals.greatest(half, a.lo), a.hi);
  }
  hull(a, b) {
    return { lo: this.reals.least(a.lo, b.lo), hi: this.reals.greatest(a.hi, b.hi) };
  }

  sum(terms) {
    return terms.reduce((sum, term) => this.add(sum, term));
  }
  dot(u, v) {
    return this.sum([0, 1, 2].map((k) => this.mul(u[k], v[k])));
  }
  // Of a matrix by its rows.
  product(rows, v) {
    return rows.map((row) => this.dot(row, v));
  }
  difference(u, v) {
    return [0, 1, 2].map((k) => this.sub(u[k], v[k]));
  }
  // About the origin, of these half edges.
  box(half) {
    return half.map((edge) => ({ lo: this.reals.negative(edge), hi: edge }));
  }
  translated(u, v) {
    return [0, 1, 2].map((k) => this.add(u[k], v[k]));
  }
  // Of two boxes with a common point.
  common(u, v) {
    const { reals } = this;
    return u.map(({ lo, hi }, k) => ({ lo: reals.greatest(lo, v[k].lo), hi: reals.least(hi, v[k].hi) }));
  }
  length(v) {
    const squared = this.sum(v.map((component) => this.square(component)));
    return { lo: this.reals.sqrt(squared.lo, down), hi: this.reals.sqrt(squared.hi, up) };
  }
}
