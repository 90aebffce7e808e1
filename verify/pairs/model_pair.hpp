/// Two models of any kind, the second of which is moved, or moves: what a certificate proves of their distance.
#pragma once

#include <variant>

#include "verify/pairs/moving_pairs.hpp"
#include "verify/pairs/solid_pair.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/pair_certificate.hpp"

namespace verisq::verify {

/// Convex primitives by their support functions and gauges, all others by sections and places. Immutable.
class ModelPair {
 public:
  ModelPair(const Model& a, const Model& b);

  /// As PairChecker::prove, of B where `pose` moves it.
  [[nodiscard]] Enclosure distance(const RigidMotion& pose, const PairCertificate& certificate) const;

  /// The distance is no less at any time of B's motion. Rounded down; at least 0.
  [[nodiscard]] double lower(const ShortMotion& motion, const PairCertificate& certificate) const;

 private:
  template <class Parts>
  struct Two {
    Parts a, b;
  };
  using Convex = Two<PosedPrimitives>;
  using Solids = Two<SolidParts>;

  static std::variant<Convex, Solids> models_of(const Model& a, const Model& b);

  std::variant<Convex, Solids> models_;
};

}  // namespace verisq::verify
