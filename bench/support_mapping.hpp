/// The support mapping ∇h of a superquadric in plain floating point (docs/mathematics.md §1): what GJK sees of a solid.
#pragma once

#include <verisq/model.hpp>

namespace verisq::bench {

class SupportMapping {
 public:
  /// Precondition: exponents below 2 (their conjugates are finite).
  explicit SupportMapping(const Superquadric& solid);

  /// The point of the solid that lies farthest in `direction`. Precondition: direction not zero.
  [[nodiscard]] Point operator()(const Point& direction) const;

 private:
  Point semi_axes_;
  double section_conjugate_;  // q2 = 2 / (2 - e2)
  double profile_conjugate_;  // q1 = 2 / (2 - e1)
};

}  // namespace verisq::bench
