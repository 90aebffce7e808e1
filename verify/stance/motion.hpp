/// Motions of a body that is pushed, and when it changes its contacts.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "verify/stance/controlled_motion.hpp"
#include "verify/stance/error_bound.hpp"

namespace verisq::stance {

// Where an approximate motion leaves the branches that it is computed in: steps end there, so that each polynomial
// lies on one side of a kink. Nothing here has to be right.

namespace switch_details {

/// Above 0 as long as the branches of a regime hold, in an order of its own for each regime.
[[nodiscard]] inline std::vector<double> margins(const MotionRegime& regime, const MotionTerms<double>& terms) {
  std::vector<double> result;
  const auto add = [&](Side side, double value) {
    if (side != Side::open) result.push_back(side == Side::above ? value : -value);
  };
  for (std::size_t c = 0; c < regime.contacts.size(); ++c) {
    const ContactBranches& branches = regime.contacts[c];
    const ContactSwitches<double>& at = terms.contacts[c].switches;
    add(branches.penetration, at.penetration);
    if (branches.penetration == Side::below) continue;
    add(branches.damping, at.damping);
    if (branches.in_flight()) continue;
    const bool forward = branches.friction == FrictionBranch::slips_forward;
    const bool backward = branches.friction == FrictionBranch::slips_backward;
    if (forward || branches.friction == FrictionBranch::sticks)
      result.push_back(forward ? at.friction - at.limit : at.limit - at.friction);
    if (backward || branches.friction == FrictionBranch::sticks)
      result.push_back(backward ? -at.limit - at.friction : at.limit + at.friction);
  }
  return result;
}

template <class System>
[[nodiscard]] MotionTerms<double> terms_at(const System& system, const Eigen::VectorXd& state, double time,
                                           const MotionRegime& regime) {
  const MotionPoint<double> at = collocation_details::point(
      state, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(system.implicit())), time, regime, system.deviations());
  return system.template evaluate<double>(at.state, at.acceleration, at.time, at.regime, at.deviations);
}

/// At t in [-1, 1] of a step, or a little beyond.
template <class System>
[[nodiscard]] std::vector<double> margins_at(const System& system, const MotionPolynomial& step,
                                             const MotionRegime& regime, double t) {
  const double time = step.from + 0.5 * (t + 1.0) * (step.to - step.from);
  return margins(regime, terms_at(system, Eigen::VectorXd(step.state * RadauRule::powers(t)), time, regime));
}

/// The polynomial over [from, to], in t from -1 to 1 again.
[[nodiscard]] inline MotionPolynomial part_of(const MotionPolynomial& step, double from, double to) {
  const double length = step.to - step.from;
  const double middle = ((from - step.from) + (to - step.to)) / length;
  const double half = (to - from) / length;
  const auto restricted = [&](const Eigen::MatrixXd& polynomial) {
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(polynomial.rows(), polynomial.cols());
    for (Eigen::Index power = polynomial.cols(); power-- > 0;) {  // Horner's rule in middle + half t
      Eigen::MatrixXd next = middle * result;
      next.rightCols(result.cols() - 1) += half * result.leftCols(result.cols() - 1);
      next.col(0) += polynomial.col(power);
      result = next;
    }
    return result;
  };
  MotionPolynomial result{from, to, restricted(step.state), {}, {}};
  for (const Eigen::MatrixXd& part : step.by_deviation) result.by_deviation.push_back(restricted(part));
  for (const Eigen::MatrixXd& part : step.by_pair) result.by_pair.push_back(restricted(part));
  return result;
}

}  // namespace switch_details

/// How deep the lowest point of each contact is below the ground at a state.
template <class System>
[[nodiscard]] std::vector<double> penetrations_at(const System& system, const Eigen::VectorXd& state) {
  std::vector<double> result;
  for (const auto& contact : switch_details::terms_at(system, state, 0.0, MotionRegime{0.0}).contacts)
    result.push_back(contact.switches.penetration);
  return result;
}

/// The branches at one state.
template <class System>
[[nodiscard]] MotionRegime regime_at(const System& system, const Eigen::VectorXd& state, double time, double within) {
  return system.settled(switch_details::terms_at(system, state, time, MotionRegime{within}), within);
}

/// The first time of a step at which branches end that hold at its beginning.
template <class System>
[[nodiscard]] std::optional<double> first_switch(const System& system, const MotionPolynomial& step,
                                                 const MotionRegime& regime) {
  using namespace switch_details;
  constexpr int samples = 16;
  constexpr int halvings = 50;
  const std::vector<double> at_start = margins_at(system, step, regime, -1.0);
  const auto crossed = [&](double t) {
    const std::vector<double> now = margins_at(system, step, regime, t);
    for (std::size_t i = 0; i < now.size(); ++i) {
      if (at_start[i] > 0.0 && !(now[i] > 0.0)) return true;
    }
    return false;
  };
  double before = -1.0;
  for (int i = 1; i <= samples; ++i) {
    double after = 2.0 * i / samples - 1.0;
    if (!crossed(after)) {
      before = after;
      continue;
    }
    for (int k = 0; k < halvings; ++k) {
      const double middle = 0.5 * (before + after);
      (crossed(middle) ? after : before) = middle;
    }
    return step.from + 0.5 * (after + 1.0) * (step.to - step.from);
  }
  return std::nullopt;
}

/// A time within which a switch lies for all motions that are followed.
struct SwitchWindow {
  double from, to;
};

/// About the switch at `time`: as narrow as errors of the size of `errors` allow branches to be settled up to it.
template <class System>
[[nodiscard]] SwitchWindow switch_window(const System& system, const MotionPolynomial& step, double time,
                                         const Eigen::VectorXd& errors) {
  constexpr double narrowest = 1e-13;
  constexpr double wider = 4.0;
  const double distance = time - step.from;
  double width = std::max(narrowest, 16.0 * std::numeric_limits<double>::epsilon() * time);
  while (width < 0.25 * distance) {
    const MotionPolynomial before = switch_details::part_of(step, time - 2.0 * width, time - width);
    if (settled_regime(system, before, errors).is_settled()) return {time - width, time + width};
    width *= wider;
  }
  return {step.from, time + width};
}

// The terms of second order in the parameters' deviations of an approximate motion: what the residual of the first
// order leaves, integrated. Nothing here has to be right.

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
