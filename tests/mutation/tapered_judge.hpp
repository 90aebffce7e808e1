/// Judges the kernels of tapered primitives, function by function and as a whole, against points of the surface that
/// are known by how they are made, at 200 bits: strictly, for what is a bound is one to the last digit.
#pragma once

#include <string>
#include <vector>
#include <verisq/model.hpp>

#include "tests/mutation/compiled_kernels.hpp"

namespace verisq::mutation {

class TaperedJudge {
 public:
  /// Draws operands and finds what is true of them.
  TaperedJudge();
  ~TaperedJudge();
  TaperedJudge(const TaperedJudge&) = delete;
  TaperedJudge& operator=(const TaperedJudge&) = delete;

  /// The true kernels, with one that shows what their functions claim.
  [[nodiscard]] static std::string sources();

  /// A first claim that is false; empty when all is well.
  [[nodiscard]] std::string false_claim(const CompiledKernels& kernels) const;

 private:
  struct KnownSolid;
  std::vector<KnownSolid> solids_;
};

}  // namespace verisq::mutation
