// Whether the open ball about a point holds nothing of a set, by a cover of cells each of which is settled on its own
// (docs/mathematics.md, section 28).
import { HalfSpaces } from "./half_spaces.js";
import { isLeaf, inside, open, outside, placeOf } from "./set_tree.js";
import { down, up } from "./real_numbers.js";

const longestCover = 65536; // cells and halved cells
const smallestShare = 2 ** -58; // of the cube's edges: larger cells have exact offsets

export class Neighbourhood {
  // Of `radius`, a positive real number, about the query's point; `tree` is that of the set. `near`, a point or null,
  // lies beside the set's nearest.
  constructor(intervals, primitives, tree, query, radius, near) {
    Object.assign(this, { intervals, reals: intervals.reals, primitives, tree, query, radius });
    this.squaredRadius = this.reals.mul(radius, radius, up);
    this.halfSpaces = new HalfSpaces(intervals, primitives, this.squaredRadius, near);
    this.places = primitives.map(() => open);
    this.placeWhole();
  }

  // On which side of its primitives the whole ball lies, by normals and spheres.
  placeWhole() {
    const { reals, query, places, radius } = this;
    const isFar = (bound) => reals.isAtMost(radius, bound);
    for (const { primitive, v } of query.normals) {
      if (places[primitive] !== open) continue;
      const [solid, w] = [this.primitives[primitive], query.local[primitive]];
      if (v && isFar(solid.lowerByNormal(w, v))) places[primitive] = outside;
      else if (solid.contains(w) && solid.containsBall(w, radius, v)) places[primitive] = inside;
    }
    this.primitives.forEach((solid, k) => {
      if (places[k] === open && isFar(solid.lowerBySphere(query.local[k]))) places[k] = outside;
    });
  }

  // Cells in preorder, of the cube about the ball.
  isCovered() {
    const { reals, query } = this;
    const { cover } = query;
    if (cover.length > longestCover) return false;
    const whole = { offset: [reals.zero, reals.zero, reals.zero], half: [this.radius, this.radius, this.radius] };
    const left = [whole];
    for (const isHalved of cover) {
      if (left.length === 0) return false;
      const cell = left.pop();
      if (!isHalved) {
        if (!this.isEmpty(cell)) return false;
        continue;
      }
      const halves = this.halves(cell);
      if (halves === null) return false;
      left.push(halves[1], halves[0]);
    }
    return left.length === 0;
  }

  // Across the first of its longest edges.
  halves({ offset, half }) {
    const { reals } = this;
    const longest = half.reduce((a, b) => reals.greatest(a, b));
    const axis = half.findIndex((edge) => reals.isAtMost(longest, edge));
    if (reals.isBelow(longest, reals.mul(this.radius, reals.exact(smallestShare), up))) return null;
    const edge = reals.div(half[axis], reals.two, down); // exact, as the offsets are
    const moved = (by, side) =>
      offset.map((coordinate, k) => (k === axis ? reals.add(coordinate, by, side) : coordinate));
    const shorter = half.map((each, k) => (k === axis ? edge : each));
    return [
      { offset: moved(reals.negative(edge), down), half: shorter },
      { offset: moved(edge, up), half: shorter },
    ];
  }

  // Whether what of the ball lies in the cell holds nothing of the set.
  isEmpty(cell) {
    const { reals } = this;
    const mark = reals.mark();
    const result = this.isBeyondBall(cell) || new Look(this, cell).isFar(this.tree);
    reals.release(mark);
    return result;
  }

  isBeyondBall({ offset, half }) {
    const { intervals, reals } = this;
    const nearest = offset.map((coordinate, k) => {
      const { lo } = intervals.abs({ lo: coordinate, hi: coordinate });
      const left = reals.greatest(reals.zero, reals.sub(lo, half[k], down));
      return reals.mul(left, left, down);
    });
    const squared = nearest.reduce((a, b) => reals.add(a, b, down));
    return reals.isAtMost(this.squaredRadius, squared);
  }
}

// At one cell.
class Look {
  constructor({ intervals, query, primitives, places, halfSpaces }, cell) {
    Object.assign(this, { halfSpaces, cell });
    const centre = cell.offset.map((coordinate, k) => intervals.add(query.x[k], { lo: coordinate, hi: coordinate }));
    this.regions = places.map((place, k) => (place === open ? primitives[k].over(centre, cell.half) : { place }));
    this.places = this.regions.map(({ place }) => place);
    this.faces = halfSpaces.facesOf(cell);
  }

  // Whether what of the node's set lies in the cell and in the cuts is as far as the radius.
  isFar(node, cuts = this.faces) {
    const place = placeOf(node, this.places);
    if (place === outside) return true;
    if (place === inside) return this.halfSpaces.areFar(cuts, this.cell);
    if (isLeaf(node)) return this.halfSpaces.areFar([...cuts, ...this.cutsOf(node)], this.cell);
    if (node.isUnion) return node.operands.every((operand) => this.isFar(operand, cuts));
    const all = [...cuts, ...node.operands.filter(isLeaf).flatMap((leaf) => this.cutsOf(leaf))];
    if (this.halfSpaces.areFar(all, this.cell)) return true;
    return node.operands.some((operand) => !isLeaf(operand) && this.isFar(operand, all));
  }

  cutsOf({ primitive, isComplement }) {
    const region = this.regions[primitive];
    if (region.place !== open || !region.at) return [];
    return isComplement
      ? this.halfSpaces.outside(primitive, region, this.cell)
      : this.halfSpaces.inside(primitive, region, this.cell);
  }
}
