/// The distance of two unions of convex solids.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "verify/proof/pair_checker.hpp"

namespace verisq::verify {

// Which pairs of primitives may be the nearest of two models, at a price of nanoseconds each.

struct PrimitivePair {
  std::uint32_t a;
  std::uint32_t b;
};

struct NearPairs {
  std::vector<PrimitivePair> pairs;  ///< at least one
  double others;                     ///< proven: all others are at least so far apart
};

/// Those whose bounding spheres are not farther apart than the nearest centres, which lie in their primitives.
[[nodiscard]] NearPairs near_pairs(const PosedPairs& pairs);

// What was proven of pairs of primitives in one pose, for the poses that follow: along a path few of many pairs are
// ever the nearest, and how far the others are changes by no more than they move.

/// Where a primitive of B stands in A's frame, in binary64.
struct Placement {
  std::array<double, 9> rotation;  ///< row by row
  Point centre;
  double radius;  ///< of a sphere about it that contains the primitive
  double size;    ///< of the numbers at hand
  double width;   ///< by which the exact ones may differ, beyond their rounding to binary64
};

[[nodiscard]] Placement placement_of(const PosedPairs& pairs, std::size_t j);

/// No point of the primitive is farther from where it was. Rounded up.
[[nodiscard]] double displacement_up(const Placement& from, const Placement& to);

/// Of the pairs of two models. Not for several threads at once.
class PairMemory {
 public:
  /// Forgets all unless the models have as many primitives as before.
  void look_at(const PosedPairs& pairs);

  /// Lower bound of the distance of a pair where B stands now; 0 where nothing is known. Precondition: `look_at`.
  [[nodiscard]] double lower(PrimitivePair pair) const;
  /// Precondition: `look_at`, and the pair is proven to be at least `lower` apart where B stands now.
  void keep(PrimitivePair pair, double lower);

  /// The last one that decided a distance, which is likely to decide the next.
  [[nodiscard]] std::optional<PrimitivePair> nearest() const { return nearest_; }
  void keep_nearest(PrimitivePair pair) { nearest_ = pair; }

 private:
  struct Known {
    double lower = 0.0;
    Placement at{};  ///< of B's primitive then
  };

  [[nodiscard]] std::size_t place(PrimitivePair pair) const { return pair.a * now_.size() + pair.b; }

  std::vector<Placement> now_;  // of B's primitives
  std::vector<Known> known_;
  std::optional<PrimitivePair> nearest_;
};

}  // namespace verisq::verify
