/// Both models posed: convex primitives by their support functions and gauges, all others by sections and places.
#include "verisq/pair_checker.hpp"

#include <algorithm>
#include <utility>
#include <variant>
#include <vector>

#include "verify/pairs/solid_pair.hpp"
#include "verify/proof/intersection.hpp"
#include "verify/proof/judgement.hpp"
#include "verify/proof/posed_pairs.hpp"

namespace verisq {

namespace {

/// Minimum over all pairs of what spheres, vectors and points prove.
Enclosure proven_distance(const verify::PosedPairs& pairs, const PairCertificate& certificate) {
  if (certificate.common && pairs.share(*certificate.common)) return {0.0, 0.0};
  std::vector<double> lower;
  for (std::size_t i = 0; i < pairs.size_a(); ++i) {
    for (std::size_t j = 0; j < pairs.size_b(); ++j) lower.push_back(pairs.lower_by_spheres(i, j));
  }
  double upper = infinity;
  for (const Separation& separation : certificate.separations) {
    const auto [i, j] = std::pair<std::size_t, std::size_t>(separation.primitive_a, separation.primitive_b);
    if (i >= pairs.size_a() || j >= pairs.size_b()) continue;
    const Enclosure proven = pairs(i, j).distance(separation);
    double& least = lower[i * pairs.size_b() + j];
    least = std::max(least, proven.lo);
    upper = std::min(upper, proven.hi);
  }
  return verify::between(std::max(0.0, std::ranges::min(lower)), upper, [] { return "the distance of the models"; });
}

}  // namespace

struct PairChecker::State {
  template <class Parts>
  struct Two {
    Parts a, b;
  };

  State(const Model& a, const Model& b) {
    if (is_union_of_convex(a) && is_union_of_convex(b)) {
      models = Two<verify::PosedPrimitives>{verify::PosedPrimitives(a), verify::PosedPrimitives(b)};
    } else {
      models = Two<verify::SolidParts>{verify::SolidParts(a), verify::SolidParts(b)};
    }
  }

  [[nodiscard]] Enclosure prove(const Pose& pose, const PairCertificate& certificate) const {
    if (const auto* const convex = std::get_if<Two<verify::PosedPrimitives>>(&models)) {
      return proven_distance(verify::PosedPairs(convex->a, convex->b, pose), certificate);
    }
    const auto& [a, b] = std::get<Two<verify::SolidParts>>(models);
    return verify::SolidPair(a, b, pose).proven_distance(certificate);
  }

  std::variant<std::monostate, Two<verify::PosedPrimitives>, Two<verify::SolidParts>> models;
};

PairChecker::PairChecker(const Model& a, const Model& b) : state_(std::make_unique<State>(a, b)) {}
PairChecker::~PairChecker() = default;
PairChecker::PairChecker(PairChecker&&) noexcept = default;
PairChecker& PairChecker::operator=(PairChecker&&) noexcept = default;

Enclosure PairChecker::prove(const Pose& pose, const PairCertificate& certificate) const {
  return state_->prove(pose, certificate);
}

Finding PairChecker::operator()(const Pose& pose, const Enclosure& claimed, const PairCertificate& certificate) const {
  const Enclosure proven = prove(pose, certificate);
  return verify::judged(claimed, proven, proven);
}

}  // namespace verisq
