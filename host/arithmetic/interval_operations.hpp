/// The interval operations of kernels/interval.clh and kernels/inverse_tangent.clh: the exact range of each, and how
/// tight the kernels promise to be.
#pragma once

#include <span>
#include <string>

#include "host/arithmetic/sample_operands.hpp"
#include "verify/numbers/rounding.hpp"

namespace verisq::device {

struct IntervalOperation {
  const char* name;
  int operands;               ///< 1 or 2: an operation of one ignores `b`
  Domain a_domain, b_domain;  ///< where sampled operands come from
  bool (*applies)(Ends a);    ///< whether the operation's precondition holds

  /// The exact range over nonempty a and b, its lower end rounded in the direction `lower`, its upper end in the
  /// opposite one: the tightest enclosure for Direction::down. Empty where the operation is defined nowhere.
  Ends (*range)(Ends a, Ends b, verify::Direction lower);

  /// How far outside the end `tightest` of the range over a and b the kernels' end may lie; infinite where they promise
  /// containment alone.
  double (*slack)(Ends a, Ends b, double tightest);
};

/// In the order of `apply_interval_operation` in kernels/self_test.cl.
[[nodiscard]] std::span<const IntervalOperation> interval_operations();

/// The range over any a and b: empty operands give an empty result, but for the hull, where they are neutral.
[[nodiscard]] Ends range_of(const IntervalOperation& operation, const IntervalOperands& operands,
                            verify::Direction lower = verify::Direction::down);

/// What is wrong with `result` as an enclosure of the nonempty or empty `range` over these operands: "misses" where it
/// does not contain it, "too wide" beyond the promised slack, nothing where all is well.
[[nodiscard]] std::string fault(const IntervalOperation& operation, const IntervalOperands& operands, Ends range,
                                Ends result);

}  // namespace verisq::device
