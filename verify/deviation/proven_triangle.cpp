/// Follows the halvings of a proof, piece by piece.
#include "verify/deviation/proven_triangle.hpp"

#include <algorithm>
#include <cmath>

#include "verify/numbers/rounding.hpp"
#include "verify/proof/intersection.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {

namespace {

constexpr Enclosure anything{-infinity, infinity};

/// One triangle's proof as it is followed.
class Walk {
 public:
  Walk(const Triangle& triangle, const TriangleProof& proof, const SampleProofs& proofs)
      : proof_(proof), proofs_(proofs), area_(area_of(triangle)), off_(displacement(triangle)) {}

  /// False where the proof ends before all of the triangle is told.
  [[nodiscard]] bool follow(const TrianglePiece& whole) {
    std::vector<TrianglePiece> open{whole};
    for (const PieceProof step : proof_.pieces) {
      if (open.empty()) return false;
      const TrianglePiece piece = open.back();
      open.pop_back();
      if (step == PieceProof::halved) {
        if (piece.halvings == most_halvings_of_piece || used_ == proof_.samples.size()) return false;
        const LongestSide side = longest_side(piece.corners);
        const auto parts = halves(piece, side, next(side.middle));
        open.insert(open.end(), {parts[1], parts[0]});
      } else if (!settle(piece, step == PieceProof::centre)) {
        return false;
      }
    }
    return open.empty();
  }

  [[nodiscard]] TriangleDistances found() const { return {largest_, cells_}; }

 private:
  /// At a point of the triangle to nearest: of the exact one.
  [[nodiscard]] Enclosure next(const Point& x) {
    const Enclosure proven = widened(proofs_.distance(x, proof_.samples[used_++]), off_);
    largest_ = std::max(largest_, magnitude(proven).lo);
    return proven;
  }

  [[nodiscard]] bool settle(TrianglePiece piece, bool with_centre) {
    const PieceShape shape = shape_of(piece.corners, off_);
    piece.convex = proofs_.convex;
    piece.at_centre = at_centre_by_corners(piece, shape);
    if (with_centre) {
      if (used_ == proof_.samples.size()) return false;
      const Point x = centre(piece.corners);
      const Certificate& certificate = proof_.samples[used_].certificate;
      piece.at_centre = intersection(piece.at_centre, next(x), [&] { return "the signed distance at " + text_of(x); });
      piece.convex = piece.convex || proofs_.is_one_convex(x, reach_of(piece.at_centre, shape, off_), certificate);
    }
    const PieceDistances distances = distances_on(piece, shape);
    const double share = std::ldexp(1.0, -piece.halvings);
    cells_.push_back({{multiply(area_.lo, share, Direction::down), multiply(area_.hi, share, Direction::up)},
                      distances.range,
                      distances.mean,
                      distances.affine});
    return true;
  }

  const TriangleProof& proof_;
  const SampleProofs& proofs_;
  Enclosure area_;
  double off_;
  std::size_t used_ = 0;  ///< samples
  double largest_ = 0.0;
  std::vector<WeightedCell> cells_;
};

}  // namespace

bool is_one_convex_primitive(const Model& model) {
  return model.primitives.size() == 1 && is_union_of_convex(model);
}

Enclosure at_centre_by_corners(const TrianglePiece& piece, const PieceShape& shape) {
  Enclosure result = anything;
  for (const Enclosure& at_corner : piece.at_corners) {
    const Enclosure reached = widened(at_corner, shape.radius);
    result = intersection(result, reached, [] { return "the signed distance at a triangle's centre"; });
  }
  return result;
}

/// A ball about any point x of the piece that reaches as far as the surface ends within d(c) + 2 radius of c.
double reach_of(const Enclosure& at_centre, const PieceShape& shape, double displacement) {
  const double radii = multiply(2.0, shape.radius, Direction::up);
  return add(add(magnitude(at_centre).hi, radii, Direction::up), displacement, Direction::up);
}

TriangleDistances distances_on(const Triangle& triangle, const std::array<Enclosure, 3>& at_corners,
                               const TriangleProof& proof, const SampleProofs& proofs) {
  Walk walk(triangle, proof, proofs);
  if (walk.follow({.corners = triangle, .triangle = 0, .at_corners = at_corners})) return walk.found();
  return {walk.found().largest, {{area_of(triangle), {0.0, infinity}, {0.0, infinity}}}};
}

}  // namespace verisq::verify
