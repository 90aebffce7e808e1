/// Judges the functions of the kernels that bound a number, one by one, against what they bound.
#pragma once

#include <string>
#include <vector>

#include "tests/mutation/compiled_kernels.hpp"

namespace verisq::mutation {

/// Entry points for BoundJudge, to be appended to the kernels' sources before they are compiled.
[[nodiscard]] std::string with_bound_kernel(const std::string& sources);

class BoundJudge {
 public:
  /// Draws operands and computes what the bounds of them bound, to long double.
  BoundJudge();
  ~BoundJudge();
  BoundJudge(const BoundJudge&) = delete;
  BoundJudge& operator=(const BoundJudge&) = delete;

  /// The first bound that lies on the wrong side of what it bounds, by more than the reference's error, and its
  /// operands; empty when all is well. Only the pessimistic arithmetics make this a sharp test. `kernels` are compiled
  /// from `with_bound_kernel`.
  [[nodiscard]] std::string operator()(const CompiledKernels& kernels) const;

 private:
  struct Samples;
  struct PointsInside;

  /// The first point inside a tapered solid that is said to lie outside; empty when all is well.
  [[nodiscard]] std::string false_separation(const CompiledKernels& kernels) const;

  std::vector<Samples> samples_;       ///< of each solid
  std::vector<PointsInside> tapered_;  ///< of each tapered solid
};

}  // namespace verisq::mutation
