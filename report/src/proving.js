// Runs the page's checker over all vertices: by workers, or where a browser allows none in the page itself, in slices.

const rowsAtOnce = 16;
const sliceMilliseconds = 40;
const mostWorkers = 8;

// The page must not learn from a worker that this kind of model has no proofs as of a breakdown.
export class ProvingFailed extends Error {
  constructor(message, cannot) {
    super(message);
    this.cannot = cannot;
  }
}

function startWorker(url, proof) {
  return new Promise((resolve, reject) => {
    const worker = new Worker(url);
    worker.onerror = (event) => reject(new Error(event.message ?? "a worker does not start"));
    worker.onmessage = ({ data }) => {
      if (data.ready) return resolve(worker);
      worker.terminate();
      reject(new ProvingFailed(data.error, data.cannot));
    };
    worker.postMessage({ proof });
  });
}

// Hands out ranges of rows to a worker until none is left.
function keepBusy(worker, nextRange, take) {
  return new Promise((resolve, reject) => {
    const ask = () => {
      const range = nextRange();
      if (range) worker.postMessage(range);
      else resolve();
    };
    worker.onerror = (event) => reject(new Error(event.message ?? "a worker has ended"));
    worker.onmessage = ({ data }) => {
      if (data.error !== undefined) return reject(new ProvingFailed(data.error, data.cannot));
      take(data.from, data.verdicts);
      ask();
    };
    ask();
  });
}

async function proveByWorkers(workers, nextRange, take) {
  try {
    await Promise.all(workers.map((worker) => keepBusy(worker, nextRange, take)));
  } finally {
    workers.forEach((worker) => worker.terminate());
  }
}

async function proveHere(proof, nextRange, take) {
  const { proverOf, CannotProve } = globalThis.verisqProver;
  try {
    const prover = await proverOf(proof);
    for (let start = performance.now(), range = nextRange(); range; range = nextRange()) {
      const rows = Array.from({ length: range.to - range.from }, (_, k) => range.from + k);
      take(
        range.from,
        rows.map((row) => prover.verdict(row)),
      );
      if (performance.now() - start < sliceMilliseconds) continue;
      await new Promise((resume) => setTimeout(resume));
      start = performance.now();
    }
  } catch (error) {
    throw new ProvingFailed(error.message, error instanceof CannotProve);
  }
}

// Where a page may have no workers (some browsers, opened from a file), null.
async function startWorkers(script, proof, count) {
  const url = URL.createObjectURL(new Blob([script], { type: "text/javascript" }));
  try {
    return await Promise.all(Array.from({ length: count }, () => startWorker(url, proof)));
  } catch (error) {
    if (error instanceof ProvingFailed) throw error;
    return null;
  } finally {
    URL.revokeObjectURL(url);
  }
}

// Calls take(from, verdicts) for ranges of the rows 0 to count, in any order. Throws ProvingFailed.
export async function proveAll(script, proof, count, take) {
  let next = 0;
  const nextRange = () => {
    if (next >= count) return null;
    const from = next;
    next = Math.min(count, from + rowsAtOnce);
    return { from, to: next };
  };
  const wanted = Math.min(navigator.hardwareConcurrency || 1, mostWorkers, Math.ceil(count / rowsAtOnce));
  const workers = await startWorkers(script, proof, Math.max(wanted, 1));
  try {
    await (workers ? proveByWorkers(workers, nextRange, take) : proveHere(proof, nextRange, take));
  } catch (error) {
    throw error instanceof ProvingFailed ? error : new ProvingFailed(error.message, false);
  }
}
