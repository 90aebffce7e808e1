// The checker of a page: the same script serves a worker, the page itself where there are no workers, and tests.
import { Checker } from "./checker.js";
import { CannotProve, primitivesOf, unitsOf } from "./model.js";
import { loadRealNumbers } from "./real_numbers.js";

// The model's primitives, where the page says that they stand.
function placed(primitives, poses) {
  if (!poses) return primitives;
  if (poses.length !== 7 * primitives.length || !poses.every(Number.isFinite)) {
    throw new Error("poses: not seven finite numbers for each primitive");
  }
  return primitives.map((primitive, k) => ({
    ...primitive,
    translation: [...poses.subarray(7 * k, 7 * k + 3)],
    quaternion: [...poses.subarray(7 * k + 3, 7 * k + 7)],
  }));
}

const triple = (numbers, k) => [...numbers.subarray(3 * k, 3 * k + 3)];

// Of decoded proof data (report/src/decoding.js) and the claims `lo`, `hi`.
class Prover {
  constructor(reals, proof) {
    this.proof = proof;
    // A negative radius would weaken every claim.
    const { pointRadius } = proof;
    if (!(typeof pointRadius === "number" && pointRadius >= 0 && pointRadius < Infinity))
      throw new Error("point_radius: not a number of at least 0");
    if (unitsOf(proof.model) !== proof.units) throw new Error("units: not those of the model's text");
    this.checker = new Checker(reals, placed(primitivesOf(proof.model), proof.poses));
    this.escapeOf = new Map();
    proof.escaping.forEach((row, k) => this.escapeOf.set(row, k));
  }

  // "proved", "refuted" or "unproved".
  verdict(row) {
    const { vertices, lo, hi, pointRadius, normalsEnd, primitives, normals, escapes } = this.proof;
    const found = [];
    for (let k = row === 0 ? 0 : normalsEnd[row - 1]; k < normalsEnd[row]; ++k) {
      found.push({ primitive: primitives[k], vector: triple(normals, k) });
    }
    const escape = this.escapeOf.get(row);
    return this.checker.verdict({
      point: triple(vertices, row),
      lo: lo[row],
      hi: hi[row],
      radius: pointRadius,
      normals: found,
      escape: escape === undefined ? null : triple(escapes, escape),
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

globalThis.verisqProver = { proverOf, loadRealNumbers, Checker, primitivesOf, CannotProve };
if (typeof WorkerGlobalScope !== "undefined" && globalThis instanceof WorkerGlobalScope) serve();
