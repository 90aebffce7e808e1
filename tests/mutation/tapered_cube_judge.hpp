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

  /// The true kernels of a search of one tapered primitive, with one that shows what is claimed about cubes.
  [[nodiscard]] static std::string sources();

  /// A first claim that is false; empty when all is well.
  [[nodiscard]] std::string false_claim(const CompiledKernels& kernels) const;

  /// Of all points beside the surface, the share for which a cube's colour, and that for which a half-space, is told.
  struct Shares {
    double colours, half_spaces;
  };
  [[nodiscard]] Shares shares(const CompiledKernels& kernels) const;

 private:
  struct KnownSolid;
  std::vector<KnownSolid> solids_;
};

}  // namespace verisq::mutation
