// What can be shown of the vertices. A quantity has a coordinate per vertex on its axis: a signed distance, the decimal
// logarithm of a width, or the number of a category. A coordinate that is not finite means: not bounded.

export const statusNames = ["device-verified", "host-verified", "wide"];
const statusMeanings = ["proven by the device", "proven by the host", "valid, but wider than the tolerance"];

export const verdicts = ["open", "proved", "refuted", "unproved"];
const verdictMeanings = [
  "not checked in this browser yet",
  "the certificate proves the interval",
  "the distance lies outside the interval, or the interval is none",
  "the certificate does not decide",
];

function extentOf(count, coordinate) {
  let least = Infinity;
  let greatest = -Infinity;
  for (let vertex = 0; vertex < count; ++vertex) {
    const value = coordinate(vertex);
    if (!Number.isFinite(value)) continue;
    if (value < least) least = value;
    if (value > greatest) greatest = value;
  }
  return least <= greatest ? { least, greatest } : { least: 0, greatest: 0 };
}

function bound(report, id, label, ends, explanation) {
  const coordinate = (vertex) => ends[vertex];
  return { id, label, axis: "signed", coordinate, explanation, ...extentOf(report.count, coordinate) };
}

function width({ lo, hi, count }) {
  let smallest = Infinity;
  for (let vertex = 0; vertex < count; ++vertex) {
    const value = hi[vertex] - lo[vertex];
    if (value > 0 && value < smallest) smallest = value;
  }
  if (smallest === Infinity) smallest = 1;
  const coordinate = (vertex) => Math.log10(Math.max(hi[vertex] - lo[vertex], smallest));
  const explanation = "How wide each interval is, on a logarithmic scale. Width 0 counts as the smallest other one.";
  return { id: "width", label: "Width", axis: "logarithm", coordinate, explanation, ...extentOf(count, coordinate) };
}

function category(id, label, categories, of, explanation) {
  return {
    id,
    label,
    axis: "category",
    categories,
    coordinate: (vertex) => of[vertex],
    explanation,
    least: 0,
    greatest: categories.length - 1,
  };
}

export function quantitiesOf(report) {
  const result = [
    bound(
      report,
      "lo",
      "Lower bound",
      report.lo,
      `Each vertex is proven to be at least this far from the ${report.solidName}; negative: it may be inside, but no deeper.`,
    ),
    bound(
      report,
      "hi",
      "Upper bound",
      report.hi,
      `Each vertex is proven to be at most this far from the ${report.solidName}; negative: surely inside it, at least so deep.`,
    ),
    width(report),
    category(
      "status",
      "Status",
      statusNames.map((name, k) => `${name}: ${statusMeanings[k]}`),
      report.status,
      "Who proved each interval.",
    ),
  ];
  if (report.areas) {
    result.push(
      category(
        "area",
        "Area",
        report.areas.names,
        report.areas.of,
        "The area of the bone that each vertex belongs to.",
      ),
    );
  }
  if (report.proof) {
    result.push(
      category(
        "proof",
        "Proven here",
        verdicts.map((name, k) => `${name}: ${verdictMeanings[k]}`),
        report.verdicts,
        "What this page's own checker says of each interval.",
      ),
    );
  }
  return result;
}
