/// This file implements linear_systems.hpp.
#include "verify/stance/linear_systems.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "verify/stance/scalar.hpp"

namespace verisq::stance {
namespace {

using verify::Interval;

bool is_zero(double a) {
  return a == 0.0;
}

bool is_zero(const Interval& a) {
  return is_zero(a.lower()) && is_zero(a.upper());
}

/// m v, leaving out the zeros of trees: most of a product's time.
template <class Matrix>
IntervalVector product_with_zeros(const Matrix& m, const IntervalVector& v) {
  IntervalVector result = IntervalVector::Zero(m.rows());
  for (Eigen::Index j = 0; j < m.cols(); ++j) {
    if (is_zero(v[j])) continue;
    for (Eigen::Index i = 0; i < m.rows(); ++i) {
      if (!is_zero(m(i, j))) result[i] += Interval(m(i, j)) * v[j];
    }
  }
  return result;
}

}  // namespace

double magnitude(const Interval& a) {
  return abs(a).upper();
}

IntervalVector product(const Eigen::MatrixXd& m, const IntervalVector& v) {
  return product_with_zeros(m, v);
}

IntervalVector product(const IntervalMatrix& m, const IntervalVector& v) {
  return product_with_zeros(m, v);
}

IntervalMatrix product(const Eigen::MatrixXd& m, const IntervalMatrix& n) {
  IntervalMatrix result(m.rows(), n.cols());
  for (Eigen::Index j = 0; j < n.cols(); ++j) result.col(j) = product(m, IntervalVector(n.col(j)));
  return result;
}

bool in_interior(const IntervalVector& inner, const IntervalVector& outer) {
  for (Eigen::Index i = 0; i < inner.size(); ++i) {
    if (!(inner[i].lower() > outer[i].lower() && inner[i].upper() < outer[i].upper())) return false;
  }
  return true;
}

std::optional<WeightedContraction> weighted_contraction(const Eigen::MatrixXd& sizes, const Eigen::VectorXd& diagonal) {
  // diagonal - sizes is an M-matrix where there are such weights, and its inverse positive: any guess is checked below.
  const Eigen::MatrixXd comparison = Eigen::MatrixXd(diagonal.asDiagonal()) - sizes;
  WeightedContraction result{comparison.partialPivLu().solve(Eigen::VectorXd::Ones(sizes.rows())), 0.0};
  const Eigen::VectorXd& weights = result.weights;
  if (!weights.allFinite() || !(weights.minCoeff() > 0.0)) return std::nullopt;
  for (Eigen::Index i = 0; i < sizes.rows(); ++i) {
    Interval reached(0);
    for (Eigen::Index j = 0; j < sizes.cols(); ++j) reached += Interval(sizes(i, j)) * Interval(weights[j]);
    const Interval share = reached / (Interval(diagonal[i]) * Interval(weights[i]));
    if (!(share.upper() < 1.0)) return std::nullopt;
    result.factor = std::fmax(result.factor, share.upper());
  }
  return result;
}

IntervalVector inflated(const IntervalVector& errors) {
  constexpr double factor = 1.25;
  constexpr double least = 0x1p-1000;
  // An error of one component reaches others: the share of the largest keeps those from starting at nothing.
  constexpr double share_of_largest = 0x1p-40;
  double largest = 0.0;
  for (const Interval& error : errors) largest = std::fmax(largest, magnitude(error));
  IntervalVector wide(errors.size());
  for (Eigen::Index i = 0; i < errors.size(); ++i) {
    const double radius = factor * magnitude(errors[i]) + share_of_largest * largest + least;
    wide[i] = Interval(-radius, radius);
  }
  return wide;
}

std::optional<IntervalVector> fixed_points(const IntervalVector& z, const IntervalMatrix& c) {
  constexpr int most_inflations = 12;
  constexpr int refinements = 3;
  IntervalVector errors = z;
  for (int i = 0; i < most_inflations; ++i) {
    const IntervalVector box = inflated(errors);
    errors = z + product(c, box);
    if (!in_interior(errors, box)) continue;
    for (int k = 0; k < refinements; ++k) errors = z + product(c, errors);
    return errors;
  }
  return std::nullopt;
}

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

namespace {

using verify::Interval;
using Variation = ParametricLinearSystem::Variation;

/// Near the middle; any number would be sound.
double middle(const Interval& a) {
  return 0.5 * a.lower() + 0.5 * a.upper();
}

Eigen::MatrixXd approximate_inverse(const IntervalMatrix& matrix) {
  return matrix.unaryExpr([](const Interval& a) { return middle(a); }).partialPivLu().inverse();
}

/// Precondition: one point lies in both.
IntervalVector intersection(const IntervalVector& a, const IntervalVector& b) {
  IntervalVector result(a.size());
  for (Eigen::Index i = 0; i < a.size(); ++i) result[i] = stance::intersection(a[i], b[i]);
  return result;
}

/// The system times R: for the solution x + e and any R, R A(p) (x + e) = R b(p) is e = z + C e with z = R (b(p) - A(p)
/// x) and C = I - R A(p). By the mean value theorem, entry by entry, both are their values at the centre and the sum
/// over the parameters of derivative times deviation. R goes to each derivative before the deviation does: the entries
/// of a derivative change together, and R cancels much of them.
struct Preconditioned {
  IntervalVector z;                      ///< at the centre
  IntervalMatrix c;                      ///< at the centre
  std::vector<IntervalVector> slopes;    ///< of z, by variation
  std::vector<IntervalMatrix> matrices;  ///< R times the derivative of A: minus the slope of C
};

std::optional<Preconditioned> preconditioned(const ParametricLinearSystem& system) {
  const Eigen::MatrixXd inverse = approximate_inverse(system.matrix);
  if (!inverse.allFinite() || !system.approximation.allFinite()) return std::nullopt;
  Preconditioned result;
  result.z = product(inverse, system.residual);
  result.c = IntervalMatrix::Identity(inverse.rows(), inverse.cols()) - product(inverse, system.matrix);
  for (const Variation& by : system.variations) {
    result.slopes.push_back(product(inverse, by.residual));
    result.matrices.push_back(product(inverse, by.matrix));
  }
  return result;
}

}  // namespace

std::optional<ParametricSolution> solve(const ParametricLinearSystem& system) {
  const std::optional<Preconditioned> at = preconditioned(system);
  if (!at) return std::nullopt;
  const std::size_t count = system.variations.size();
  IntervalVector z = at->z;
  IntervalMatrix c = at->c;
  for (std::size_t k = 0; k < count; ++k) {
    z += at->slopes[k] * system.variations[k].deviation;
    c -= at->matrices[k] * system.variations[k].deviation;
  }
  const std::optional<IntervalVector> errors = fixed_points(z, c);
  const std::optional<IntervalVector> errors_at_centre = fixed_points(at->z, at->c);
  if (!errors || !errors_at_centre) return std::nullopt;

  // The derivatives d of x + e = A^-1 b satisfy A d = b' - A' (x + e), where b' - A' x is the residual's derivative:
  // multiplied by R, d = R (b' - A' x) - R A' e + (I - R A) d.
  ParametricSolution result;
  IntervalVector by_mean_value = *errors_at_centre;
  for (std::size_t k = 0; k < count; ++k) {
    std::optional<IntervalVector> derivative = fixed_points(at->slopes[k] - product(at->matrices[k], *errors), c);
    if (!derivative) return std::nullopt;
    by_mean_value += *derivative * system.variations[k].deviation;
    result.derivatives.push_back(std::move(*derivative));
  }
  result.solution = intersection(*errors, by_mean_value);
  for (Eigen::Index i = 0; i < z.size(); ++i) result.solution[i] += Interval(system.approximation[i]);
  return result;
}

// A proof needs a spectral radius of |C| below 1. The trace of |C|^2 stands for its square: like the radius, it does
// not depend on the unknowns' units, and what C does not lead back to itself has no part in it.
std::vector<double> obstructions(const ParametricLinearSystem& system) {
  const std::optional<Preconditioned> at = preconditioned(system);
  std::vector<double> result(system.variations.size(), 0.0);
  for (std::size_t k = 0; at && k < result.size(); ++k) {
    const Interval& deviation = system.variations[k].deviation;
    const Eigen::MatrixXd change =
        at->matrices[k].unaryExpr([&](const Interval& a) { return magnitude(a * deviation); });
    result[k] = change.cwiseProduct(change.transpose()).sum();
  }
  return result;
}

namespace {

using verify::Interval;

constexpr double unit_roundoff = 0x1p-53;

/// Rounded up: at least the exact sum of two numbers whose rounded sum is `sum`.
double above(double sum) {
  return std::nextafter(sum, std::numeric_limits<double>::infinity());
}

}  // namespace

MidpointRadius::MidpointRadius(const Eigen::MatrixXd& exact)
    : midpoint(exact), radius(Eigen::MatrixXd::Zero(exact.rows(), exact.cols())) {}

MidpointRadius::MidpointRadius(const IntervalMatrix& intervals)
    : midpoint(intervals.rows(), intervals.cols()), radius(intervals.rows(), intervals.cols()) {
  for (Eigen::Index i = 0; i < intervals.rows(); ++i) {
    for (Eigen::Index j = 0; j < intervals.cols(); ++j) {
      const Interval& a = intervals(i, j);
      const bool thin = a.lower() == a.upper();  // halves of the least numbers are rounded
      const double middle = thin ? a.lower() : 0.5 * a.lower() + 0.5 * a.upper();
      midpoint(i, j) = middle;
      radius(i, j) = thin ? 0.0 : above(std::fmax(a.upper() - middle, middle - a.lower()));
    }
  }
}

MidpointRadius::MidpointRadius(Eigen::MatrixXd midpoint_of_all, Eigen::MatrixXd radius_of_all)
    : midpoint(std::move(midpoint_of_all)), radius(std::move(radius_of_all)) {}

IntervalMatrix MidpointRadius::intervals() const {
  IntervalMatrix result(midpoint.rows(), midpoint.cols());
  for (Eigen::Index i = 0; i < midpoint.rows(); ++i) {
    for (Eigen::Index j = 0; j < midpoint.cols(); ++j)
      result(i, j) = Interval(midpoint(i, j)) + Interval(radius(i, j)) * Interval(-1.0, 1.0);
  }
  return result;
}

/// For |A - a| <= r, |B - b| <= s: |A B - fl(a b)| <= |a b - fl(a b)| + |a| s + r (|b| + s).
///
/// A dot product of n numbers, in any order, with or without fused operations, differs from the exact one by at most
/// g = n u/(1 - n u) times that of the magnitudes, u = 2^-53, and n 2^-1074 where products underflow (Higham, Accuracy
/// and Stability of Numerical Algorithms, section 3.1). Let P be any rounded product of nonnegative matrices here: the
/// exact one is at most P/(1 - g) + n 2^-1074/(1 - g), which is below (1 + 2 g) P + n 2^-1073 for g <= 1/2. The
/// magnitudes' product, times g, and the two products above sum to the radius, each rounded a few times more: (1 + 4 g)
/// on all of it covers the factor (1 + 2 g) and up to ten further roundings, for n >= 8, for which g >= 8 u.
MidpointRadius operator*(const MidpointRadius& a, const MidpointRadius& b) {
  const auto n = static_cast<double>(std::max<Eigen::Index>(a.midpoint.cols(), 8));
  if (!(n <= 0x1p40)) throw std::domain_error("interval matrices: too large");
  const double g = above(n * unit_roundoff / (1.0 - n * unit_roundoff)) * (1.0 + 0x1p-20);
  const double underflow = n * 0x1p-1070;
  const Eigen::MatrixXd magnitude_a = a.midpoint.cwiseAbs();
  const Eigen::MatrixXd magnitude_b = b.midpoint.cwiseAbs();
  const Eigen::MatrixXd reach_b = (magnitude_b + b.radius).unaryExpr(&above);
  Eigen::MatrixXd radius = g * (magnitude_a * magnitude_b) + magnitude_a * b.radius + a.radius * reach_b;
  radius = (((1.0 + 4.0 * g) * radius).array() + underflow).matrix().unaryExpr(&above);
  Eigen::MatrixXd midpoint = a.midpoint * b.midpoint;
  if (!midpoint.allFinite() || !radius.allFinite()) throw std::domain_error("interval matrices: beyond binary64");
  return {std::move(midpoint), std::move(radius)};
}

namespace {

using verify::Interval;

Interval length(const IntervalVector& v) {
  if (v.size() == 1) return abs(v[0]);
  Interval sum(0);
  for (const Interval& x : v) sum += square(x);
  return sqrt(sum);
}

/// The largest eigenvalue of [p q; q s].
Interval largest_eigenvalue(const Interval& p, const Interval& q, const Interval& s) {
  const Interval half(0.5);
  return half * (p + s) + sqrt(square(half * (p - s)) + square(q));
}

double condition(const Eigen::MatrixXd& matrix) {
  const Eigen::MatrixXd inverse = matrix.partialPivLu().inverse();
  return inverse.allFinite() ? matrix.norm() * inverse.norm() : infinity;
}

}  // namespace

ApproximateModes approximate_modes(const Eigen::MatrixXd& jacobian) {
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(jacobian);
  if (solver.info() != Eigen::Success) throw std::domain_error("modal basis: no eigenvectors");
  const Eigen::MatrixXcd vectors = solver.eigenvectors();
  const auto n = jacobian.rows();
  ApproximateModes modes{Eigen::MatrixXd(n, n), {}};
  for (Eigen::Index i = 0; i < n;) {
    const Eigen::VectorXcd vector = vectors.col(i);
    if (i + 1 < n && solver.eigenvalues()[i].imag() != 0.0) {
      // e^(i phi) v, whose real and imaginary parts are orthogonal: the roundest basis.
      const std::complex<double> turned = std::polar(1.0, -0.5 * std::arg((vector.array() * vector.array()).sum()));
      const Eigen::VectorXcd v = vector * turned;
      const double scale = v.norm() / std::sqrt(2.0);
      modes.matrix.col(i) = v.real() / scale;
      modes.matrix.col(i + 1) = v.imag() / scale;
      modes.blocks.push_back({i, 2});
      i += 2;
    } else {
      modes.matrix.col(i) = vector.real() / vector.real().norm();
      modes.blocks.push_back({i, 1});
      ++i;
    }
  }
  return modes;
}

ModalBasis modal_basis(const Eigen::MatrixXd& jacobian, const Eigen::MatrixXd& tether) {
  constexpr double worst_condition = 1e6;
  ApproximateModes modes = approximate_modes(jacobian);
  if (!(condition(modes.matrix) < worst_condition)) modes = approximate_modes(jacobian + tether);
  const Eigen::MatrixXd inverse = modes.matrix.partialPivLu().inverse();
  if (!inverse.allFinite()) throw std::domain_error("modal basis: singular");
  // (V T)^-1 = I + G + G^2 + ... for G = I - V T, in the norm of row sums; every entry is at most that norm.
  const Eigen::Index n = inverse.rows();
  const IntervalMatrix defect =
      IntervalMatrix::Identity(n, n) - product(inverse, IntervalMatrix(modes.matrix.cast<Interval>()));
  double norm = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    Interval sum(0);
    for (Eigen::Index j = 0; j < n; ++j) sum += abs(defect(i, j));
    norm = std::fmax(norm, sum.upper());
  }
  if (!(norm < 0.5)) throw std::domain_error("modal basis: not proven to be regular");
  return {modes.matrix, inverse, (Interval(norm) / (Interval(1) - Interval(norm))).upper(), modes.blocks};
}

ModalBasis plain_basis(Eigen::Index size) {
  ModalBasis basis{Eigen::MatrixXd::Identity(size, size), Eigen::MatrixXd::Identity(size, size), 0.0, {}};
  for (Eigen::Index i = 0; i < size; ++i) basis.blocks.push_back({i, 1});
  return basis;
}

Eigen::VectorXd components_of(const ModalBasis& basis, const Eigen::VectorXd& lengths) {
  // |e_i| <= sum over the blocks of |T_iB| |y_B|, by Cauchy and Schwarz.
  Eigen::VectorXd result(basis.modes.rows());
  for (Eigen::Index i = 0; i < result.size(); ++i) {
    Interval sum(0);
    for (Eigen::Index b = 0; b < basis.count(); ++b) {
      const ModalBasis::Block& block = basis.blocks[static_cast<std::size_t>(b)];
      const IntervalVector row = basis.modes.row(i).segment(block.first, block.size).transpose().cast<Interval>();
      sum += length(row) * Interval(lengths[b]);
    }
    result[i] = sum.upper();
  }
  return result;
}

Eigen::VectorXd lengths_of(const ModalBasis& basis, const IntervalVector& components) {
  IntervalVector y = product(basis.inverse, components);
  Interval total(0);
  for (const Interval& x : y) total += abs(x);
  const double error = (total * Interval(basis.inverse_defect)).upper();
  for (Interval& x : y) x += Interval(-error, error);
  Eigen::VectorXd result(basis.count());
  for (Eigen::Index b = 0; b < basis.count(); ++b) {
    const ModalBasis::Block& block = basis.blocks[static_cast<std::size_t>(b)];
    result[b] = length(y.segment(block.first, block.size)).upper();
  }
  return result;
}

Eigen::VectorXd lengths_in(const ModalBasis& basis, const ModalBasis& old, const Eigen::VectorXd& lengths) {
  IntervalMatrix change = product(basis.inverse, IntervalMatrix(old.modes.cast<Interval>()));
  for (Eigen::Index j = 0; j < change.cols(); ++j) {
    Interval total(0);
    for (const Interval& x : change.col(j)) total += abs(x);
    const double error = (total * Interval(basis.inverse_defect)).upper();
    for (Interval& x : change.col(j)) x += Interval(-error, error);
  }
  Eigen::VectorXd result(basis.count());
  for (Eigen::Index b = 0; b < basis.count(); ++b) {
    const ModalBasis::Block& to = basis.blocks[static_cast<std::size_t>(b)];
    Interval sum(0);
    for (Eigen::Index c = 0; c < old.count(); ++c) {
      const ModalBasis::Block& from = old.blocks[static_cast<std::size_t>(c)];
      sum += Interval(spectral_norm(change.block(to.first, from.first, to.size, from.size))) * Interval(lengths[c]);
    }
    result[b] = sum.upper();
  }
  return result;
}

double spectral_norm(const IntervalMatrix& matrix) {
  if (matrix.rows() == 1) return length(matrix.row(0).transpose()).upper();
  if (matrix.cols() == 1) return length(matrix.col(0)).upper();
  const auto dot = [&](Eigen::Index i, Eigen::Index j) {
    return matrix(0, i) * matrix(0, j) + matrix(1, i) * matrix(1, j);
  };
  return sqrt(largest_eigenvalue(dot(0, 0), dot(0, 1), dot(1, 1))).upper();
}

double logarithmic_norm(const IntervalMatrix& matrix) {
  if (matrix.rows() == 1) return matrix(0, 0).upper();
  return largest_eigenvalue(matrix(0, 0), Interval(0.5) * (matrix(0, 1) + matrix(1, 0)), matrix(1, 1)).upper();
}

}  // namespace verisq::stance
