/// What signed distances at points of a triangle, each of them proven, say of all of its points (docs/mathematics.md
/// §20).
#pragma once

#include <functional>
#include <vector>

#include "verify/deviation/triangle_piece.hpp"
#include "verify/deviation/weighted_cells.hpp"
#include "verisq/deviation_certificate.hpp"

namespace verisq::verify {

/// Who tells what of a model is proven.
struct SampleProofs {
  /// The signed distance at a point, whatever is claimed.
  std::function<Enclosure(const Point& x, const CertifiedEnclosure& claimed)> distance;
  /// Whether all of the model that is nearer to the point than `reach` is one convex primitive, by the normals of the
  /// certificate.
  std::function<bool(const Point& x, double reach, const Certificate& certificate)> is_one_convex;
  bool convex;  ///< the model is one convex primitive
};

[[nodiscard]] bool is_one_convex_primitive(const Model& model);

struct TriangleDistances {
  double largest = 0.0;             ///< no less than this, at a sample
  std::vector<WeightedCell> cells;  ///< distances to the surface, on all of its parts, by area
};

/// What the corners' signed distances tell of that of the centroid, which is 1-Lipschitz.
[[nodiscard]] Enclosure at_centre_by_corners(const TrianglePiece& piece, const PieceShape& shape);

/// How far the primitives are looked for that decide distances on a piece, from its centroid as it is rounded.
[[nodiscard]] double reach_of(const Enclosure& at_centre, const PieceShape& shape, double displacement);

/// A proof that is cut short, or has too few samples, says nothing of the whole triangle.
[[nodiscard]] TriangleDistances distances_on(const Triangle& triangle, const std::array<Enclosure, 3>& at_corners,
                                             const TriangleProof& proof, const SampleProofs& proofs);

}  // namespace verisq::verify
