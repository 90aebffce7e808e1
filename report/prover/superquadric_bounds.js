// Gauge and support function of a superquadric, tapered or not, one side at a time (docs/mathematics.md, sections 1, 4
// and 18). Points are given about the focus, which is the centre where there is no taper.
import { down, up } from "./real_numbers.js";
import { inside, open, outside } from "./set_tree.js";

// The norm (s^p + t^p)^(1/p) of two numbers, for p = 2/eps, or for the conjugate exponent q = 2/(2 - eps).
class PlaneNorm {
  constructor(reals, eps, conjugate) {
    this.reals = reals;
    if (eps === 1) this.kind = "euclidean";
    else if (eps === 2) this.kind = conjugate ? "maximum" : "sum";
    else this.kind = "power";
    this.approximateExponent = conjugate ? 2 / (2 - eps) : 2 / eps; // to nearest
    if (this.kind !== "power") return;
    const exact = reals.exact(eps);
    const divisor = (side) => (conjugate ? reals.sub(reals.two, exact, side) : exact);
    this.exponent = { lo: reals.div(reals.two, divisor(up), down), hi: reals.div(reals.two, divisor(down), up) };
    this.root = { lo: reals.div(divisor(down), reals.two, down), hi: reals.div(divisor(up), reals.two, up) };
  }

  // A bound on the side `side`; s, t >= 0. The larger number is factored out: powers then have a base in [0, 1], which
  // falls with the exponent, and roots one in [1, 2], which rises with it.
  of(s, t, side) {
    const { reals, kind } = this;
    const [small, large] = reals.isAtMost(s, t) ? [s, t] : [t, s];
    if (reals.isAtMost(small, reals.zero) || kind === "maximum") return large;
    if (kind === "sum") return reals.add(s, t, side);
    const ratio = reals.div(small, large, side);
    if (kind === "euclidean") {
      return reals.mul(large, reals.sqrt(reals.add(reals.one, reals.mul(ratio, ratio, side), side), side), side);
    }
    const [exponent, root] = side === up ? [this.exponent.lo, this.root.hi] : [this.exponent.hi, this.root.lo];
    const sum = reals.add(reals.one, reals.pow(ratio, exponent, side), side);
    return reals.mul(large, reals.pow(sum, root, side), side);
  }

  // The same in binary64: nothing is proven.
  approximate(s, t) {
    const [small, large] = s <= t ? [s, t] : [t, s];
    if (small <= 0 || this.kind === "maximum") return large;
    if (this.kind === "sum") return s + t;
    if (this.kind === "euclidean") return Math.hypot(s, t);
    return large * (1 + (small / large) ** this.approximateExponent) ** (1 / this.approximateExponent);
  }

  // Its gradient where s, t >= 0 are not both 0, alike.
  approximateGradient(s, t) {
    const norm = this.approximate(s, t);
    return [s, t].map((part) => (part / norm) ** (this.approximateExponent - 1));
  }
}

const mostSteps = 8; // of Newton's method at 128 bits

export class SuperquadricBounds {
  // Lives as long as `intervals.reals`.
  constructor(intervals, { semiAxes, exponents, taper }) {
    const { reals } = intervals;
    Object.assign(this, { intervals, reals, semiAxes, exponents, taper });
    this.axes = semiAxes.map((a) => intervals.exact(a));
    const [alongZ, inSection] = exponents;
    this.section = new PlaneNorm(reals, inSection, false);
    this.whole = new PlaneNorm(reals, alongZ, false);
    this.dualSection = new PlaneNorm(reals, inSection, true);
    this.dualWhole = new PlaneNorm(reals, alongZ, true);
    const one = intervals.exact(1);
    const t = intervals.exact(taper);
    this.isTapered = taper !== 1;
    this.k = intervals.div(intervals.sub(t, one), intervals.add(t, one));
    this.fall = intervals.sub(one, intervals.square(this.k)); // 1 - k^2
    this.steepest = reals.add(reals.one, intervals.abs(this.k).hi, up); // 1 + |k|
    this.focus = intervals.mul(this.k, this.axes[2]); // the centre lies at this height about the focus
    this.approximateK = (taper - 1) / (taper + 1);
    this.radius = this.circumradius();
  }

  // About the focus, of the box that holds the solid.
  circumradius() {
    const { intervals, reals } = this;
    const [zero, one] = [intervals.exact(0), intervals.exact(1)];
    const side = (v) => ({ lo: reals.zero, hi: this.supportUp(v) });
    const height = intervals.add(this.axes[2], intervals.abs(this.focus));
    return intervals.length([side([one, zero, zero]), side([zero, one, zero]), height]).hi;
  }

  // At least this far, by the sphere.
  distanceDown(w) {
    return this.reals.sub(this.intervals.length(w).lo, this.radius, down);
  }

  // N(w), of the solid without its taper.
  norm(w, side) {
    const { intervals, reals } = this;
    const [x, y, z] = w.map((component, k) => {
      const { lo, hi } = intervals.abs(component);
      return reals.div(side === up ? hi : lo, this.axes[k].lo, side);
    });
    return this.whole.of(this.section.of(x, y, side), z, side);
  }

  // N(w) - k w_z / a3: in the solid it is at most 1 - k^2.
  numerator(w, side) {
    const norm = this.norm(w, side);
    if (!this.isTapered) return norm;
    const { intervals, reals } = this;
    const tilt = intervals.div(intervals.mul(this.k, w[2]), this.axes[2]);
    return reals.sub(norm, side === up ? tilt.lo : tilt.hi, side);
  }

  // Every point of the box w lies in the solid.
  contains(w) {
    return this.reals.isAtMost(this.numerator(w, up), this.fall.lo);
  }

  // Where all points of a box lie, which may be wide, by the gauge; strict.
  place(w) {
    const { reals } = this;
    if (reals.isBelow(this.fall.hi, this.leastNumerator(w))) return outside;
    return reals.isBelow(this.largestNumerator(w), this.fall.lo) ? inside : open;
  }

  // Over any box, also a wide one: convex along z, and so largest at one of its ends there.
  largestNumerator([x, y, z]) {
    if (!this.isTapered) return this.norm([x, y, z], up);
    const at = (height) => this.numerator([x, y, { lo: height, hi: height }], up);
    return this.reals.greatest(at(z.lo), at(z.hi));
  }
  // No less than at the box's least |coordinates|, nor than any plane below the norm says: with (a, b) of the dual norm
  // D, N >= (a r + b z/a3)/D.
  leastNumerator(w) {
    const { intervals, reals } = this;
    const plainly = this.numerator(w, down);
    if (!this.isTapered || w[2].lo === w[2].hi) return plainly;
    const [x, y] = [0, 1].map((k) => reals.div(intervals.abs(w[k]).lo, this.axes[k].lo, down));
    const r = this.section.of(x, y, down);
    const height = intervals.div(w[2], this.axes[2]);
    const middle = (reals.toNumber(height.lo, down) + reals.toNumber(height.hi, up)) / 2;
    const slopes = this.whole.approximateGradient(reals.toNumber(r, down), Math.abs(middle));
    if (!slopes.every(Number.isFinite)) return plainly;
    const [a, b] = slopes.map((slope) => reals.exact(slope));
    const dual = this.dualWhole.of(a, b, up);
    if (!reals.isBelow(reals.zero, dual)) return plainly;
    // Of z/a3: the plane's slope less k; the plane is lowest at an end.
    const share = intervals.div({ lo: b, hi: b }, { lo: dual, hi: dual });
    const slope = intervals.sub(middle < 0 ? intervals.negative(share) : share, this.k);
    const ofSection = reals.mul(r, reals.div(a, dual, down), down);
    return reals.greatest(plainly, reals.add(ofSection, intervals.mul(slope, height).lo, down));
  }

  // An upper bound of the gauge over the box w, which has points other than the origin.
  gaugeUp(w) {
    const numerator = this.numerator(w, up);
    return this.isTapered ? this.reals.div(numerator, this.fall.lo, up) : numerator;
  }

  // The same over any box, also a wide one.
  gaugeOver(w) {
    return this.reals.div(this.largestNumerator(w), this.fall.lo, up);
  }

  // An upper bound of the support function over the box v.
  supportUp(v) {
    const { intervals, reals } = this;
    const [x, y] = [0, 1].map((k) => reals.mul(intervals.abs(v[k]).hi, this.axes[k].hi, up));
    const section = this.dualSection.of(x, y, up);
    const z = intervals.mul(v[2], this.axes[2]);
    if (!this.isTapered) return this.dualWhole.of(section, intervals.abs(z).hi, up);
    return this.taperedSupportUp(section, z);
  }

  // For any number tau, h <= (1 - k^2) tau + (1 + |k|) max(0, f(tau)), f(tau) = |(section, z + k tau)| - tau. Newton's
  // method looks for the root of f, which is convex and falls: in binary64, then one step at 128 bits, or a few where
  // the height nearly vanishes.
  taperedSupportUp(section, z) {
    const { intervals, reals } = this;
    let tau = reals.exact(this.approximateRoot(reals.toNumber(section, up), reals.toNumber(z.lo, down)));
    for (let step = 0; ; ++step) {
      const height = intervals.add(z, intervals.mul(this.k, { lo: tau, hi: tau }));
      const norm = this.dualWhole.of(section, intervals.abs(height).hi, up);
      const f = reals.sub(norm, tau, up);
      const isRoot = Math.abs(reals.toNumber(f, up)) <= 2 ** -90 * reals.toNumber(tau, up);
      if (isRoot || step === mostSteps) {
        const excess = reals.mul(this.steepest, reals.greatest(reals.zero, f), up);
        return reals.add(reals.mul(this.fall.hi, tau, up), excess, up);
      }
      const slope = this.slopeAt(reals.toNumber(height.hi, up), reals.toNumber(norm, up));
      tau = reals.greatest(reals.zero, reals.sub(tau, reals.div(f, reals.exact(slope), up), up));
    }
  }

  // About the root of f, from the left.
  approximateRoot(section, z) {
    let tau = 0;
    for (let step = 0; step < 60; ++step) {
      const height = z + this.approximateK * tau;
      const norm = this.dualWhole.approximate(section, Math.abs(height));
      const next = tau - (norm - tau) / this.slopeAt(height, norm);
      if (!(Math.abs(next - tau) > 2 ** -53 * next)) break;
      tau = next;
    }
    return Number.isFinite(tau) ? tau : Math.max(section, Math.abs(z));
  }

  // The slope of f, about: k times that of the norm, which is +-(|height| / norm)^(q - 1), minus 1.
  slopeAt(height, norm) {
    const share = norm > 0 ? Math.min(Math.abs(height) / norm, 1) : 0;
    return this.approximateK * Math.sign(height) * share ** (this.dualWhole.approximateExponent - 1) - 1;
  }

  // The gauge of one point in binary64: nothing is proven.
  approximateGauge([x, y, z]) {
    const [a1, a2, a3] = this.semiAxes;
    const norm = this.whole.approximate(this.section.approximate(Math.abs(x) / a1, Math.abs(y) / a2), Math.abs(z) / a3);
    const k = this.approximateK;
    return (norm - (k * z) / a3) / (1 - k * k);
  }

  // Its gradient, alike; not finite at the focus.
  approximateGaugeGradient([x, y, z]) {
    const [a1, a2, a3] = this.semiAxes;
    const [ux, uy, uz] = [Math.abs(x) / a1, Math.abs(y) / a2, Math.abs(z) / a3];
    const r = this.section.approximate(ux, uy);
    const [ofSection, ofHeight] = this.whole.approximateGradient(r, uz);
    const [ofX, ofY] = r > 0 ? this.section.approximateGradient(ux, uy) : [0, 0];
    const k = this.approximateK;
    return [
      (Math.sign(x) * ofSection * ofX) / a1,
      (Math.sign(y) * ofSection * ofY) / a2,
      (Math.sign(z) * ofHeight - k) / a3,
    ].map((component) => component / (1 - k * k));
  }
}
