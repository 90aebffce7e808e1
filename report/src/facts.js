// What follows from the intervals of all vertices together: how many are outside, how many inside, how close the
// closest is.
import { element } from "./elements.js";
import { countText, enclosureText, shareText, withUnits } from "./numbers.js";

// The exact smallest distance lies between the smallest lower and the smallest upper end, for each vertex's distance
// lies between its own ends.
export function factsOf({ lo, hi, count }) {
  const facts = {
    outside: 0,
    inside: 0,
    undecided: 0,
    closest: 0,
    widest: 0,
    smallest: { lo: Infinity, hi: Infinity },
  };
  let width = -1;
  for (let vertex = 0; vertex < count; ++vertex) {
    if (lo[vertex] > 0) ++facts.outside;
    else if (hi[vertex] < 0) ++facts.inside;
    else ++facts.undecided;
    if (lo[vertex] < facts.smallest.lo) {
      facts.smallest.lo = lo[vertex];
      facts.closest = vertex;
    }
    if (hi[vertex] < facts.smallest.hi) facts.smallest.hi = hi[vertex];
    if (hi[vertex] - lo[vertex] > width) {
      width = hi[vertex] - lo[vertex];
      facts.widest = vertex;
    }
  }
  return facts;
}

export function sideOf(lo, hi) {
  if (lo > 0) return "outside";
  return hi < 0 ? "inside" : "undecided";
}

function tally(name, count, whole, meaning) {
  return element(
    "div",
    { class: `fact ${name}`, title: meaning },
    element("dt", {}, name === "undecided" ? name : `proven ${name}`),
    element("dd", {}, countText(count), element("small", {}, shareText(count, whole))),
  );
}

export function fillFacts(list, facts, { count, units }) {
  const { lo, hi } = facts.smallest;
  list.replaceChildren(
    tally("outside", facts.outside, count, "lower bound above 0"),
    tally("inside", facts.inside, count, "upper bound below 0"),
    tally("undecided", facts.undecided, count, "the interval contains 0"),
    element(
      "div",
      { class: "fact whole" },
      element("dt", {}, "smallest signed distance of all vertices lies in"),
      element("dd", {}, count ? withUnits(enclosureText(lo, hi), units) : "(no vertices)"),
    ),
  );
}

export function statement({ count, units, solidName, path }) {
  return (
    `For each of the ${countText(count)} vertices of the bone, the exact ${path ? "smallest " : ""}signed distance to ` +
    `the ${solidName} ${path ? "along its whole way in " : ""}` +
    `(positive outside, negative inside${units ? `, in ${units}` : ""}) is proven to lie in the vertex's interval ` +
    "[lo, hi]; colours between vertices are interpolated and prove nothing."
  );
}
