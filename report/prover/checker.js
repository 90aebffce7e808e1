// What a certificate proves of one point (docs/mathematics.md, sections 2, 12 and 28), and what that says of a claim.
import { Intervals } from "./intervals.js";
import { Neighbourhood } from "./neighbourhood.js";
import { PlacedBent } from "./placed_bent.js";
import { PlacedMesh } from "./placed_mesh.js";
import { PlacedSuperquadric } from "./placed_superquadric.js";
import { down, up } from "./real_numbers.js";
import { inside, normalForm, outside, placeOf } from "./set_tree.js";

const isFinite3 = (v) => v.every(Number.isFinite);
const isUsable = (vector) => isFinite3(vector) && vector.some((component) => component !== 0);

function placedIn(intervals, primitive) {
  if (primitive.mesh) return new PlacedMesh(intervals, primitive);
  return primitive.bend ? new PlacedBent(intervals, primitive) : new PlacedSuperquadric(intervals, primitive);
}

export class Checker {
  // A model as its reader gives it; lives as long as `reals`, which serve nobody else.
  constructor(reals, { primitives, set, isUnion }) {
    this.reals = reals;
    this.intervals = new Intervals(reals);
    reals.forgetFailures();
    this.primitives = primitives.map((primitive) => placedIn(this.intervals, primitive));
    if (reals.failed()) throw new Error("the model's numbers leave the range of the arithmetic");
    this.isUnion = isUnion;
    this.hasMesh = primitives.some(({ mesh }) => mesh); // its distances need no covers
    this.trees = { [outside]: normalForm(set), [inside]: normalForm(set, true) }; // what the place has nothing of
  }

  // { point, lo, hi, radius, normals: [{ primitive, vector }], escape, witness: points or null, cover: bits } gives
  // "proved", "refuted" or "unproved". The claim is of every point within `radius` of the given one, whose distances
  // differ by no more.
  verdict(row) {
    const { reals } = this;
    const { lo, hi } = row;
    if (Number.isNaN(lo) || Number.isNaN(hi) || !isFinite3(row.point)) return "unproved";
    if (lo > hi) return "refuted";
    const mark = reals.mark();
    reals.forgetFailures();
    const verdict = this.judged(row);
    const failed = reals.failed();
    reals.release(mark);
    return failed ? "unproved" : verdict;
  }

  judged({ point, lo, hi, radius, normals, escape, witness, cover }) {
    const { reals, intervals } = this;
    const wanted = {
      lo: reals.add(reals.exact(lo), reals.exact(radius), up),
      hi: reals.sub(reals.exact(hi), reals.exact(radius), down),
    };
    const exact = (v) => v.map((component) => intervals.exact(component));
    const x = exact(point);
    const query = {
      x,
      local: this.primitives.map((primitive) => primitive.local(x)),
      // A vector of no use still names a primitive that may hold the point.
      normals: normals
        .filter(({ primitive }) => primitive < this.primitives.length)
        .map(({ primitive, vector }) => ({ primitive, v: isUsable(vector) ? exact(vector) : null })),
      escape: escape && isFinite3(escape) ? exact(escape) : null,
      witness: witness && isFinite3(witness) ? exact(witness) : null,
      cover: radius === 0 && !this.hasMesh ? cover : [], // cells are exact where the ball's radius is a binary64 number
    };
    // Of the given point, rounded outward to binary64, as enclosures are.
    const lower = this.lower(query, wanted.lo);
    if (hi < reals.toNumber(lower, down)) return "refuted";
    const upper = this.upper(query, wanted.hi);
    if (reals.toNumber(upper, up) < lo) return "refuted";
    return reals.isAtMost(wanted.lo, lower) && reals.isAtMost(upper, wanted.hi) ? "proved" : "unproved";
  }

  // A lower end: by normals, else `claimed` by a cover, else by a point outside, than which no point lies deeper.
  lower(query, claimed) {
    const { reals } = this;
    const byNormals = this.lowerByNormals(query);
    const isPositive = reals.isBelow(reals.zero, byNormals);
    if (isPositive && (reals.isAtMost(claimed, byNormals) || query.cover.length === 0)) return byNormals;
    if (this.isCovered(query, claimed, outside)) return claimed;
    return reals.greatest(byNormals, reals.negative(this.distanceTo(query.x, query.escape, outside)));
  }

  // The distance to a union is the least of those to its primitives where all are positive.
  lowerByNormals({ local, normals }) {
    const { reals, primitives } = this;
    if (!this.isUnion) return reals.minusInfinity;
    const bounds = primitives.map((solid, k) => solid.lowerBySphere(local[k]));
    for (const { primitive, v } of normals.filter((normal) => normal.v)) {
      bounds[primitive] = reals.greatest(bounds[primitive], primitives[primitive].lowerByNormal(local[primitive], v));
    }
    const least = bounds.reduce((a, b) => reals.least(a, b));
    return reals.isBelow(reals.zero, least) || primitives.length === 1 ? least : reals.minusInfinity;
  }

  // An upper end: by normals, else `claimed` by a cover of the complement, else by a point inside.
  upper(query, claimed) {
    const { reals } = this;
    const byNormals = this.upperByNormals(query, claimed);
    if (reals.isAtMost(byNormals, claimed)) return byNormals;
    if (this.isCovered(query, reals.negative(claimed), inside)) return claimed;
    return reals.least(byNormals, this.distanceTo(query.x, query.witness, inside));
  }

  upperByNormals({ local, normals }, claimed) {
    const { reals } = this;
    const meshes = this.isUnion ? this.primitives.map((solid, k) => solid.upperAlone?.(local[k])) : [];
    let least = meshes.filter(Boolean).reduce((a, b) => reals.least(a, b), reals.infinity);
    for (const { primitive, v } of this.isUnion ? normals : []) {
      if (this.primitives[primitive].upperAlone) continue;
      least = reals.least(least, this.upperOfOne(this.primitives[primitive], local[primitive], v, claimed));
      if (reals.isAtMost(least, claimed)) break;
    }
    return least;
  }

  // `claimed` or less where that can be proven; v is an exact vector, not 0, or null.
  upperOfOne(solid, w, v, claimed) {
    const { reals } = this;
    const byNormal = () => (v ? solid.upperByNormal(w, v) : reals.infinity);
    if (reals.isBelow(reals.zero, claimed)) {
      const end = byNormal();
      if (reals.isAtMost(end, claimed)) return end;
    }
    if (!solid.contains(w)) return byNormal();
    const claimsDepth = reals.isBelow(claimed, reals.zero);
    return claimsDepth && solid.containsBall(w, reals.negative(claimed), v) ? claimed : reals.zero;
  }

  // How far a point is that is proven to have the place.
  distanceTo(x, point, place) {
    if (!point) return this.reals.infinity;
    const alone = [0, 0, 0].map(() => this.reals.zero);
    const places = this.primitives.map((solid) => solid.over(point, alone).place);
    if (placeOf(this.trees[outside], places) !== place) return this.reals.infinity;
    return this.intervals.length(this.intervals.difference(point, x)).hi;
  }

  // Whether the ball of that radius holds nothing of the set, or with `inside` of the closure of its complement.
  isCovered(query, radius, place) {
    const { reals } = this;
    if (query.cover.length === 0 || !reals.isBelow(reals.zero, radius) || !reals.isBelow(radius, reals.infinity))
      return false;
    const near = place === outside ? query.witness : query.escape;
    return new Neighbourhood(this.intervals, this.primitives, this.trees[place], query, radius, near).isCovered();
  }
}
