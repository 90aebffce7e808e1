// Whether a ball lies in a superquadric (docs/mathematics.md, section 5): cones from its centre, each cut off by a face
// whose corners lie in the solid, cover it.
import { down, up } from "./real_numbers.js";

const budget = 50000; // corners
const deepestLevel = 50; // of bisections: directions stay exact, multiples of 2^-50 in [0, 1]

const dot = (u, v) => u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
const minus = (u, v) => [u[0] - v[0], u[1] - v[1], u[2] - v[2]];
const towards = (u, v, share) => [0, 1, 2].map((k) => u[k] + share * (v[k] - u[k]));

// The point of a segment, of a triangle, that is nearest to the origin, to nearest.
function nearestOfSegment(a, b) {
  const side = minus(b, a);
  const squared = dot(side, side);
  const share = squared > 0 ? -dot(a, side) / squared : 0;
  return towards(a, b, Math.min(Math.max(share, 0), 1));
}
function nearestOfTriangle(a, b, c) {
  const [u, v] = [minus(b, a), minus(c, a)];
  const [uu, uv, vv, au, av] = [dot(u, u), dot(u, v), dot(v, v), dot(a, u), dot(a, v)];
  const determinant = uu * vv - uv * uv;
  const s = (uv * av - vv * au) / determinant;
  const t = (uv * au - uu * av) / determinant;
  if (s >= 0 && t >= 0 && s + t <= 1) return [0, 1, 2].map((k) => a[k] + s * u[k] + t * v[k]);
  const sides = [nearestOfSegment(a, b), nearestOfSegment(b, c), nearestOfSegment(c, a)];
  return sides.reduce((best, point) => (dot(point, point) < dot(best, best) ? point : best));
}

class Cover {
  // Of the ball of radius `radius` (a real number) about q, whose coordinates are thin intervals; x and y are not
  // negative, nor is z where there is no taper.
  constructor(bounds, q, radius) {
    const { intervals, reals } = bounds;
    Object.assign(this, { bounds, intervals, reals, q, radius });
    this.start = q.map((coordinate) => reals.toNumber(coordinate.hi, up));
    this.target = reals.toNumber(radius, up);
    this.corners = new Map();
    this.hopeless = false;
  }

  // How far along the ray from q the solid reaches, about: g is convex along it and below 1 at its start.
  reach(direction) {
    const gaugeAt = (s) =>
      this.bounds.approximateGauge(
        towards(
          this.start,
          [0, 1, 2].map((k) => this.start[k] + direction[k]),
          s,
        ),
      ) - 1;
    let low = 0;
    let high = this.target;
    for (let doubling = 0; gaugeAt(high) < 0 && doubling < 1100; ++doubling) [low, high] = [high, 2 * high];
    let [atLow, atHigh] = [gaugeAt(low), gaugeAt(high)];
    // The chord's zero lies inside, because g is convex.
    for (let step = 0; step < 100 && high - low > 1e-16 * high; ++step) {
      const bisect = step % 3 === 2;
      let s = bisect ? (low + high) / 2 : low + ((high - low) * atLow) / (atLow - atHigh);
      if (!(s > low && s < high)) s = (low + high) / 2;
      if (!(s > low && s < high)) break;
      const value = gaugeAt(s);
      if (value < 0) [low, atLow] = [s, value];
      else [high, atHigh] = [s, value];
    }
    return low;
  }

  // A point q + d of the solid along a direction, as far as can be proven: d is the direction times a number of 53
  // bits, exact.
  corner(direction) {
    const key = direction.join();
    const known = this.corners.get(key);
    if (known) return known;
    if (this.corners.size >= budget) {
      this.hopeless = true;
      return null;
    }
    const reach = this.reach(direction);
    let made = null;
    for (let margin = 2 ** -52; made === null && margin < 1; margin *= 8)
      made = this.cornerAt(direction, reach * (1 - margin));
    made ??= this.cornerAt(direction, 0);
    // Whatever the face, none of its points is farther away than its corners' least distance.
    if (made === null || Math.hypot(...made.approximate) < this.target * (1 - 1e-12)) this.hopeless = true;
    if (made) this.corners.set(key, made);
    return made;
  }

  cornerAt(direction, s) {
    const { intervals, reals } = this;
    const mark = reals.mark();
    const scale = reals.exact(s);
    const d = direction.map((component) => {
      const product = reals.mul(scale, reals.exact(component), down); // 106 bits: exact
      return { lo: product, hi: product };
    });
    const kept = reals.mark();
    const inside = this.bounds.contains(this.q.map((coordinate, k) => intervals.add(coordinate, d[k])));
    reals.release(inside ? kept : mark);
    return inside ? { direction, d, approximate: direction.map((component) => s * component) } : null;
  }

  // The ball's part in the cone of the corners lies in the solid.
  isCutOff(corners) {
    const points = corners.map(({ approximate }) => approximate);
    const nearest = points.length === 3 ? nearestOfTriangle(...points) : nearestOfSegment(...points);
    const size = Math.hypot(...nearest);
    const normal = nearest.map((component) => component / size);
    if (!normal.every(Number.isFinite)) return false;
    if (points.some((point) => dot(normal, point) < this.target * (1 - 4e-15))) return false;
    const { intervals, reals } = this;
    const mark = reals.mark();
    const c = normal.map((component) => intervals.exact(component));
    const wanted = reals.mul(this.radius, intervals.length(c).hi, up);
    const proven = corners.every(({ d }) => reals.isAtMost(wanted, intervals.dot(c, d).lo));
    reals.release(mark);
    return proven;
  }

  // Depth first.
  covers(directions) {
    const first = directions.map((direction) => this.corner(direction));
    if (this.hopeless) return false;
    const open = [{ corners: first, level: 0 }];
    while (open.length > 0) {
      const { corners, level } = open.pop();
      if (this.isCutOff(corners)) continue;
      if (level === deepestLevel) return false;
      const halves = this.halves(corners);
      if (halves === null) return false;
      open.push(...halves.map((half) => ({ corners: half, level: level + 1 })));
    }
    return true;
  }

  // Cut at the middle direction of the longest edge: in the plane of its ends, exactly. null: there is no hope.
  halves(corners) {
    const edges =
      corners.length === 3
        ? [
            [0, 1],
            [1, 2],
            [2, 0],
          ]
        : [[0, 1]];
    const lengthOf = ([i, j]) => {
      const side = minus(corners[i].direction, corners[j].direction);
      return dot(side, side);
    };
    const [i, j] = edges.reduce((best, edge) => (lengthOf(edge) > lengthOf(best) ? edge : best));
    const middle = this.corner([0, 1, 2].map((k) => (corners[i].direction[k] + corners[j].direction[k]) / 2));
    if (middle === null || this.hopeless) return null;
    return [i, j].map((replaced) => corners.map((corner, k) => (k === replaced ? middle : corner)));
  }
}

// Which coordinate runs along the axis of a solid of revolution; null: it is none.
function axisOfRevolution({ semiAxes: [a1, a2, a3], exponents: [alongZ, inSection], isTapered }) {
  if (inSection !== 1) return null;
  if (a1 === a2) return 2;
  if (alongZ !== 1 || isTapered) return null; // an ellipsoid
  if (a2 === a3) return 0;
  return a1 === a3 ? 1 : null;
}

// By the triangle inequality of the gauge about the focus, which is exact about the centre of a sphere.
function holdsByGauge(bounds, w, radius) {
  const { intervals, reals } = bounds;
  const { axes, exponents } = bounds;
  const shortest = axes.map(({ lo }) => lo).reduce((a, b) => reals.least(a, b));
  const one = reals.one;
  const ofOctahedron = () => {
    const sum = axes
      .map((a) => intervals.div(intervals.exact(1), intervals.square(a)))
      .reduce((a, b) => intervals.add(a, b));
    return reals.div(one, reals.sqrt(sum.hi, up), down);
  };
  let inradius = exponents.every((eps) => eps <= 1) ? shortest : ofOctahedron();
  if (bounds.isTapered) inradius = reals.mul(inradius, reals.sub(one, intervals.abs(bounds.k).hi, down), down);
  const left = reals.sub(one, bounds.gaugeUp(w), down);
  return reals.isAtMost(radius, reals.mul(left, inradius, down));
}

// The ball of radius `asked` (a real number, positive) about the point w, a thin box that lies in the solid.
export function containsBall(bounds, w, asked) {
  const { intervals, reals } = bounds;
  if (holdsByGauge(bounds, w, asked)) return true;
  // Folded into the octant: a ball about a point with larger |coordinates| is the harder one to hold.
  const folded = w.map((coordinate, k) => (k < 2 || !bounds.isTapered ? intervals.abs(coordinate) : coordinate));
  const largest = ({ hi }) => ({ lo: hi, hi });
  const axis = axisOfRevolution(bounds);
  const q = axis === null ? folded.map(largest) : inSection(intervals, folded, axis).map(largest);
  // Along z, where a taper allows no folding, the centre moves by the width of the box: the ball grows by that.
  const moved = bounds.isTapered ? reals.add(asked, reals.sub(w[2].hi, w[2].lo, up), up) : asked;
  if (!bounds.contains(q)) return false;
  const signs = bounds.isTapered ? [1, -1] : [1];
  const cover = new Cover(bounds, q, moved);
  return signs.every((sign) => {
    const axes = [
      [1, 0, 0],
      [0, 1, 0],
      [0, 0, sign],
    ];
    if (axis === null) return cover.covers(axes);
    const across = acrossAxis(axis);
    return cover.covers([axes[across], axes[axis]]);
  });
}

const acrossAxis = (axis) => (axis === 0 ? 1 : 0);

// A solid of revolution: the section through the axis that holds the point decides.
function inSection(intervals, q, axis) {
  const others = [0, 1, 2].filter((k) => k !== axis);
  const zero = intervals.exact(0);
  const result = [zero, zero, zero];
  result[axis] = q[axis];
  result[acrossAxis(axis)] = intervals.length([q[others[0]], q[others[1]], zero]);
  return result;
}
