/// Judges what bent_distance.cl is told of tapered solids before they are bent, against points of the surface that are
/// known by how they are made, at 200 bits.
#pragma once

#include <string>
#include <vector>

#include "tests/mutation/compiled_kernels.hpp"

namespace verisq::mutation {

class UnbentJudge {
 public:
  /// Draws operands and finds what is true of them.
  UnbentJudge();
  ~UnbentJudge();
  UnbentJudge(const UnbentJudge&) = delete;
  UnbentJudge& operator=(const UnbentJudge&) = delete;

  /// What shows the functions' claims, to be added to the kernels.
  [[nodiscard]] static std::string examination();

  /// A first claim that is false; empty when all is well.
  [[nodiscard]] std::string false_claim(const CompiledKernels& kernels) const;

 private:
  struct KnownSolid;
  std::vector<KnownSolid> solids_;
};

}  // namespace verisq::mutation
