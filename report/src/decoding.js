// Reads the data block of the page: JSON with base64 arrays becomes typed arrays (report/README.md has the format).

import { shownUnits } from "./numbers.js";

const format = "verisq-report/1";

// A report that cannot be shown; the message is for the reader.
export class BrokenReport extends Error {}

function bytesOf(base64) {
  if (typeof Uint8Array.fromBase64 === "function") return Uint8Array.fromBase64(base64);
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let k = 0; k < text.length; ++k) bytes[k] = text.charCodeAt(k);
  return bytes;
}

function isLittleEndian() {
  return new Uint8Array(new Uint32Array([1]).buffer)[0] === 1;
}

function numbersOf(base64, Numbers, length, name) {
  const bytes = bytesOf(base64);
  if (bytes.length % Numbers.BYTES_PER_ELEMENT !== 0) throw new BrokenReport(`${name}: a number is cut off`);
  const numbers = new Numbers(bytes.buffer, bytes.byteOffset, bytes.length / Numbers.BYTES_PER_ELEMENT);
  if (length !== undefined && numbers.length !== length) {
    throw new BrokenReport(`${name}: ${numbers.length} numbers instead of ${length}`);
  }
  return numbers;
}

function surfaceOf(surface, name) {
  const positions = numbersOf(surface.positions, Float32Array, undefined, `${name}.positions`);
  const triangles = numbersOf(surface.triangles, Uint32Array, undefined, `${name}.triangles`);
  const vertices = positions.length / 3;
  if (!triangles.every((vertex) => vertex < vertices)) throw new BrokenReport(`${name}.triangles: no such vertex`);
  return { positions, triangles };
}

// As the writer rounds it for drawing: what is drawn must be what is proven.
function isDrawnAt(vertices, positions, centre) {
  const largest = 2 ** 128 - 2 ** 104;
  return vertices.every((coordinate, k) => {
    const place = coordinate - centre[k % 3];
    return Object.is(Math.fround(Math.min(Math.max(place, -largest), largest)), positions[k]);
  });
}

function requireRising(ends, name) {
  if (!ends.every((end, row) => end >= (ends[row - 1] ?? 0))) throw new BrokenReport(`${name}: falls`);
}

// The meshes of files, by primitive; null where no primitive is one.
function meshesOf(meshes) {
  return (
    meshes &&
    meshes.map(
      (mesh, k) =>
        mesh && {
          vertices: numbersOf(mesh.vertices, Float64Array, undefined, `proof.meshes[${k}].vertices`),
          triangles: numbersOf(mesh.triangles, Uint32Array, undefined, `proof.meshes[${k}].triangles`),
        },
    )
  );
}

// `verisqProver.proverOf` takes it, with the claims: vertices, and certificates as the model's text says.
function proofOf(proof, report, positions, claims) {
  const { certificates } = proof;
  const numbers = (name, Numbers, length) => numbersOf(certificates[name], Numbers, length, `proof.${name}`);
  const normalsEnd = numbers("normals_end", Uint32Array, positions.length / 3);
  const escaping = numbers("escaping", Uint32Array);
  const witnessing = numbers("witnessing", Uint32Array);
  const coversEnd = numbers("covers_end", Uint32Array, positions.length / 3);
  const vertices = numbersOf(proof.vertices, Float64Array, positions.length, "proof.vertices");
  if (!isDrawnAt(vertices, positions, report.centre)) throw new BrokenReport("what is drawn is not what is proven");
  const count = normalsEnd.at(-1) ?? 0;
  requireRising(normalsEnd, "proof.normals_end");
  requireRising(coversEnd, "proof.covers_end");
  return {
    ...claims,
    model: proof.model,
    modelSha256: proof.model_sha256,
    meshes: meshesOf(proof.meshes),
    units: report.units,
    modelName: proof.model_name,
    meshName: proof.mesh_name,
    meshSha256: proof.mesh_sha256,
    poses: proof.poses && numbersOf(proof.poses, Float64Array, undefined, "proof.poses"),
    pointRadius: proof.point_radius,
    vertices,
    normalsEnd,
    primitives: numbers("primitives", Uint32Array, count),
    normals: numbers("normals", Float64Array, 3 * count),
    escaping,
    escapes: numbers("escapes", Float64Array, 3 * escaping.length),
    witnessing,
    witnesses: numbers("witnesses", Float64Array, 3 * witnessing.length),
    coversEnd,
    covers: numbers("covers", Uint8Array, Math.ceil((coversEnd.at(-1) ?? 0) / 8)),
  };
}

export function decodeReport(text) {
  const report = JSON.parse(text);
  if (report.format !== format) throw new BrokenReport(`format: ${report.format} is not ${format}`);
  if (!isLittleEndian()) throw new BrokenReport("this machine is not little-endian");
  const bone = surfaceOf(report.bone, "bone");
  const count = bone.positions.length / 3;
  const perVertex = (base64, Numbers, name) => numbersOf(base64, Numbers, count, name);
  const lo = perVertex(report.lo, Float64Array, "lo");
  const hi = perVertex(report.hi, Float64Array, "hi");
  if (report.proof && report.path) throw new BrokenReport("certificates are of one pose, not of a way");
  return {
    title: report.title,
    units: shownUnits(report.units),
    solidName: report.solid_name,
    range: report.range ?? null,
    up: report.up,
    front: report.front,
    summary: report.summary,
    centre: report.centre,
    count,
    bone,
    implant: surfaceOf(report.implant, "implant"),
    lo,
    hi,
    status: perVertex(report.status, Uint8Array, "status"),
    path: report.path ?? null,
    areas: report.areas && { names: report.areas.names, of: perVertex(report.areas.of, Uint32Array, "areas.of") },
    proof: report.proof ? proofOf(report.proof, report, bone.positions, { lo, hi }) : null,
    verdicts: new Uint8Array(count), // of this page's checker, as quantities.js names them
  };
}
