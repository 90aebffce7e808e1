/// The distance of two unions of convex solids.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "verify/proof/pair_checker.hpp"

namespace verisq::verify {

// The pairs of primitives that may be the nearest of two models, found in nanoseconds each.

struct PrimitivePair {
  std::uint32_t a;
  std::uint32_t b;
};

struct NearPairs {
  std::vector<PrimitivePair> pairs;  ///< at least one
  double others;                     ///< proven: all others are at least so far apart
};

/// The pairs whose bounding spheres are not farther apart than the nearest centres, which lie in their primitives.
[[nodiscard]] NearPairs near_pairs(const PosedPairs& pairs);

// Lower bounds for pairs of primitives in one pose, kept for the poses that follow. Along a path few of many pairs are
// ever the nearest, and the distances of the others change by no more than their primitives move.

/// The place of a primitive of B in A's frame, in binary64.
struct Placement {
  std::array<double, 9> rotation;  ///< row by row
  Point centre;
  double radius;  ///< radius of a sphere about the centre that contains the primitive
  double size;    ///< magnitude of the numbers involved
  double width;   ///< by which the exact numbers may differ, beyond their rounding to binary64
};

[[nodiscard]] Placement placement_of(const PosedPairs& pairs, std::size_t j);

/// Upper bound of the distance of any point of the primitive from its former place. Rounded up.
[[nodiscard]] double displacement_up(const Placement& from, const Placement& to);

/// Lower bounds of the pairs of two models. Not for several threads at once.
class PairMemory {
 public:
  /// Forgets all unless the models have as many primitives as before.
  void look_at(const PosedPairs& pairs);

  /// Lower bound of the distance of a pair at B's present place; 0 if nothing is known. Precondition: `look_at`.
  [[nodiscard]] double lower(PrimitivePair pair) const;
  /// Precondition: `look_at`, and the pair is proven to be at least `lower` apart where B stands now.
  void keep(PrimitivePair pair, double lower);

  /// The last one that decided a distance, which is likely to decide the next.
  [[nodiscard]] std::optional<PrimitivePair> nearest() const { return nearest_; }
  void keep_nearest(PrimitivePair pair) { nearest_ = pair; }

 private:
  struct Known {
    double lower = 0.0;
    Placement at{};  ///< place of B's primitive for that bound
  };

  [[nodiscard]] std::size_t place(PrimitivePair pair) const { return pair.a * now_.size() + pair.b; }

  std::vector<Placement> now_;  // of B's primitives
  std::vector<Known> known_;
  std::optional<PrimitivePair> nearest_;
};

}  // namespace verisq::verify
