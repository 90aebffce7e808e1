/// The table of mutants of bent_depth.clh, and of the lines of bent_distance.cl for points inside.
#include <array>

#include "tests/mutation/mutant.hpp"

namespace verisq::mutation {
namespace {

constexpr std::array mutants{
    Mutant{"ball, eta not squared twice", "div_up(dot_up(eta, eta), excess)", "REAL(0.0)"},
};

}  // namespace

std::span<const Mutant> depth_mutants() {
  return mutants;
}

}  // namespace verisq::mutation
