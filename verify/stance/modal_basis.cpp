/// Eigenvectors in floating point, with a proven inverse; norms of small blocks, rounded upward.
#include "verify/stance/modal_basis.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <stdexcept>

namespace verisq::stance {
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
