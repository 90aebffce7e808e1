/// The terms of second order in the parameters' deviations of an approximate motion: what the residual of the first
/// order leaves, integrated. Nothing here has to be right.
#pragma once

#include "verify/stance/error_bound.hpp"

namespace verisq::stance {

namespace second_order_details {

/// At a node, of the terms by the `pair`-th product of deviations.
[[nodiscard]] inline double value_at(const DefectModel& model, std::size_t pair, double t) {
  if (pair >= model.rows(2).size()) return 0.0;
  double sum = 0.0;
  const DefectModel::Row& row = model.rows(2)[pair];
  for (std::size_t i = row.size(); i-- > 0;) sum = sum * t + 0.5 * row[i].lower() + 0.5 * row[i].upper();
  return sum;
}

}  // namespace second_order_details

/// Fills in step.by_pair, by the same collocation.
template <class System>
void add_second_order(const System& system, const RadauRule& rule, const ApproximateState& start,
                      const MotionRegime& regime, MotionPolynomial& step) {
  using namespace second_order_details;
  const std::size_t pairs = system.deviations() * (system.deviations() + 1) / 2;
  if (pairs == 0) return;
  constexpr Eigen::Index stages = RadauRule::stages;
  const auto n = step.state.rows();
  const auto m = static_cast<Eigen::Index>(system.implicit());
  const double half = 0.5 * (step.to - step.from);
  const double middle = step.from + half;
  const MotionPoint<DefectModel> first_order = motion_point<DefectModel>(system, step, {}, regime);
  const auto left = system.template evaluate<DefectModel>(first_order.state, first_order.acceleration, first_order.time,
                                                          first_order.regime, first_order.deviations);
  Eigen::MatrixXd newton = Eigen::MatrixXd::Identity(n * stages, n * stages);
  Eigen::MatrixXd forcing(n * stages, static_cast<Eigen::Index>(pairs));
  for (Eigen::Index j = 0; j < stages; ++j) {
    const double t = rule.node(j);
    const ApproximateRates at =
        approximate_derivatives(system, Eigen::VectorXd(step.state * RadauRule::powers(t)), middle + half * t, regime);
    Eigen::MatrixXd terms(n, static_cast<Eigen::Index>(pairs));
    for (Eigen::Index k = 0; k < terms.cols(); ++k) {
      for (Eigen::Index i = 0; i < n; ++i) {
        const auto pair = static_cast<std::size_t>(k);
        terms(i, k) = i < m ? -value_at(left.residual[static_cast<std::size_t>(i)], pair, t)
                            : value_at(left.rates[static_cast<std::size_t>(i - m)], pair, t);
      }
    }
    terms.topRows(m) = at.inverse_mass * terms.topRows(m);
    forcing.middleRows(n * j, n) = terms + at.by_state * start.by_pair;
    for (Eigen::Index l = 0; l < stages; ++l)
      newton.block(n * j, n * l, n, n) -= half * rule.weights()(j, l) * at.by_state;
  }
  const Eigen::MatrixXd rates = newton.partialPivLu().solve(forcing);
  for (Eigen::Index k = 0; k < rates.cols(); ++k) {
    const Eigen::MatrixXd of_stages = rates.col(k).reshaped(n, stages);
    step.by_pair.emplace_back(half * of_stages * rule.integrals());
    step.by_pair.back().col(0) += start.by_pair.col(k);
  }
}

}  // namespace verisq::stance
