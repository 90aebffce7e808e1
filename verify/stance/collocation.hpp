/// Collocation of a motion, and its derivatives.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "verify/stance/scalar.hpp"

namespace verisq::stance {

// Which branches of piecewise equations hold: what is settled of a set of points, or chosen for an approximation.

/// Of a switch at 0; what is open is decided, or the hull taken, where it is evaluated.
enum class Side : std::uint8_t { open, below, above };

/// Slips: towards x or against it.
enum class FrictionBranch : std::uint8_t { open, sticks, slips_forward, slips_backward };

/// Of one contact.
struct ContactBranches {
  Side penetration = Side::open;  ///< above 0, the cylinder touches
  Side damping = Side::open;      ///< of 1 + D delta'/v_N: below 0, the ground cannot follow and does not push
  FrictionBranch friction = FrictionBranch::open;

  [[nodiscard]] bool in_flight() const { return penetration == Side::below || damping == Side::below; }
  [[nodiscard]] bool is_settled() const {
    return in_flight() || (penetration == Side::above && damping == Side::above && friction != FrictionBranch::open);
  }
  friend bool operator==(const ContactBranches&, const ContactBranches&) = default;
};

struct MotionRegime {
  double within;                               ///< a time between the same breaks
  std::vector<ContactBranches> contacts = {};  ///< of each contact; empty: all open

  [[nodiscard]] bool is_settled() const {
    return std::all_of(contacts.begin(), contacts.end(), [](const ContactBranches& c) { return c.is_settled(); });
  }
};

// All partial derivatives of a system of equations of motion, a few at a time.

/// M(state) a + ... = 0 for the rates a of the first `implicit()` components of the state, explicit rates of the
/// others:
///   std::size_t size() const, implicit() const, deviations() const;
///   template <class T> auto evaluate(std::span<const T> state, std::span<const T> a, const T& time,
///                                    const MotionRegime& regime, std::span<const T> deviations) const;  // .residual,
///                                    .rates
/// `residual` is affine in a, and all is Lipschitz continuous wherever it is evaluated.

/// A point, or a set of points, at which to evaluate it.
template <class T>
struct MotionPoint {
  std::vector<T> state, acceleration;
  T time;
  MotionRegime regime;
  std::vector<T> deviations;
};

/// Columns of derivatives: of the residual, then of the explicit rates.
template <class T>
using Columns = std::vector<std::vector<T>>;

/// By the variables `first` to before `last` of state, acceleration and deviations in this order.
template <class T, class System>
[[nodiscard]] Columns<T> partial_derivatives(const System& system, const MotionPoint<T>& at, std::size_t first,
                                             std::size_t last) {
  constexpr std::size_t at_once = 10;
  using Variable = Dual<T, at_once>;
  Columns<T> columns;
  for (std::size_t begin = first; begin < last; begin += at_once) {
    const std::size_t count = std::min(at_once, last - begin);
    std::size_t index = 0;
    const auto variables = [&](const std::vector<T>& values) {
      std::vector<Variable> result(values.begin(), values.end());
      for (Variable& variable : result) {
        if (index >= begin && index < begin + count) variable.partial[index - begin] = T(1);
        ++index;
      }
      return result;
    };
    const std::vector<Variable> state = variables(at.state);
    const std::vector<Variable> acceleration = variables(at.acceleration);
    const std::vector<Variable> deviations = variables(at.deviations);
    const auto terms =
        system.template evaluate<Variable>(state, acceleration, Variable(at.time), at.regime, deviations);
    for (std::size_t k = 0; k < count; ++k) {
      std::vector<T> column;
      for (const Variable& value : terms.residual) column.push_back(value.partial[k]);
      for (const Variable& value : terms.rates) column.push_back(value.partial[k]);
      columns.push_back(std::move(column));
    }
  }
  return columns;
}

// Approximate motions and their derivatives by parameters, as polynomials step by step: collocation at Radau's points
// (Hairer and Wanner, Solving Ordinary Differential Equations II, IV.5). Nothing here has to be right: what it leaves
// is enclosed afterwards.

/// The state, over one step, as a function of t in [-1, 1] and the deviations d in [-1, 1] of the parameters:
/// sum of state.col(i) t^i, with by_deviation[k] times d_k and by_pair times d_k d_l likewise. Its numbers are exact.
struct MotionPolynomial {
  double from, to;  ///< s
  Eigen::MatrixXd state;
  std::vector<Eigen::MatrixXd> by_deviation;
  std::vector<Eigen::MatrixXd> by_pair;  ///< k >= l, in the order (0, 0), (1, 0), (1, 1), (2, 0) and so on
};

/// Where a step starts.
struct ApproximateState {
  double time;
  Eigen::VectorXd state;
  Eigen::MatrixXd by_deviation;  ///< a column each
  Eigen::MatrixXd by_pair;
};

/// Rates and their derivatives at one state, deviations 0.
struct ApproximateRates {
  Eigen::VectorXd rates;
  Eigen::MatrixXd by_state, by_deviation;
  Eigen::MatrixXd inverse_mass;
};

namespace collocation_details {

inline MotionPoint<double> point(const Eigen::VectorXd& state, const Eigen::VectorXd& acceleration, double time,
                                 const MotionRegime& regime, std::size_t deviations) {
  return {{state.begin(), state.end()},
          {acceleration.begin(), acceleration.end()},
          time,
          regime,
          std::vector<double>(deviations, 0.0)};
}

inline Eigen::MatrixXd matrix(const Columns<double>& columns, std::size_t rows) {
  Eigen::MatrixXd result(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t j = 0; j < columns.size(); ++j) {
    for (std::size_t i = 0; i < rows; ++i)
      result(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = columns[j][i];
  }
  return result;
}

}  // namespace collocation_details

/// The rates alone.
template <class System>
[[nodiscard]] Eigen::VectorXd approximate_rates(const System& system, const Eigen::VectorXd& state, double time,
                                                const MotionRegime& regime) {
  using namespace collocation_details;
  const auto m = static_cast<Eigen::Index>(system.implicit());
  const MotionPoint<double> at = point(state, Eigen::VectorXd::Zero(m), time, regime, system.deviations());
  const auto terms = system.template evaluate<double>(at.state, at.acceleration, time, regime, at.deviations);
  const Eigen::MatrixXd mass =
      matrix(partial_derivatives(system, at, system.size(), system.size() + system.implicit()), system.implicit());
  Eigen::VectorXd result(state.size());
  result.head(m) = -mass.partialPivLu().solve(Eigen::Map<const Eigen::VectorXd>(terms.residual.data(), m));
  result.tail(state.size() - m) = Eigen::Map<const Eigen::VectorXd>(terms.rates.data(), state.size() - m);
  return result;
}

template <class System>
[[nodiscard]] ApproximateRates approximate_derivatives(const System& system, const Eigen::VectorXd& state, double time,
                                                       const MotionRegime& regime) {
  using namespace collocation_details;
  const auto n = static_cast<Eigen::Index>(system.size());
  const auto m = static_cast<Eigen::Index>(system.implicit());
  const auto deviations = static_cast<Eigen::Index>(system.deviations());
  ApproximateRates result;
  result.rates = approximate_rates(system, state, time, regime);
  const MotionPoint<double> at = point(state, Eigen::VectorXd(result.rates.head(m)), time, regime, system.deviations());
  const Eigen::MatrixXd all = matrix(
      partial_derivatives(system, at, 0, system.size() + system.implicit() + system.deviations()), system.size());
  const Eigen::PartialPivLU<Eigen::MatrixXd> mass(all.block(0, n, m, m));
  const auto solved = [&](Eigen::Index first, Eigen::Index count) {
    Eigen::MatrixXd columns = all.middleCols(first, count);
    columns.topRows(m) = -mass.solve(Eigen::MatrixXd(columns.topRows(m)));
    return columns;
  };
  result.inverse_mass = mass.inverse();
  result.by_state = solved(0, n);
  result.by_deviation = solved(n + m, deviations);
  return result;
}

/// Five stages: order 9 at the ends of steps.
class RadauRule {
 public:
  static constexpr Eigen::Index stages = 5;

  RadauRule() {
    // The zeros of P_4 - P_5, Legendre's polynomials, by Newton's method; the last point is the end of the step.
    nodes_ << -0.8857916077709646, -0.4463139727237523, 0.1671808647378336, 0.7204802713124389, 1.0;
    Eigen::MatrixXd vandermonde(stages, stages);
    for (Eigen::Index j = 0; j < stages; ++j) {
      for (Eigen::Index i = 0; i < stages; ++i) vandermonde(j, i) = std::pow(nodes_[j], static_cast<double>(i));
    }
    const Eigen::MatrixXd lagrange = vandermonde.inverse();  // column l: the coefficients of l_l
    integrals_ = Eigen::MatrixXd::Zero(stages, stages + 1);
    for (Eigen::Index l = 0; l < stages; ++l) {
      for (Eigen::Index i = 0; i < stages; ++i) {
        const double c = lagrange(i, l) / static_cast<double>(i + 1);
        integrals_(l, i + 1) += c;
        integrals_(l, 0) -= c * ((i + 1) % 2 == 0 ? 1.0 : -1.0);
      }
    }
    weights_.resize(stages, stages);
    for (Eigen::Index j = 0; j < stages; ++j) weights_.row(j) = (integrals_ * powers(nodes_[j])).transpose();
  }

  [[nodiscard]] double node(Eigen::Index j) const { return nodes_[j]; }
  /// (j, l): the integral of l_l from -1 to node j.
  [[nodiscard]] const Eigen::MatrixXd& weights() const { return weights_; }
  /// Row l: the coefficients of the integral of l_l from -1.
  [[nodiscard]] const Eigen::MatrixXd& integrals() const { return integrals_; }
  [[nodiscard]] static Eigen::VectorXd powers(double t) {
    Eigen::VectorXd result(stages + 1);
    for (Eigen::Index i = 0; i <= stages; ++i) result[i] = std::pow(t, static_cast<double>(i));
    return result;
  }

 private:
  Eigen::Matrix<double, stages, 1> nodes_;
  Eigen::MatrixXd integrals_, weights_;
};

/// In the branches of `regime`, and past their ends. Nothing where Newton's method does not converge.
template <class System>
[[nodiscard]] std::optional<MotionPolynomial> collocation_step(const System& system, const RadauRule& rule,
                                                               const ApproximateState& start, double to,
                                                               const MotionRegime& regime) {
  constexpr int most_iterations = 12;
  constexpr double converged = 1e-14;
  constexpr Eigen::Index stages = RadauRule::stages;
  const auto n = start.state.size();
  const double half = 0.5 * (to - start.time);
  Eigen::MatrixXd rates = approximate_rates(system, start.state, start.time, regime).replicate(1, stages);
  Eigen::MatrixXd newton(n * stages, n * stages);
  Eigen::MatrixXd by_deviation(n * stages, start.by_deviation.cols());
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    Eigen::VectorXd missing(n * stages);
    newton.setIdentity();
    for (Eigen::Index j = 0; j < stages; ++j) {
      const Eigen::VectorXd state = start.state + half * rates * rule.weights().row(j).transpose();
      if (!state.allFinite()) return std::nullopt;
      const double time = start.time + half * (rule.node(j) + 1.0);
      const ApproximateRates at = approximate_derivatives(system, state, time, regime);
      missing.segment(n * j, n) = at.rates - rates.col(j);
      for (Eigen::Index l = 0; l < stages; ++l)
        newton.block(n * j, n * l, n, n) -= half * rule.weights()(j, l) * at.by_state;
      by_deviation.middleRows(n * j, n) = at.by_state * start.by_deviation + at.by_deviation;
    }
    const Eigen::PartialPivLU<Eigen::MatrixXd> solver(newton);
    const Eigen::VectorXd change = solver.solve(missing);
    if (!change.allFinite()) return std::nullopt;
    for (Eigen::Index j = 0; j < stages; ++j) rates.col(j) += change.segment(n * j, n);
    const double size = half * change.lpNorm<Eigen::Infinity>();
    if (size > converged * (1.0 + start.state.lpNorm<Eigen::Infinity>())) continue;

    MotionPolynomial result{start.time, to, half * rates * rule.integrals(), {}, {}};
    result.state.col(0) += start.state;
    const Eigen::MatrixXd slopes = solver.solve(by_deviation);
    for (Eigen::Index k = 0; k < slopes.cols(); ++k) {
      const Eigen::MatrixXd of_stages = slopes.col(k).reshaped(n, stages);
      result.by_deviation.emplace_back(half * of_stages * rule.integrals());
      result.by_deviation.back().col(0) += start.by_deviation.col(k);
    }
    return result;
  }
  return std::nullopt;
}

/// At its end.
[[nodiscard]] inline ApproximateState end_of(const MotionPolynomial& step) {
  const auto sums = [&](const std::vector<Eigen::MatrixXd>& parts) {
    Eigen::MatrixXd result(step.state.rows(), static_cast<Eigen::Index>(parts.size()));
    for (std::size_t k = 0; k < parts.size(); ++k) result.col(static_cast<Eigen::Index>(k)) = parts[k].rowwise().sum();
    return result;
  };
  return {step.to, step.state.rowwise().sum(), sums(step.by_deviation), sums(step.by_pair)};
}

}  // namespace verisq::stance
