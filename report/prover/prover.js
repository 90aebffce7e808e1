// The checker of a page: the same script serves a worker, the page itself where there are no workers, and tests.
import { Checker } from "./checker.js";
import { CannotProve, modelOf, unitsOf } from "./model.js";
import { loadRealNumbers } from "./real_numbers.js";

// The model with its primitives where the page says that they stand.
function placed(model, poses) {
  if (!poses) return model;
  const { primitives } = model;
  if (poses.length !== 7 * primitives.length || !poses.every(Number.isFinite)) {
    throw new Error("poses: not seven finite numbers for each primitive");
  }
  const moved = primitives.map((primitive, k) => ({
    ...primitive,
    translation: [...poses.subarray(7 * k, 7 * k + 3)],
    quaternion: [...poses.subarray(7 * k + 3, 7 * k + 7)],
  }));
  return { ...model, primitives: moved };
}

const triple = (numbers, k) => [...numbers.subarray(3 * k, 3 * k + 3)];

// By their rows.
const pointsOf = (rows, points) => new Map([...rows].map((row, k) => [row, triple(points, k)]));

// Bits first to end of bytes that begin with their highest.
const bitsOf = (bytes, first, end) =>
  Array.from({ length: end - first }, (_, k) => ((bytes[(first + k) >>> 3] >> (7 - ((first + k) & 7))) & 1) === 1);

// Of decoded proof data (report/src/decoding.js) and the claims `lo`, `hi`.
class Prover {
  constructor(reals, proof) {
    this.proof = proof;
    // A negative radius would weaken every claim.
    const { pointRadius } = proof;
    if (!(typeof pointRadius === "number" && pointRadius >= 0 && pointRadius < Infinity))
      throw new Error("point_radius: not a number of at least 0");
    if (unitsOf(proof.model) !== proof.units) throw new Error("units: not those of the model's text");
    this.checker = new Checker(reals, placed(modelOf(proof.model, proof.meshes), proof.poses));
    this.escapeOf = pointsOf(proof.escaping, proof.escapes);
    this.witnessOf = pointsOf(proof.witnessing, proof.witnesses);
  }

  // "proved", "refuted" or "unproved".
  verdict(row) {
    const { vertices, lo, hi, pointRadius, normalsEnd, primitives, normals, coversEnd, covers } = this.proof;
    const found = [];
    for (let k = row === 0 ? 0 : normalsEnd[row - 1]; k < normalsEnd[row]; ++k) {
      found.push({ primitive: primitives[k], vector: triple(normals, k) });
    }
    return this.checker.verdict({
      point: triple(vertices, row),
      lo: lo[row],
      hi: hi[row],
      radius: pointRadius,
      normals: found,
      escape: this.escapeOf.get(row) ?? null,
      witness: this.witnessOf.get(row) ?? null,
      cover: bitsOf(covers, row === 0 ? 0 : coversEnd[row - 1], coversEnd[row]),
    });
  }
}

async function proverOf(proof) {
  return new Prover(await loadRealNumbers(), proof);
}

// In a worker: the proof data first, then ranges of rows.
function serve() {
  let prover;
  const answer = async (data) => {
    if (data.proof) {
      prover = await proverOf(data.proof);
      return { ready: true };
    }
    const rows = Array.from({ length: data.to - data.from }, (_, k) => data.from + k);
    return { from: data.from, verdicts: rows.map((row) => prover.verdict(row)) };
  };
  globalThis.onmessage = ({ data }) =>
    answer(data).then(
      (reply) => globalThis.postMessage(reply),
      (error) => globalThis.postMessage({ error: error.message, cannot: error instanceof CannotProve }),
    );
}

globalThis.verisqProver = { proverOf, loadRealNumbers, Checker, modelOf, CannotProve };
if (typeof WorkerGlobalScope !== "undefined" && globalThis instanceof WorkerGlobalScope) serve();
