/// Runs a distance program along its central path: in double as far as that carries, at 200 bits to the end.
#pragma once

#include <functional>
#include <vector>

#include "tests/oracle/central_path.hpp"

namespace verisq::oracle {

/// A point of the central path: the variables, and roughly how far those of the optimum are from them.
struct PathPoint {
  std::vector<Real> variables;
  std::vector<Real> outstanding;
};

/// The same program in both number types, made by calling a generic `fill` on each.
struct TwoPrograms {
  DistanceProgram<double> rough;
  DistanceProgram<Real> exact;
};

/// Calls `finished` at points of the path, ever closer to the optimum, until it returns true or the precision of 200
/// bits ends. `size` is the length by which mu is measured; the last points have mu of 1e-32 of it.
void follow_path(const TwoPrograms& programs, const Real& size, const std::function<bool(const PathPoint&)>& finished);

}  // namespace verisq::oracle
