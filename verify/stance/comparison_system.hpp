/// Upper solutions of linear systems of differential inequalities u_i' <= sum of A_ij u_j + g_i whose couplings A_ij,
/// i != j, and g are not negative: Mueller's theorem, stiff or not (docs/stance.md §9).
#pragma once

#include <Eigen/Core>
#include <optional>

#include "verify/numbers/interval.hpp"

namespace verisq::stance {

/// |u(t)| between the two at the ends of a step, on straight lines.
struct UpperSolution {
  Eigen::VectorXd start, end;
};

/// For all u >= 0 with u(0) <= initial: u(t) <= start + (t/length) (end - start) for t in [0, length], proven. Nothing
/// where none is found. Preconditions: as above; `initial` not negative; `length` contains that of the step, above 0.
[[nodiscard]] std::optional<UpperSolution> upper_solution(const Eigen::MatrixXd& rate, const Eigen::VectorXd& forcing,
                                                          const Eigen::VectorXd& initial,
                                                          const verify::Interval& length);

}  // namespace verisq::stance
