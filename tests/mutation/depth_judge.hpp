/// Judges the kernels' lemmas of points inside bent primitives, each on its own, and the depths that come out of them.
#pragma once

#include <string>

#include "tests/mutation/compiled_kernels.hpp"
#include "tests/mutation/depth_cases.hpp"

namespace verisq::mutation {

class DepthJudge {
 public:
  /// Of solids some of which are tapered, by the kernels for such, or of none.
  explicit DepthJudge(Tapers tapers);

  /// The true kernels, with some that show what each lemma claims.
  [[nodiscard]] std::string sources() const;

  /// A first claim that is false; empty when all is well.
  [[nodiscard]] std::string false_claim(const CompiledKernels& kernels) const;

  /// How much is claimed of what might be: where that is little, nothing is judged.
  struct Shares {
    double metrics;  ///< that are valid
    double balls;    ///< claimed by the gauge, of those not known to reach outside; none with tapers
    double balls_by_profile;
    double depths;  ///< claimed from both sides to 1e-9, of those known to it
  };
  [[nodiscard]] Shares shares(const CompiledKernels& kernels) const;

 private:
  Tapers tapers_;
  DepthSolids solids_;
  DepthCases cases_;
};

}  // namespace verisq::mutation
