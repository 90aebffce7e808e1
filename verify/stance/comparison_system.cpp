/// Straight lines, found by Gauss and Seidel's iteration in floating point and then checked.
#include "verify/stance/comparison_system.hpp"

#include <cmath>

#include "verify/stance/contraction.hpp"

namespace verisq::stance {
namespace {

using verify::Interval;

struct Line {
  double start, end;
};

/// For u' <= rate u + b, b being `at_start` and `at_end` at the ends.
Line lowest_line(double rate, double at_start, double at_end, double initial, double length) {
  const double change = rate * length;
  // A line through the initial value that is steep enough at both ends.
  const double steep = initial + length * (rate * initial + at_start);
  const double implicit = change < 1.0 ? (initial + length * at_end) / (1.0 - change) : infinity;
  const Line through{initial, std::fmax(std::fmax(steep, implicit), 0.0)};
  if (!(change < -1.0)) return through;
  // A stiff component is soon where its rate and b are in balance: it may start there.
  const double balanced = (at_start * (1.0 - change) - at_end) / (change * rate);
  const double start = std::fmax(initial, balanced);
  const Line from_balance{start, std::fmax((start + length * at_end) / (1.0 - change), 0.0)};
  return through.end <= from_balance.end ? through : from_balance;
}

/// d/dt of the lines >= A u + g at both ends, and so, both sides being linear in t, everywhere: by Mueller's theorem no
/// solution crosses them (Walter, Ordinary Differential Equations, §10).
bool is_upper(const UpperSolution& lines, const Eigen::MatrixXd& rate, const Eigen::VectorXd& forcing,
              const Eigen::VectorXd& initial, const Interval& length) {
  for (Eigen::Index i = 0; i < rate.rows(); ++i) {
    if (!(lines.start[i] >= initial[i] && lines.end[i] >= 0.0 && std::isfinite(lines.end[i]))) return false;
    const double slope = ((Interval(lines.end[i]) - Interval(lines.start[i])) / length).lower();
    for (const Eigen::VectorXd* u : {&lines.start, &lines.end}) {
      Interval needed(forcing[i]);
      for (Eigen::Index j = 0; j < rate.cols(); ++j) {
        if (rate(i, j) != 0.0) needed += Interval(rate(i, j)) * Interval((*u)[j]);
      }
      if (!(slope >= needed.upper())) return false;
    }
  }
  return true;
}

}  // namespace

std::optional<UpperSolution> upper_solution(const Eigen::MatrixXd& rate, const Eigen::VectorXd& forcing,
                                            const Eigen::VectorXd& initial, const Interval& length) {
  constexpr int most_sweeps = 200;
  if (!rate.allFinite() || !forcing.allFinite() || !initial.allFinite()) return std::nullopt;
  for (const double slack : {1e-9, 1e-6, 1e-3}) {
    UpperSolution lines{initial, initial};
    for (int sweep = 0; sweep < most_sweeps; ++sweep) {
      double greatest_change = 0.0;
      for (Eigen::Index i = 0; i < rate.rows(); ++i) {
        const double own = rate(i, i) + slack * std::fabs(rate(i, i)) + 1e-12;
        const double off_start = rate.row(i).dot(lines.start) - rate(i, i) * lines.start[i] + forcing[i];
        const double off_end = rate.row(i).dot(lines.end) - rate(i, i) * lines.end[i] + forcing[i];
        const double more = (1.0 + slack);
        const Line line =
            lowest_line(own, more * off_start + 1e-290, more * off_end + 1e-290, initial[i], length.upper());
        const double change = std::fabs(line.end - lines.end[i]) + std::fabs(line.start - lines.start[i]);
        greatest_change = std::fmax(greatest_change, change / (line.end + line.start + 1e-290));
        lines.start[i] = line.start;
        lines.end[i] = line.end;
      }
      if (!(lines.end.lpNorm<Eigen::Infinity>() < 1e100)) break;
      if (greatest_change < 0.1 * slack) break;
    }
    if (is_upper(lines, rate, forcing, initial, length)) return lines;
  }
  return std::nullopt;
}

}  // namespace verisq::stance
