/// The checker of points has the word; of unions spheres and normals say which primitives are near.
#include "verify/deviation/proven_samples.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <variant>

#include "verify/proof/convex_union.hpp"

namespace verisq::verify {

ProvenSamples::ProvenSamples(const Model& model)
    : model_(model),
      checker_(model),
      primitives_(model),
      is_union_(verify::is_union(model)),
      convex_(is_one_convex_primitive(model)) {}

Enclosure ProvenSamples::distance(const Point& x, const CertifiedEnclosure& claimed, bool& proved) const {
  const Finding finding = checker_(x, claimed.distance, claimed.certificate);
  proved = finding.verdict == Verdict::proved;
  return proved ? claimed.distance : finding.proven;
}

/// The others are farther, by spheres and normals.
bool ProvenSamples::is_one_convex(const Point& x, double reach, const Certificate& certificate) const {
  if (!is_union_ || !std::isfinite(reach)) return false;
  std::size_t near = 0;
  bool convex_one = false;
  const std::span<const PosedPrimitive> all = primitives_.primitives();
  for (std::uint32_t i = 0; i < all.size(); ++i) {
    double lower = std::visit([&](const auto& solid) { return solid.lower_by_sphere(x); }, all[i]);
    for (const auto& [primitive, v] : certificate.normals) {
      if (primitive == i) lower = std::max(lower, lower_by_normal(all[i], x, {v[0], v[1], v[2]}));
    }
    if (lower >= reach) continue;
    ++near;
    convex_one = std::holds_alternative<PosedSuperquadric>(all[i]);
  }
  return near == 1 && convex_one;
}

bool ProvenSamples::are_others_away(const Point& x, double reach, std::size_t primitive,
                                    const Certificate& certificate) const {
  if (!std::isfinite(reach)) return false;
  const double beyond = std::nextafter(reach, infinity);  // the ball lies in the interior
  const std::span<const PosedPrimitive> all = primitives_.primitives();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i == primitive || std::visit([&](const auto& solid) { return solid.lower_by_sphere(x); }, all[i]) > reach)
      continue;
    const bool is_away = std::ranges::any_of(certificate.normals, [&](const Normal& normal) {
      const Proposal v{normal.vector[0], normal.vector[1], normal.vector[2]};
      if (normal.primitive != i) return false;
      if (lower_by_normal(all[i], x, v) > reach) return true;
      return !is_union_ &&
             std::visit([&](const auto& solid) { return solid.contains_ball_about(x, beyond, v); }, all[i]);
    });
    if (!is_away) return false;
  }
  return true;
}

Enclosure SampleTally::operator()(const Point& x, const CertifiedEnclosure& claimed) {
  bool proved = false;
  const Enclosure found = samples_.distance(x, claimed, proved);
  ++looked_at_;
  if (!proved) ++unproved_;
  return found;
}

SampleProofs SampleTally::proofs() {
  return {[this](const Point& x, const CertifiedEnclosure& claimed) { return (*this)(x, claimed); },
          [this](const Point& x, double reach, const Certificate& of) { return samples_.is_one_convex(x, reach, of); },
          samples_.convex()};
}

}  // namespace verisq::verify
