// Multipliers of half-spaces {n.e <= b}, in floating point: they propose what half_spaces.js proves.

const dot = (u, v) => u[0] * v[0] + u[1] * v[1] + u[2] * v[2];

// Of the Gram matrix of at most three normals and what the target is beyond them, by Cramer's rule.
function solved(normals, beyond) {
  const gram = normals.map((u) => normals.map((v) => dot(u, v)));
  if (normals.length === 1) return [beyond[0] / gram[0][0]];
  const replaced = (k) => gram.map((row, i) => row.map((entry, j) => (j === k ? beyond[i] : entry)));
  const determinantOf = (m) =>
    m.length === 2
      ? m[0][0] * m[1][1] - m[0][1] * m[1][0]
      : m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
        m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
        m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  const determinant = determinantOf(gram);
  return normals.map((_, k) => determinantOf(replaced(k)) / determinant);
}

// 2 N.target - |N|^2 - 2 sum of m b, N the sum of m n: no point of the half-spaces has a smaller squared distance.
function dual(weights, normals, beyond) {
  const sum = [0, 1, 2].map((k) => normals.reduce((total, n, i) => total + weights[i] * n[k], 0));
  return 2 * weights.reduce((total, weight, i) => total + weight * beyond[i], 0) - dot(sum, sum);
}

function* subsets(count) {
  for (let i = 0; i < count; ++i) {
    yield [i];
    for (let j = i + 1; j < count; ++j) {
      yield [i, j];
      for (let k = j + 1; k < count; ++k) yield [i, j, k];
    }
  }
}

const clearly = 1 + 1e-9;

// [{ cut, weight }] for which the dual is about `wanted` or more, by three half-spaces at most, on which the nearest
// point lies; null where there are none.
export function multipliers(halfSpaces, target, wanted) {
  const beyond = halfSpaces.map(({ normal, offset }) => dot(normal, target) - offset);
  if (beyond.every((part) => part <= 0)) return null;
  let best = null;
  let largest = wanted * (1 - 1e-15);
  for (const subset of subsets(halfSpaces.length)) {
    const normals = subset.map((k) => halfSpaces[k].normal);
    const parts = subset.map((k) => beyond[k]);
    const weights = solved(normals, parts);
    if (!weights.every((weight) => weight >= 0 && Number.isFinite(weight))) continue;
    const value = dual(weights, normals, parts);
    if (!(value > largest)) continue;
    largest = value;
    best = subset.map((cut, k) => ({ cut, weight: weights[k] }));
    if (value > wanted * clearly) break;
  }
  return best;
}
