// Trees of set operations as unions and intersections alone, with what is known of their primitives
// (docs/mathematics.md, section 11): "outside" and "inside" are strict, so that a set and the closure of its complement
// exchange them.

export const outside = "outside";
export const inside = "inside";
export const open = "open"; // not decided

const opposite = { [outside]: inside, [inside]: outside, [open]: open };

// A leaf { primitive, isComplement } is a primitive or the closure of its complement; a node { isUnion, operands }.
// Of the set, or of the closure of its complement, where `set` is the index of a primitive or { operation, operands }.
export function normalForm(set, isComplement = false) {
  if (typeof set === "number") return { primitive: set, isComplement };
  const { operation, operands } = set;
  const isRemoved = (k) => operation === "difference" && k > 0;
  return {
    isUnion: (operation === "union") !== isComplement,
    operands: operands.map((operand, k) => normalForm(operand, isComplement !== isRemoved(k))),
  };
}

export const isLeaf = (node) => node.operands === undefined;

// Where a region lies with respect to the node's set, from where it lies with respect to each primitive.
export function placeOf(node, places) {
  if (isLeaf(node)) return node.isComplement ? opposite[places[node.primitive]] : places[node.primitive];
  const deciding = node.isUnion ? inside : outside;
  let result = opposite[deciding];
  for (const operand of node.operands) {
    const found = placeOf(operand, places);
    if (found === deciding) return deciding;
    if (found === open) result = open;
  }
  return result;
}
