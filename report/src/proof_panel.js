// The panel that proves all vertices again, and says in words what that means.
import { byId, element } from "./elements.js";
import { countText, withUnits } from "./numbers.js";
import { ProvingFailed, proveAll } from "./proving.js";
import { verdicts } from "./quantities.js";
import { sha256 } from "./sha256.js";

const redrawMilliseconds = 400;

const withoutProof =
  "This page holds no certificates: it shows what verisq has proven, and cannot prove it again. Pages of " +
  "verisq map --certificates --report can.";

// A mesh needs no certificate: the checker has its triangles.
function offer({ meshName, modelName, meshes }) {
  const held = meshes ? "the vertices, and the model with its meshes" : "the vertices, the model and for every vertex a certificate";
  return (
    `This page holds ${held}: verisq's result for ${meshName} and ${modelName} can be proven again here, by a checker ` +
    "that shares no code with verisq."
  );
}

function modelInWords({ model, meshes }) {
  if (model === null) return "the closed mesh in this page";
  return meshes ? "the model whose text and meshes are in this page" : "the model whose text is in this page";
}

// Which hash the reader compares, and of what.
function hashOfModel({ model, modelName, modelSha256, meshes }) {
  if (!meshes) return [`${modelName}, SHA-256 of the text in this page`, sha256(model)];
  const files = model === null ? "the file" : "the file and, behind it, of the mesh files that it names";
  return [`${modelName}, SHA-256 of ${files}, as verisq read them`, modelSha256];
}

function ownershipOfModel({ modelName, meshes }) {
  return meshes
    ? `that the model and its meshes are those of ${modelName}, whose SHA-256 verisq has written down below`
    : `that the model is yours (the SHA-256 of its text, below, is that of ${modelName})`;
}

function meaning(report) {
  const { proof, units } = report;
  const radius = proof.pointRadius > 0 ? `any point within ${withUnits(String(proof.pointRadius), units)} of ` : "";
  const { meshName } = proof;
  return [
    `A green vertex: the exact signed distance of ${radius}the vertex, with the coordinates in this page bit for bit, ` +
      `to ${modelInWords(proof)} lies in [lo, hi]. Red: it is proven not to. Yellow: that is not decided.`,
    ...(proof.meshes
      ? [
          "Inside a closed mesh the distance is minus the distance to its surface. Where triangles of the mesh cross " +
            "each other, a point may lie deeper than that.",
        ]
      : []),
    ...(proof.poses
      ? [
          "The primitives stand where this page says that --pose has moved them, and not where the model's text has " +
            "them: that this is a motion of the model, and which, is not checked.",
        ]
      : []),
    "The proof takes arithmetic of 128 bits, rounded to the safe side, and the theorems in verisq's " +
      "docs/mathematics.md. Nothing of how verisq found its result matters.",
    "Trusted: this browser and machine; MPFR, compiled to WebAssembly; this page's own scripts. Who may have changed " +
      "the page may have changed its checker, too: then take a page, or a checker, from a source that you trust.",
    `Trusted, or compared by you: ${ownershipOfModel(proof)}, and that the vertices are those of your ${meshName}, whose SHA-256 verisq has written down` +
      `${proof.poses ? "; and where --pose has moved the model" : ""}.`,
    "Not proven: the drawing of the model, the colours between vertices, the status, and the table below, which is " +
      "verisq's own summary. The counts and the smallest distance under Proven follow from the intervals.",
  ];
}

export class ProofPanel {
  // `redraw` shows new verdicts; `showProof` colours the bone by them; `pin(vertex)` shows one.
  constructor(report, { redraw, showProof, pin }) {
    Object.assign(this, { report, redraw, showProof, pin });
    if (!report.proof) {
      byId("proof-offer").textContent = withoutProof;
      return;
    }
    byId("proof-offer").textContent = offer(report.proof);
    byId("proof-run").hidden = false;
    this.fillMeaning();
    byId("proof-start").textContent = `Prove all ${countText(report.count)} vertices`;
    byId("proof-start").addEventListener("click", () => this.prove());
    byId("proof-first").addEventListener("click", () => this.pin(this.firstOpen()));
  }

  fillMeaning() {
    const { proof } = this.report;
    byId("proof-meaning").replaceChildren(...meaning(this.report).map((text) => element("li", {}, text)));
    const files = [
      hashOfModel(proof),
      [`${proof.meshName}, SHA-256 of the file that verisq read`, proof.meshSha256],
    ];
    byId("proof-files").replaceChildren(
      ...files.flatMap(([name, hash]) => [element("dt", {}, name), element("dd", {}, hash)]),
    );
  }

  counts() {
    const counts = [0, 0, 0, 0];
    for (const verdict of this.report.verdicts) ++counts[verdict];
    return Object.fromEntries(verdicts.map((name, k) => [name, counts[k]]));
  }

  // The first that is not proved, refuted ones before others.
  firstOpen() {
    const refuted = this.report.verdicts.indexOf(verdicts.indexOf("refuted"));
    return refuted >= 0 ? refuted : this.report.verdicts.indexOf(verdicts.indexOf("unproved"));
  }

  async prove() {
    const { report } = this;
    report.verdicts.fill(0);
    byId("proof-start").disabled = true;
    byId("proof-first").hidden = true;
    byId("proof-progress").hidden = false;
    byId("proof").className = "";
    this.showProof();
    this.start = performance.now();
    this.shown = this.start;
    let done = 0;
    try {
      const script = byId("verisq-prover").textContent;
      await proveAll(script, report.proof, report.count, (from, found) => {
        found.forEach((verdict, k) => (report.verdicts[from + k] = verdicts.indexOf(verdict)));
        done += found.length;
        this.tellProgress(done);
      });
      this.tellResult();
    } catch (error) {
      if (!(error instanceof ProvingFailed)) throw error;
      byId("proof").className = "failed";
      byId("proof-result").textContent = error.cannot
        ? `This page cannot prove ${error.message}. The program verisq check may.`
        : `This page cannot prove its vertices: ${error.message}.`;
    } finally {
      byId("proof-start").disabled = false;
      byId("proof-progress").hidden = true;
      this.redraw();
    }
  }

  tellProgress(done) {
    const { count } = this.report;
    byId("proof-progress").value = done / count;
    byId("proof-result").textContent = `${countText(done)} of ${countText(count)} checked`;
    if (performance.now() - this.shown < redrawMilliseconds) return;
    this.shown = performance.now();
    this.redraw();
  }

  tellResult() {
    const { count } = this.report;
    const { proved, refuted, unproved } = this.counts();
    const seconds = ((performance.now() - this.start) / 1000).toFixed(1);
    const first = this.firstOpen();
    const isProved = proved === count;
    byId("proof").className = isProved ? "proved" : refuted > 0 ? "refuted" : "unproved";
    byId("proof-result").textContent = isProved
      ? `All ${countText(count)} vertices are proved, in ${seconds} s.`
      : `${countText(proved)} proved, ${countText(refuted)} refuted, ${countText(unproved)} unproved, in ${seconds} s.`;
    byId("proof-first").hidden = isProved;
    byId("proof-first").textContent = `Show vertex ${first}, the first that is ${refuted > 0 ? "refuted" : "unproved"}`;
  }
}
