/// Real coordinates in which a linear system nearly falls apart into its modes: blocks of one, or of two for a pair of
/// complex eigenvalues, each measured by its Euclidean length.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "verify/stance/contraction.hpp"

namespace verisq::stance {

/// e = T y.
struct ModalBasis {
  struct Block {
    Eigen::Index first, size;  ///< of y; size 1 or 2
  };
  Eigen::MatrixXd modes;    ///< T: any regular matrix is sound
  Eigen::MatrixXd inverse;  ///< near that of T
  double inverse_defect;    ///< the inverse of T is (I + X) inverse with |X_ij| at most this, proven
  std::vector<Block> blocks;

  [[nodiscard]] Eigen::Index count() const { return static_cast<Eigen::Index>(blocks.size()); }
};

/// Eigenvectors in floating point.
struct ApproximateModes {
  Eigen::MatrixXd matrix;  ///< columns of length 1: real eigenvectors, and of a pair a basis in which it turns evenly
  std::vector<ModalBasis::Block> blocks;
};

/// Throws std::domain_error where they are not found.
[[nodiscard]] ApproximateModes approximate_modes(const Eigen::MatrixXd& jacobian);

/// Of eigenvectors, of length 1. Where they nearly coincide, as those of a body in free flight do, whose velocity does
/// not depend on its place, those of jacobian + tether: what is left then acts as a coupling. Throws std::domain_error
/// where the regularity of the modes is not proven.
[[nodiscard]] ModalBasis modal_basis(const Eigen::MatrixXd& jacobian, const Eigen::MatrixXd& tether);

/// y = e: for the moment at which the modes change.
[[nodiscard]] ModalBasis plain_basis(Eigen::Index size);

/// From above: what lengths of the blocks of y can be of the components of e = T y; and the other way.
[[nodiscard]] Eigen::VectorXd components_of(const ModalBasis& basis, const Eigen::VectorXd& lengths);
[[nodiscard]] Eigen::VectorXd lengths_of(const ModalBasis& basis, const IntervalVector& components);

/// From above: the lengths in another basis.
[[nodiscard]] Eigen::VectorXd lengths_in(const ModalBasis& basis, const ModalBasis& old,
                                         const Eigen::VectorXd& lengths);

/// From above: the spectral norm of a matrix of at most 2 rows and columns, and its logarithmic norm if it is square.
[[nodiscard]] double spectral_norm(const IntervalMatrix& matrix);
[[nodiscard]] double logarithmic_norm(const IntervalMatrix& matrix);

}  // namespace verisq::stance
