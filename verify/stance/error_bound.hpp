/// Bounds of how far the motions of a system are from an approximate one, step by step: the defect of the approximation
/// and a differential inequality (docs/stance.md §9). No a-priori enclosure, no guard at events.
#pragma once

#include <optional>
#include <stdexcept>

#include "verify/stance/collocation.hpp"
#include "verify/stance/linear_systems.hpp"
#include "verify/stance/taylor_model.hpp"

namespace verisq::stance {

/// The approximation's own polynomials fit in.
using DefectModel = TaylorModel<RadauRule::stages + 1>;
/// For derivatives, which are needed to a few digits.
using SlopeModel = TaylorModel<1>;

/// What is proven at one time: the lengths of the blocks of y, for the error e = T y of the approximation.
struct ErrorBound {
  ModalBasis basis;
  Eigen::VectorXd lengths;
};

struct BoundedStep {
  ErrorBound end;
  Eigen::VectorXd errors;      ///< at all times of the step, of each component: from above
  Eigen::VectorXd end_errors;  ///< at its end
  Eigen::VectorXd changes;     ///< of each component of the error, from the beginning to the end: from above
  MotionRegime regime;         ///< settled of all within these errors, at all times of the step
};

namespace error_details {

template <class Model>
[[nodiscard]] std::vector<Interval> coefficients(const Eigen::MatrixXd& polynomial, Eigen::Index row,
                                                 const Interval& factor, bool derivative) {
  std::vector<Interval> result;
  for (Eigen::Index i = derivative ? 1 : 0; i < polynomial.cols(); ++i) {
    const Interval c = Interval(polynomial(row, i));
    result.push_back(derivative ? Interval(static_cast<int>(i)) * c * factor : c);
  }
  return result;
}

/// A component of the approximation, or its derivative by time, as a Taylor model.
template <class Model>
[[nodiscard]] Model component(const MotionPolynomial& step, Eigen::Index row, bool derivative) {
  const Interval half = Interval(0.5) * (Interval(step.to) - Interval(step.from));
  const Interval factor = derivative ? Interval(1) / half : Interval(1);
  Model result = Model::of_time(coefficients<Model>(step.state, row, factor, derivative));
  for (std::size_t k = 0; k < step.by_deviation.size(); ++k)
    result.add_row(1, k, coefficients<Model>(step.by_deviation[k], row, factor, derivative));
  for (std::size_t k = 0; k < step.by_pair.size(); ++k)
    result.add_row(2, k, coefficients<Model>(step.by_pair[k], row, factor, derivative));
  return result;
}

}  // namespace error_details

/// The approximation as a point of the system, with `errors` (or none) about it.
template <class Model, class System>
[[nodiscard]] MotionPoint<Model> motion_point(const System& system, const MotionPolynomial& step,
                                              const Eigen::VectorXd& errors, const MotionRegime& regime) {
  MotionPoint<Model> at;
  for (Eigen::Index i = 0; i < step.state.rows(); ++i) {
    at.state.push_back(error_details::component<Model>(step, i, false));
    if (errors.size() > 0) at.state.back().widen(errors[i]);
  }
  for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(system.implicit()); ++i)
    at.acceleration.push_back(error_details::component<Model>(step, i, true));
  const Interval half = Interval(0.5) * (Interval(step.to) - Interval(step.from));
  at.time = Model::of_time({Interval(step.from) + half, half});
  at.regime = regime;
  for (std::size_t k = 0; k < system.deviations(); ++k) at.deviations.push_back(Model::deviation(k));
  return at;
}

namespace error_details {

/// What is about the approximation: state i differs by the sum of shares(i, k) times the k-th error, from `first` on.
inline void add_errors(MotionPoint<SlopeModel>& at, const IntervalMatrix& shares, std::size_t first) {
  for (Eigen::Index i = 0; i < shares.rows(); ++i) {
    SlopeModel& component = at.state[static_cast<std::size_t>(i)];
    for (Eigen::Index k = 0; k < shares.cols(); ++k) {
      if (!is_zero(shares(i, k)))
        component.add_row(SlopeModel::of_errors, first + static_cast<std::size_t>(k), {shares(i, k)});
    }
  }
}

/// e = T y for |y_B| <= lengths, as T times these: the errors' first factor.
[[nodiscard]] inline IntervalMatrix modal_shares(const ModalBasis& basis, const Eigen::VectorXd& lengths) {
  IntervalMatrix result = basis.modes.cast<Interval>();
  for (Eigen::Index b = 0; b < basis.count(); ++b) {
    const ModalBasis::Block& block = basis.blocks[static_cast<std::size_t>(b)];
    for (Eigen::Index k = block.first; k < block.first + block.size; ++k) {
      for (Eigen::Index i = 0; i < result.rows(); ++i) result(i, k) *= Interval(lengths[b]);
    }
  }
  return result;
}

template <class Model>
[[nodiscard]] Model row_product(const Eigen::MatrixXd& matrix, Eigen::Index row, const std::vector<Model>& v) {
  Model sum;
  for (std::size_t j = 0; j < v.size(); ++j) {
    const double factor = matrix(row, static_cast<Eigen::Index>(j));
    if (factor != 0.0 && !is_zero(v[j])) sum += scaled(v[j], Interval(factor));
  }
  return sum;
}

template <class Model>
[[nodiscard]] std::vector<Model> product(const Eigen::MatrixXd& matrix, const std::vector<Model>& v) {
  std::vector<Model> result;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) result.push_back(row_product(matrix, i, v));
  return result;
}

/// M^-1 = (I + E + E^2 + ...) B for a point B near the inverse and E = I - B M, where the sum converges: where the norm
/// of row sums of S^-1 |E| S is below 1 for the scales S, those of the joints' accelerations.
class InverseMass {
 public:
  /// `columns` are those of M.
  explicit InverseMass(const Columns<SlopeModel>& columns) {
    const auto m = static_cast<Eigen::Index>(columns.size());
    Eigen::MatrixXd middle(m, m);
    for (Eigen::Index j = 0; j < m; ++j) {
      for (Eigen::Index i = 0; i < m; ++i) {
        const Interval& c = columns[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)].constant();
        middle(i, j) = 0.5 * c.lower() + 0.5 * c.upper();
      }
    }
    approximate_ = middle.partialPivLu().inverse();
    if (!approximate_.allFinite()) throw std::domain_error("mass matrix: singular");
    scales_ = approximate_.diagonal().cwiseAbs().cwiseSqrt().array() + 1e-100;
    sizes_.resize(m, m);
    IntervalVector sums = IntervalVector::Zero(m);
    for (Eigen::Index j = 0; j < m; ++j) {
      std::vector<SlopeModel> column = columns[static_cast<std::size_t>(j)];
      column.resize(static_cast<std::size_t>(m));
      defect_.push_back(product(approximate_, column));
      for (Eigen::Index i = 0; i < m; ++i) {
        SlopeModel& e = defect_.back()[static_cast<std::size_t>(i)];
        e = SlopeModel(i == j ? 1 : 0) - e;
        sizes_(i, j) = Interval(e.size());
        sums[i] += sizes_(i, j) * Interval(scales_[j]) / Interval(scales_[i]);
      }
    }
    for (const Interval& sum : sums) norm_ = std::max(norm_, sum.upper());
    if (!(norm_ < 0.5)) throw std::domain_error("mass matrix: not proven to be regular");
  }

  /// M^-1 v: two terms are followed, the others bounded.
  [[nodiscard]] std::vector<SlopeModel> times(const std::vector<SlopeModel>& v) const {
    const std::vector<SlopeModel> near = product(approximate_, v);
    const std::vector<SlopeModel> once = by_defect(near);
    const std::vector<SlopeModel> twice = by_defect(once);
    const IntervalVector rest = after(sizes(twice));
    std::vector<SlopeModel> result;
    for (std::size_t i = 0; i < near.size(); ++i) {
      result.push_back(near[i] + once[i] + twice[i]);
      result.back().widen(rest[static_cast<Eigen::Index>(i)].upper());
    }
    return result;
  }

  /// The same for small v: what E adds is bounded, not followed.
  [[nodiscard]] std::vector<DefectModel> times_small(const std::vector<DefectModel>& v) const {
    std::vector<DefectModel> near = product(approximate_, v);
    const IntervalVector rest = after(sizes(near));
    for (std::size_t i = 0; i < near.size(); ++i) near[i].widen(rest[static_cast<Eigen::Index>(i)].upper());
    return near;
  }

 private:
  template <class Model>
  [[nodiscard]] static IntervalVector sizes(const std::vector<Model>& v) {
    IntervalVector result(static_cast<Eigen::Index>(v.size()));
    for (Eigen::Index i = 0; i < result.size(); ++i) result[i] = Interval(v[static_cast<std::size_t>(i)].size());
    return result;
  }

  /// Bounds |E v| + |E^2 v| + ... for |v| <= sizes: three terms entry by entry, of the others the scaled norm.
  [[nodiscard]] IntervalVector after(const IntervalVector& sizes) const {
    constexpr int terms = 3;
    IntervalVector term = sizes;
    IntervalVector sum = IntervalVector::Zero(sizes.size());
    for (int k = 0; k < terms; ++k) {
      term = stance::product(sizes_, term);
      sum += term;
    }
    double largest = 0.0;
    for (Eigen::Index i = 0; i < term.size(); ++i)
      largest = std::max(largest, (term[i] / Interval(scales_[i])).upper());
    const Interval tail = Interval(largest) * Interval(norm_) / (Interval(1) - Interval(norm_));
    for (Eigen::Index i = 0; i < sum.size(); ++i) sum[i] += tail * Interval(scales_[i]);
    return sum;
  }

  [[nodiscard]] std::vector<SlopeModel> by_defect(const std::vector<SlopeModel>& v) const {
    std::vector<SlopeModel> result(v.size());
    for (std::size_t j = 0; j < v.size(); ++j) {
      if (is_zero(v[j])) continue;
      for (std::size_t i = 0; i < v.size(); ++i) result[i] += defect_[j][i] * v[j];
    }
    return result;
  }

  Eigen::MatrixXd approximate_;  ///< B
  Eigen::VectorXd scales_;       ///< S; any positive numbers are sound
  Columns<SlopeModel> defect_;   ///< E
  IntervalMatrix sizes_;         ///< |E|
  double norm_ = 0.0;
};

/// T^-1 d, block by block: lengths from above.
[[nodiscard]] inline Eigen::VectorXd modal_lengths(const ModalBasis& basis, const std::vector<DefectModel>& d) {
  IntervalVector y(static_cast<Eigen::Index>(d.size()));
  Interval total(0);
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    const double size = row_product(basis.inverse, i, d).size();
    y[i] = Interval(-size, size);
    total += Interval(size);
  }
  const double error = (total * Interval(basis.inverse_defect)).upper();
  Eigen::VectorXd result(basis.count());
  for (Eigen::Index b = 0; b < basis.count(); ++b) {
    const ModalBasis::Block& block = basis.blocks[static_cast<std::size_t>(b)];
    Interval sum(0);
    for (Eigen::Index i = 0; i < block.size; ++i) sum += square(abs(y[block.first + i]) + Interval(error));
    result[b] = sqrt(sum).upper();
  }
  return result;
}

/// Of the blocks of T^-1 J T.
struct ModalRates {
  Eigen::MatrixXd couplings;  ///< of the comparison system: on the diagonal logarithmic norms, norms beside it
  Eigen::MatrixXd norms;      ///< of all
};

[[nodiscard]] inline ModalRates modal_rates(const ModalBasis& basis, const Columns<SlopeModel>& jacobian) {
  const auto n = static_cast<Eigen::Index>(jacobian.size());
  std::vector<std::vector<SlopeModel>> left;  // columns of V J
  for (const std::vector<SlopeModel>& column : jacobian) left.push_back(product(basis.inverse, column));
  IntervalMatrix whole(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    std::vector<SlopeModel> row;
    row.reserve(left.size());
    for (const std::vector<SlopeModel>& column : left) row.push_back(column[static_cast<std::size_t>(i)]);
    for (Eigen::Index j = 0; j < n; ++j) {
      SlopeModel entry;
      for (Eigen::Index k = 0; k < n; ++k) {
        const double factor = basis.modes(k, j);
        if (factor != 0.0) entry += scaled(row[static_cast<std::size_t>(k)], Interval(factor));
      }
      whole(i, j) = entry.range();
    }
  }
  // T^-1 = (I + X) V: X V J T, with all entries of X at most the defect.
  for (Eigen::Index j = 0; j < n; ++j) {
    Interval total(0);
    for (Eigen::Index i = 0; i < n; ++i) total += abs(whole(i, j));
    const double error = (total * Interval(basis.inverse_defect)).upper();
    for (Eigen::Index i = 0; i < n; ++i) whole(i, j) += Interval(-error, error);
  }
  ModalRates rates{Eigen::MatrixXd(basis.count(), basis.count()), Eigen::MatrixXd(basis.count(), basis.count())};
  for (Eigen::Index a = 0; a < basis.count(); ++a) {
    const ModalBasis::Block& row = basis.blocks[static_cast<std::size_t>(a)];
    for (Eigen::Index b = 0; b < basis.count(); ++b) {
      const ModalBasis::Block& column = basis.blocks[static_cast<std::size_t>(b)];
      const IntervalMatrix part = whole.block(row.first, column.first, row.size, column.size);
      rates.norms(a, b) = spectral_norm(part);
      rates.couplings(a, b) = a == b ? logarithmic_norm(part) : rates.norms(a, b);
    }
  }
  return rates;
}

}  // namespace error_details

/// The differential inequality of one step: |y_i|' <= sum of rate_ij |y_j| + forcing_i, as long as |y_i| <= within_i.
struct ErrorInequality {
  error_details::ModalRates rates;
  Eigen::VectorXd forcing;
};

/// How far y may move while it lies within `tube`: |y_i(t) - y_i(0)| <= integral of |y_i'| <= length times (sum of
/// norm_ij tube_j + forcing_i).
[[nodiscard]] inline Eigen::VectorXd greatest_changes(const ErrorInequality& inequality, const Eigen::VectorXd& tube,
                                                      const Interval& length) {
  Eigen::VectorXd result(tube.size());
  for (Eigen::Index i = 0; i < tube.size(); ++i) {
    Interval rate(inequality.forcing[i]);
    for (Eigen::Index j = 0; j < tube.size(); ++j) rate += Interval(inequality.rates.norms(i, j)) * Interval(tube[j]);
    result[i] = (length * rate).upper();
  }
  return result;
}

/// With w the state's first components' rates a as unknowns, M(w) a + h(w) = 0 for a motion and the approximation w^
/// has a residual R = M(w^) w^' + h(w^): the error e = w - w^ obeys M(w) e_a' = -R - D e, with D the slopes of M(w) w^'
/// + h(w) in w between the two (w^' is the same number on both sides). D is the mean over the points w^ + s e, 0 < s <
/// 1, of one-sided derivatives, which at almost each of them are those of the branches that hold there: nothing else
/// happens at events. All of D at such a point depends on the same s e, and so cancels; M is taken elsewhere, at w, and
/// depends on errors of its own, those of the components, which the state's other components need not have.
template <class System>
[[nodiscard]] ErrorInequality error_inequality(const System& system, const MotionPolynomial& step,
                                               const ModalBasis& basis, const Eigen::VectorXd& within,
                                               const MotionRegime& regime) {
  using namespace error_details;
  const Eigen::VectorXd components = components_of(basis, within);
  const std::size_t n = system.size();
  const std::size_t m = system.implicit();
  // Without deviations errors are tiny but at events, where what is open is more than they are: following them costs.
  const bool follows_errors = system.deviations() > 0;
  MotionPoint<SlopeModel> between =
      motion_point<SlopeModel>(system, step, follows_errors ? Eigen::VectorXd() : components, regime);
  MotionPoint<SlopeModel> moved = between;
  if (follows_errors) {
    add_errors(between, modal_shares(basis, within), 0);
    add_errors(moved, IntervalMatrix(components.cast<Interval>().asDiagonal()), n);
  }
  const InverseMass inverse_mass(partial_derivatives(system, moved, n, n + m));
  Columns<SlopeModel> slopes = partial_derivatives(system, between, 0, n);
  for (std::vector<SlopeModel>& column : slopes) {
    const std::vector<SlopeModel> accelerations =
        inverse_mass.times(std::vector<SlopeModel>(column.begin(), column.begin() + static_cast<std::ptrdiff_t>(m)));
    for (std::size_t i = 0; i < m; ++i) column[i] = -accelerations[i];
  }

  const MotionPoint<DefectModel> at = motion_point<DefectModel>(system, step, {}, regime);
  const auto terms =
      system.template evaluate<DefectModel>(at.state, at.acceleration, at.time, at.regime, at.deviations);
  std::vector<DefectModel> defect = inverse_mass.times_small(terms.residual);
  for (std::size_t i = m; i < n; ++i)
    defect.push_back(component<DefectModel>(step, static_cast<Eigen::Index>(i), true) - terms.rates[i - m]);
  return {modal_rates(basis, slopes), modal_lengths(basis, defect)};
}

/// Which branches hold at all times of a step, for all states within `errors` of the approximation.
template <class System>
[[nodiscard]] MotionRegime settled_regime(const System& system, const MotionPolynomial& step,
                                          const Eigen::VectorXd& errors) {
  const MotionPoint<DefectModel> tube =
      motion_point<DefectModel>(system, step, errors, MotionRegime{0.5 * (step.from + step.to)});
  const auto terms =
      system.template evaluate<DefectModel>(tube.state, tube.acceleration, tube.time, tube.regime, tube.deviations);
  return system.settled(terms, tube.regime.within);
}

/// Nothing where no tube about the approximation is confirmed; or, `if_settled`, where it is open which branches hold
/// in it.
template <class System>
[[nodiscard]] std::optional<BoundedStep> bounded_step(const System& system, const MotionPolynomial& step,
                                                      const ErrorBound& start, bool if_settled) {
  constexpr int most_inflations = 8;
  constexpr double inflation = 1.5;
  constexpr double least = 1e-18;
  const Interval length = Interval(step.to) - Interval(step.from);
  Eigen::VectorXd guess = inflation * start.lengths.array() + least;
  for (int attempt = 0; attempt < most_inflations; ++attempt) {
    // Branches that are settled of the whole tube are those of each point between the approximation and a motion: what
    // is evaluated in them is what holds there.
    const MotionRegime regime = settled_regime(system, step, components_of(start.basis, guess));
    if (if_settled && !regime.is_settled()) return std::nullopt;
    const ErrorInequality inequality = error_inequality(system, step, start.basis, guess, regime);
    const auto bound = upper_solution(inequality.rates.couplings, inequality.forcing, start.lengths, length);
    if (!bound) return std::nullopt;
    const Eigen::VectorXd tube = bound->start.cwiseMax(bound->end);
    // The error is continuous and starts within the guess: as long as it is there it is in the tube, which is smaller.
    if ((tube.array() < guess.array()).all())
      return BoundedStep{{start.basis, bound->end},
                         components_of(start.basis, tube),
                         components_of(start.basis, bound->end),
                         components_of(start.basis, greatest_changes(inequality, tube, length)),
                         regime};
    guess = guess.cwiseMax(Eigen::VectorXd(inflation * tube.array() + least));
  }
  return std::nullopt;
}

}  // namespace verisq::stance
