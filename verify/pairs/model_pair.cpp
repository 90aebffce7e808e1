/// Of convex primitives every pair counts: the least of what spheres, vectors and points prove.
#include "verify/pairs/model_pair.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "verify/proof/intersection.hpp"

namespace verisq::verify {
namespace {

/// No bound is NaN: each has been through an interval, which holds none. Those of primitives that both models have,
/// with what `bound` says of each from below, and spheres of all others.
template <class ByVector>
double least_distance(const MovingPairs& moving, const PairCertificate& certificate, const ByVector& by_vector) {
  const std::size_t columns = moving.pairs().size_b();
  std::vector<double> lower;
  for (std::size_t i = 0; i < moving.pairs().size_a(); ++i) {
    for (std::size_t j = 0; j < columns; ++j) lower.push_back(moving.lower_by_spheres(i, j));
  }
  for (const Separation& separation : certificate.separations) {
    const auto [i, j] = std::pair<std::size_t, std::size_t>(separation.primitive_a, separation.primitive_b);
    if (i >= moving.pairs().size_a() || j >= columns) continue;
    double& least = lower[i * columns + j];
    least = std::max(least, by_vector(i, j, separation));
  }
  return std::max(0.0, std::ranges::min(lower));
}

}  // namespace

std::variant<ModelPair::Convex, ModelPair::Solids> ModelPair::models_of(const Model& a, const Model& b) {
  if (is_union_of_convex(a) && is_union_of_convex(b)) return Convex{PosedPrimitives(a), PosedPrimitives(b)};
  return Solids{SolidParts(a), SolidParts(b)};
}

ModelPair::ModelPair(const Model& a, const Model& b) : models_(models_of(a, b)) {}

Enclosure ModelPair::distance(const RigidMotion& pose, const PairCertificate& certificate) const {
  if (const auto* const solids = std::get_if<Solids>(&models_))
    return SolidPair(solids->a, solids->b, ShortMotion(pose)).at_moment(certificate);
  const auto& [a, b] = std::get<Convex>(models_);
  const MovingPairs resting(a, b, ShortMotion(pose));
  const PosedPairs& pairs = resting.pairs();
  if (certificate.common && pairs.share(*certificate.common)) return {0.0, 0.0};
  double upper = infinity;
  const double lower =
      least_distance(resting, certificate, [&](std::size_t i, std::size_t j, const Separation& separation) {
        const Enclosure proven = pairs(i, j).distance(separation);
        upper = std::min(upper, proven.hi);
        return proven.lo;
      });
  return between(lower, upper, [] { return "the distance of the models"; });
}

double ModelPair::lower(const ShortMotion& motion, const PairCertificate& certificate) const {
  if (const auto* const solids = std::get_if<Solids>(&models_))
    return std::max(0.0, SolidPair(solids->a, solids->b, motion).lower(certificate));
  const auto& [a, b] = std::get<Convex>(models_);
  const MovingPairs moving(a, b, motion);
  return least_distance(moving, certificate, [&](std::size_t i, std::size_t j, const Separation& separation) {
    return moving.lower_by_vector(i, j, separation.vector);
  });
}

}  // namespace verisq::verify
