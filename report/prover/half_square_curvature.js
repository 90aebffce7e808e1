// Gradient and second derivative of half the squared gauge of a superquadric without a taper, of exponents of at most 1
// (docs/mathematics.md, section 9, "Points inside", whose letters these are).
import { down, up } from "./real_numbers.js";

// (1 + t) of one term and (1 + 1/t) of the other bound a mixed one for any t > 0.
const proposedShares = [1 / 32, 1 / 8, 1 / 2, 1, 2, 8];

class Exponent {
  // p = 2/eps, which is at least 2.
  constructor(reals, eps) {
    this.reals = reals;
    const quotient = (side) => reals.div(reals.two, reals.exact(eps), side);
    this.p = { lo: quotient(down), hi: quotient(up) };
    this.excess = reals.sub(this.p.hi, reals.two, up); // p - 2, rounded up
    this.leastExcess = reals.greatest(reals.zero, reals.sub(this.p.lo, reals.two, down));
    this.largestMixture = this.mixtureUp();
  }

  // Of A^s (1 - A), s = 1 - 2/p, for A in [0, 1]: s^s / (1 + s)^(1 + s), which falls with s.
  mixtureUp() {
    const { reals } = this;
    const s = reals.greatest(reals.zero, reals.sub(reals.one, reals.div(reals.two, this.p.lo, up), down));
    const more = { lo: reals.add(reals.one, s, down), hi: reals.add(reals.one, s, up) };
    return reals.div(reals.pow(s, s, up), reals.pow(more.lo, more.lo, down), up);
  }

  // Upper bounds of a share^p and a share^(p - 2), share in [0, 1].
  power(share) {
    return this.reals.pow(share, this.p.lo, up);
  }
  reduced(share) {
    return this.reals.pow(share, this.leastExcess, up);
  }
  // share^(p - 2) other^p, of two shares whose p-th powers have the sum 1.
  mixed(reduced, other) {
    return this.reals.least(this.reals.mul(reduced, this.power(other), up), this.largestMixture);
  }
}

export class HalfSquareCurvature {
  // `squaredStretch` is the weight a^2 of e_z^2 in |e|^2.
  constructor(bounds, squaredStretch) {
    const { reals, intervals } = bounds;
    Object.assign(this, { bounds, reals, intervals });
    const [alongZ, inSection] = bounds.exponents;
    this.whole = new Exponent(reals, alongZ);
    this.section = new Exponent(reals, inSection);
    const weights = bounds.axes.map(({ lo }) => reals.mul(lo, lo, down));
    weights[2] = reals.mul(weights[2], squaredStretch, down);
    this.perAxis = weights.map((weight) => reals.div(reals.one, weight, up));
  }

  // Of the coordinates over the semi-axes, without signs.
  scaled(box) {
    const { reals, intervals, bounds } = this;
    return box.map((coordinate, k) => {
      const { lo, hi } = intervals.abs(coordinate);
      return { lo: reals.div(lo, bounds.axes[k].lo, down), hi: reals.div(hi, bounds.axes[k].lo, up) };
    });
  }
  normOf(norm, s, t) {
    return { lo: norm.of(s.lo, t.lo, down), hi: norm.of(s.hi, t.hi, up) };
  }

  // s/|(s, t)|, rounded up: it rises with s and falls with t.
  shareUp(norm, s, t) {
    const { reals } = this;
    const whole = norm.of(s.hi, t.lo, down);
    return reals.isBelow(reals.zero, whole) ? reals.least(reals.one, reals.div(s.hi, whole, up)) : reals.one;
  }
  share(norm, s, t) {
    const { reals } = this;
    const whole = norm.of(s.lo, t.hi, up);
    const lo = reals.isBelow(reals.zero, whole) ? reals.div(s.lo, whole, down) : reals.zero;
    return { lo, hi: this.shareUp(norm, s, t) };
  }

  // g (r/g)^(p1 - 1) (X/r)^(p2 - 1) / a1 and so on, with the signs of the coordinates.
  gradient(box) {
    const { intervals, bounds, whole, section } = this;
    const [x, y, z] = this.scaled(box);
    const r = this.normOf(bounds.section, x, y);
    const gauge = this.normOf(bounds.whole, r, z);
    const ofSection = intervals.mul(gauge, this.lessOne(whole, this.share(bounds.whole, r, z)));
    const sizes = [
      intervals.mul(ofSection, this.lessOne(section, this.share(bounds.section, x, y))),
      intervals.mul(ofSection, this.lessOne(section, this.share(bounds.section, y, x))),
      intervals.mul(gauge, this.lessOne(whole, this.share(bounds.whole, z, r))),
    ];
    return sizes.map((size, k) => this.withSign(box[k], intervals.div(size, bounds.axes[k])));
  }
  // share^(p - 1), which falls with p.
  lessOne({ p }, share) {
    const { reals } = this;
    const less = (side, exponent) => reals.sub(exponent, reals.one, side);
    return {
      lo: reals.pow(share.lo, less(up, p.hi), down),
      hi: reals.pow(share.hi, less(down, p.lo), up),
    };
  }
  withSign(coordinate, size) {
    const { reals, intervals } = this;
    if (reals.isAtMost(reals.zero, coordinate.lo)) return size;
    if (reals.isAtMost(coordinate.hi, reals.zero)) return intervals.negative(size);
    return { lo: reals.negative(size.hi), hi: size.hi };
  }

  // Upper bound of e'G''e for |e| = 1 at all points of a box. By the sum of multiples of
  //   (r/g)^(p1-2) (X/r)^(p2-2) (e_x/a1)^2,   y alike,   (Z/g)^(p1-2) (e_z/a3)^2,
  // which G'' is but for (p2 - 2) A B D (u - v)^2 and (p1 - 2) A C (m - w)^2, times g^2. Of these
  //   B D (u - v)^2 <= 2 D (B u^2) + 2 B (D v^2)                           and <= B u^2 + D v^2,
  //   A C (m - w)^2 <= (1 + t) C (A m^2) + (1 + 1/t) A (C w^2)             and <= A m^2 + C w^2,
  // where m^2 <= B u^2 + D v^2.
  largestOver(box) {
    const { reals, bounds, whole, section } = this;
    const [x, y, z] = this.scaled(box);
    const r = this.normOf(bounds.section, x, y);
    const inSection = this.terms(section, this.shareUp(bounds.section, x, y), this.shareUp(bounds.section, y, x));
    const inWhole = this.terms(whole, this.shareUp(bounds.whole, r, z), this.shareUp(bounds.whole, z, r));
    const ofSections = [this.splitSection(inSection), this.plainSection(inSection)];
    const plain = inSection.map(({ reduced }) => reduced);
    const bound = ofSections.flatMap((ofSection) =>
      this.ofWhole(inWhole).map(({ ofR, more, ofZ }) => {
        const across = ofSection.map((factor, k) =>
          reals.add(reals.mul(ofR, factor, up), reals.mul(more, plain[k], up), up),
        );
        return [...across, ofZ]
          .map((factor, k) => reals.mul(factor, this.perAxis[k], up))
          .reduce((a, b) => reals.greatest(a, b));
      }),
    );
    return bound.reduce((a, b) => reals.least(a, b));
  }

  // Of both shares s, s^(p - 2), and that times the other's p-th power.
  terms(exponent, first, second) {
    const of = (share, other) => {
      const reduced = exponent.reduced(share);
      return { reduced, mixed: exponent.mixed(reduced, other) };
    };
    return [of(first, second), of(second, first)];
  }

  splitSection(terms) {
    const { reals, section } = this;
    const twice = reals.mul(section.excess, reals.two, up);
    return terms.map(({ reduced, mixed }) => reals.add(reduced, reals.mul(twice, mixed, up), up));
  }
  plainSection(terms) {
    const { reals, section } = this;
    const factor = reals.add(reals.one, section.excess, up);
    return terms.map(({ reduced }) => reals.mul(factor, reduced, up));
  }

  // Factors of the section's terms, of these without what the section's exponent adds, and of z's.
  ofWhole([r, z]) {
    const { reals, whole } = this;
    const times = (factor, term) => reals.mul(reals.mul(whole.excess, factor, up), term, up);
    const plain = {
      ofR: r.reduced,
      more: times(reals.one, r.reduced),
      ofZ: reals.add(z.reduced, times(reals.one, z.reduced), up),
    };
    const split = proposedShares.map((t) => ({
      ofR: r.reduced,
      more: times(reals.exact(1 + t), r.mixed),
      ofZ: reals.add(z.reduced, times(reals.exact(1 + 1 / t), z.mixed), up),
    }));
    return [plain, ...split];
  }
}
