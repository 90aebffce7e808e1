// Real numbers of 128 bits whose operations round to a given side: MPFR, compiled to WebAssembly. A number is the
// address of an mpfr_t in the memory of the module; those made since a mark are given back together.
import { init } from "gmp-wasm";

export const down = 3; // MPFR_RNDD
export const up = 2; // MPFR_RNDU
export const precision = 128;

export async function loadRealNumbers() {
  return new RealNumbers((await init()).binding);
}

export class RealNumbers {
  constructor(mpfr) {
    this.mpfr = mpfr;
    this.all = [];
    this.used = 0;
    this.zero = this.exact(0);
    this.one = this.exact(1);
    this.two = this.exact(2);
    this.infinity = this.exact(Infinity);
    this.minusInfinity = this.exact(-Infinity);
  }

  // What is made between `mark` and `release` lives until the latter.
  mark() {
    return this.used;
  }
  release(mark) {
    this.used = mark;
  }

  fresh() {
    if (this.used === this.all.length) {
      const number = this.mpfr.mpfr_t();
      this.mpfr.mpfr_init2(number, precision);
      this.all.push(number);
    }
    return this.all[this.used++];
  }

  // MPFR remembers that an operation had no result (infinity minus infinity): nothing may then be concluded, because a
  // NaN passes some comparisons.
  forgetFailures() {
    this.mpfr.mpfr_clear_flags();
  }
  failed() {
    return this.mpfr.mpfr_nanflag_p() !== 0;
  }

  // A binary64 number has 53 bits.
  exact(x) {
    const result = this.fresh();
    this.mpfr.mpfr_set_d(result, x, down);
    return result;
  }

  add(a, b, side) {
    const result = this.fresh();
    this.mpfr.mpfr_add(result, a, b, side);
    return result;
  }
  sub(a, b, side) {
    const result = this.fresh();
    this.mpfr.mpfr_sub(result, a, b, side);
    return result;
  }
  mul(a, b, side) {
    const result = this.fresh();
    this.mpfr.mpfr_mul(result, a, b, side);
    return result;
  }
  div(a, b, side) {
    const result = this.fresh();
    this.mpfr.mpfr_div(result, a, b, side);
    return result;
  }
  sqrt(a, side) {
    const result = this.fresh();
    this.mpfr.mpfr_sqrt(result, a, side);
    return result;
  }
  pow(base, exponent, side) {
    const result = this.fresh();
    this.mpfr.mpfr_pow(result, base, exponent, side);
    return result;
  }

  // Between two neighbours, of functions that MPFR rounds correctly.
  sine(a) {
    return this.between(this.mpfr.mpfr_sin, a);
  }
  cosine(a) {
    return this.between(this.mpfr.mpfr_cos, a);
  }
  arctangent(a) {
    return this.between(this.mpfr.mpfr_atan, a);
  }
  halfTurn() {
    return this.between(this.mpfr.mpfr_const_pi);
  }
  between(operation, ...operands) {
    const lo = this.fresh();
    if (operation(lo, ...operands, down) === 0) return { lo, hi: lo };
    const hi = this.fresh();
    this.mpfr.mpfr_set(hi, lo, down);
    this.mpfr.mpfr_nextabove(hi);
    return { lo, hi };
  }

  // Exact.
  negative(a) {
    const result = this.fresh();
    this.mpfr.mpfr_neg(result, a, down);
    return result;
  }

  isAtMost(a, b) {
    return this.mpfr.mpfr_lessequal_p(a, b) !== 0;
  }
  isBelow(a, b) {
    return this.mpfr.mpfr_less_p(a, b) !== 0;
  }
  least(a, b) {
    return this.isAtMost(a, b) ? a : b;
  }
  greatest(a, b) {
    return this.isAtMost(a, b) ? b : a;
  }
  toNumber(a, side) {
    return this.mpfr.mpfr_get_d(a, side);
  }
}
