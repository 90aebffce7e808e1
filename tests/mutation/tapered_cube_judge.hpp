/// Judges what the kernels claim about tapered primitives in cubes: colours and half-spaces, against points beside the
/// surface whose place is known at 200 bits.
#pragma once

#include <string>
#include <vector>

#include "tests/mutation/compiled_kernels.hpp"

namespace verisq::mutation {

class TaperedCubeJudge {
 public:
  /// Draws cubes and points of them.
  TaperedCubeJudge();
  ~TaperedCubeJudge();
  TaperedCubeJudge(const TaperedCubeJudge&) = delete;
  TaperedCubeJudge& operator=(const TaperedCubeJudge&) = delete;

  /// The true layers for one tapered primitive, with a kernel that shows what they claim about cubes.
  [[nodiscard]] static std::string sources();

  /// A first claim that is false; empty when all is well.
  [[nodiscard]] std::string false_claim(const CompiledKernels& kernels) const;

  /// Of points hardly beside the surface, the share whose colour is told, and of cubes with such a point that for which
  /// a half-space is.
  struct Shares {
    double colours, half_spaces;
  };
  [[nodiscard]] Shares shares(const CompiledKernels& kernels) const;

 private:
  struct KnownSolid;
  std::vector<KnownSolid> solids_;
};

}  // namespace verisq::mutation
