// Half-spaces {n.e <= b} about a cell's centre that contain what of a primitive, or of the closure of its complement,
// lies in the cell, and whether what lies in all of them is far from the query (docs/mathematics.md, section 28).
import { multipliers } from "./multipliers.js";
import { down, up } from "./real_numbers.js";

const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((n) => [0, 1, 2].map((k) => ((n >> k) & 1 ? 1 : -1)));

export class HalfSpaces {
  // `near`, a point or null, lies beside the nearest of the set.
  constructor(intervals, primitives, squaredRadius, near) {
    Object.assign(this, { intervals, reals: intervals.reals, primitives, squaredRadius });
    this.touching = primitives.map((solid) => {
      const region = near && solid.over(near, [this.reals.zero, this.reals.zero, this.reals.zero]);
      return region?.at ? this.proposedGradient(solid, region.at) : null;
    });
  }

  facesOf({ half }) {
    const { reals } = this;
    return half.flatMap((edge, axis) =>
      [1, -1].map((sign) => ({
        normal: [0, 1, 2].map((k) => (k === axis ? reals.exact(sign) : reals.zero)),
        offset: edge,
      })),
    );
  }

  // About the gauge's gradient: any vector is as right.
  proposedGradient({ bounds }, at) {
    const gradient = bounds.approximateGaugeGradient(at.map(({ lo }) => this.reals.toNumber(lo, down)));
    const isUsable = gradient.every(Number.isFinite) && gradient.some((component) => component !== 0);
    return isUsable ? gradient.map((component) => this.intervals.exact(component)) : null;
  }

  // From n.e <= offset for an n of `range`, which differs from the exact one by as much as the cell is wide.
  cut(range, offset, half) {
    const { intervals, reals } = this;
    const normal = range.map((component) => intervals.middle(component));
    const more = normal.map((n, k) => {
      const rest = intervals.abs(intervals.sub(range[k], { lo: n, hi: n })).hi;
      return reals.mul(rest, half[k], up);
    });
    return { normal, offset: more.reduce((a, b) => reals.add(a, b, up), offset) };
  }

  // D^T w, for the interval matrix D of the derivatives.
  pulledBack(derivative, w) {
    return [0, 1, 2].map((k) =>
      this.intervals.dot(
        derivative.map((row) => row[k]),
        w,
      ),
    );
  }

  // The primitive lies in {w.y <= h(w)}.
  inside(primitive, { at, derivative }, { half }) {
    const { reals, intervals } = this;
    const solid = this.primitives[primitive];
    return [this.proposedGradient(solid, at), this.touching[primitive]].filter(Boolean).map((w) => {
      const offset = reals.sub(solid.bounds.supportUp(w), intervals.dot(w, at).lo, up);
      return this.cut(this.pulledBack(derivative, w), offset, half);
    });
  }

  // Where g(y) >= 1, w.(y - y0) is no less than minus the largest g - 1 - w.(y - y0), which is convex, at the corners.
  outside(primitive, { at, derivative }, { half }) {
    const { reals, intervals } = this;
    const { bounds } = this.primitives[primitive];
    const w = this.proposedGradient(this.primitives[primitive], at);
    if (w === null) return [];
    const excess = corners.map((signs) => {
      const corner = signs.map((sign, k) => {
        const coordinate = sign > 0 ? half[k] : reals.negative(half[k]);
        return { lo: coordinate, hi: coordinate };
      });
      const step = intervals.product(derivative, corner);
      const gauge = bounds.gaugeOver(step.map((component, k) => intervals.add(at[k], component)));
      return reals.sub(reals.sub(gauge, reals.one, up), intervals.dot(w, step).lo, up);
    });
    const range = this.pulledBack(derivative, w).map((component) => intervals.negative(component));
    return [
      this.cut(
        range,
        excess.reduce((a, b) => reals.greatest(a, b)),
        half,
      ),
    ];
  }

  // No point of the cell is in the cut.
  isMissed({ normal, offset }, half) {
    const { reals } = this;
    const reach = normal.map((n, k) => {
      const size = reals.greatest(n, reals.negative(n));
      return reals.mul(size, half[k], up);
    });
    return reals.isBelow(
      reach.reduce((a, b) => reals.add(a, b, up), offset),
      reals.zero,
    );
  }

  // Whether all that lies in the cuts is at least the radius away from the query, the cell's `offset` back from its
  // centre. For any multipliers m >= 0, with N the sum of m n, no e in all cuts has a smaller squared distance than
  //   -2 N.offset - |N|^2 - 2 sum of m b.
  areFar(cuts, { offset, half }) {
    const { reals, intervals } = this;
    if (cuts.some((cut) => this.isMissed(cut, half))) return true;
    const number = (x) => reals.toNumber(x, down);
    const weights = multipliers(
      cuts.map(({ normal, offset: b }) => ({ normal: normal.map(number), offset: reals.toNumber(b, up) })),
      offset.map((coordinate) => -number(coordinate)),
      reals.toNumber(this.squaredRadius, up),
    );
    if (weights === null) return false;
    let sum = [0, 0, 0].map(() => intervals.exact(0));
    let rest = intervals.exact(0);
    for (const { cut, weight } of weights) {
      const { normal, offset: b } = cuts[cut];
      const m = intervals.exact(weight);
      sum = sum.map((component, k) => intervals.add(component, intervals.mul(m, { lo: normal[k], hi: normal[k] })));
      rest = intervals.add(rest, intervals.mul(m, { lo: b, hi: b }));
    }
    const back = intervals.dot(
      sum,
      offset.map((coordinate) => ({ lo: coordinate, hi: coordinate })),
    );
    const squared = intervals.sum(sum.map((component) => intervals.square(component)));
    const linear = intervals.add(back, rest);
    const loss = reals.add(reals.add(linear.hi, linear.hi, up), squared.hi, up);
    return reals.isAtMost(this.squaredRadius, reals.negative(loss));
  }
}
