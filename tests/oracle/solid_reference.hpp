/// The reference for any model: its signed distance between two proofs that share nothing with verify/ and kernels/.
#pragma once

#include <vector>
#include <verisq/model.hpp>

#include "tests/oracle/exact_membership.hpp"
#include "tests/oracle/placed_model.hpp"

namespace verisq::oracle {

/// `lower <= signed distance <= upper`, whatever the search found. |signed distance| is bounded from above by a point
/// that MPFR proves to lie in the solid (in its complement, where the query is inside), the nearest that dense sampling
/// and random search found; from below by an octree (clear_ball.hpp).
struct SolidFacts {
  Membership side;  ///< of the query, by MPFR
  Real lower;
  Real upper;
};

class SolidReference {
 public:
  /// Samples each primitive's boundary, just inside and just outside of it.
  explicit SolidReference(const Model& model);

  /// `budget` is the number of cubes for the octree; 0 leaves that bound 0.
  [[nodiscard]] SolidFacts facts(const Point& q, std::size_t budget) const;

  /// The nearest point found of the solid (Membership::inside) or of its complement, proven by MPFR to be in it; `q`
  /// itself where that is. Infinite coordinates where none was found.
  [[nodiscard]] Point nearest(const Point& q, Membership set) const;

  [[nodiscard]] const PlacedModel& placed() const { return placed_; }
  [[nodiscard]] const ExactMembership& exact() const { return exact_; }
  [[nodiscard]] double size() const { return placed_.bounding_ball().radius; }

  /// Points of the solid near its boundary, in double.
  [[nodiscard]] std::vector<Point> points_of_solid() const;

 private:
  struct Sample {
    Point point;
    std::size_t bin;  ///< primitive and octant of its own frame
  };
  [[nodiscard]] const std::vector<Sample>& samples(Membership set) const {
    return set == Membership::inside ? inside_ : outside_;
  }
  [[nodiscard]] std::vector<Point> starts(const Point& q, Membership set) const;
  /// The nearest to q that a search from `start`, a point of the set, finds.
  [[nodiscard]] Point polished(const Point& q, Membership set, const Point& start) const;

  PlacedModel placed_;
  ExactMembership exact_;
  std::vector<Sample> inside_;
  std::vector<Sample> outside_;
};

}  // namespace verisq::oracle
