// Where a primitive stands: x -> R x + t, R the rotation of a quaternion divided by its exact length.
export class Placement {
  constructor(intervals, { translation, quaternion }) {
    this.intervals = intervals;
    this.translation = translation.map((t) => intervals.exact(t));
    const [w, x, y, z] = quaternion.map((component) => intervals.exact(component));
    const product = (a, b) => intervals.mul(a, b);
    const square = (a) => intervals.square(a);
    const length = intervals.sum([w, x, y, z].map(square));
    const twice = (a) => intervals.add(a, a);
    const diagonal = (plus, minus) =>
      intervals.sub(intervals.add(square(w), square(plus)), intervals.add(...minus.map(square)));
    const sum = (a, b, c, d) => twice(intervals.add(product(a, b), product(c, d)));
    const difference = (a, b, c, d) => twice(intervals.sub(product(a, b), product(c, d)));
    const rows = [
      [diagonal(x, [y, z]), difference(x, y, w, z), sum(x, z, w, y)],
      [sum(x, y, w, z), diagonal(y, [x, z]), difference(y, z, w, x)],
      [difference(x, z, w, y), sum(y, z, w, x), diagonal(z, [x, y])],
    ];
    const rotation = rows.map((row) => row.map((entry) => intervals.div(entry, length)));
    this.toOwn = [0, 1, 2].map((k) => rotation.map((row) => row[k])); // its rows
  }

  // Where a point of the axis of the primitive's frame stands.
  onAxis(height) {
    const { intervals, translation, toOwn } = this;
    return intervals.translated(
      translation,
      toOwn[2].map((component) => intervals.mul(component, height)),
    );
  }

  // The point of the primitive's frame, about its centre.
  local(point) {
    const { intervals } = this;
    return intervals.product(this.toOwn, intervals.difference(point, this.translation));
  }
}
