/// Membership of a point in any model by MPFR at 200 bits and more, straight from the definitions of verisq/model.hpp.
#pragma once

#include <vector>
#include <verisq/model.hpp>

#include "tests/oracle/membership.hpp"
#include "tests/oracle/reference_distance.hpp"

namespace verisq::oracle {

/// The bend is undone by the exact inverse of its forward formula; no line is shared with verify/, kernels/ and the
/// proposals in double of PlacedPrimitive. Precondition of bends: |k| times the largest |r| below 1 - 2^-30.
class ExactMembership {
 public:
  explicit ExactMembership(const Model& model);

  /// `boundary` within a margin far above the rounding, some 2^-120 of the sizes.
  [[nodiscard]] Membership operator()(const Vector& point) const;
  [[nodiscard]] Membership in_primitive(std::size_t index, const Vector& point) const;

 private:
  struct Part {
    PosedSolid solid;
    Bend bend;
  };

  Model model_;
  std::vector<Part> parts_;
};

}  // namespace verisq::oracle
