/// Enclosures of solutions of linear systems, their contraction, modal bases.
#pragma once

#include <Eigen/Core>
#include <Eigen/Dense>
#include <optional>
#include <vector>

#include "verify/numbers/interval.hpp"
#include "verify/search/krawczyk.hpp"

namespace verisq::stance {

// Contracting linear maps of boxes: what proves that there is one solution, and encloses it (docs/stance.md §3).

using IntervalMatrix = Eigen::Matrix<verify::Interval, Eigen::Dynamic, Eigen::Dynamic>;
using IntervalVector = Eigen::Matrix<verify::Interval, Eigen::Dynamic, 1>;

/// Of the number of largest magnitude, from above.
[[nodiscard]] double magnitude(const verify::Interval& a);

[[nodiscard]] IntervalVector product(const Eigen::MatrixXd& m, const IntervalVector& v);
[[nodiscard]] IntervalVector product(const IntervalMatrix& m, const IntervalVector& v);
[[nodiscard]] IntervalMatrix product(const Eigen::MatrixXd& m, const IntervalMatrix& n);

[[nodiscard]] bool in_interior(const IntervalVector& inner, const IntervalVector& outer);

/// Weights w > 0 and a factor q < 1.
struct WeightedContraction {
  Eigen::VectorXd weights;
  double factor;
};

/// Proven: sizes w <= q diagonal w, component by component. Nothing where no such w is found, as where there is none.
/// Preconditions: sizes >= 0, diagonal > 0.
[[nodiscard]] std::optional<WeightedContraction> weighted_contraction(const Eigen::MatrixXd& sizes,
                                                                      const Eigen::VectorXd& diagonal);

/// Symmetric about 0, and so much wider than `errors` that a contraction shows.
[[nodiscard]] IntervalVector inflated(const IntervalVector& errors);

/// Contains the errors e that satisfy e = z + C e for some z and C within the intervals. K(E) = z + C E contains every
/// such e of E. If K(E) lies in the interior of E, which is symmetric, then |C| is a contraction in the norm scaled by
/// E's radii: there is exactly one e for each z and C, and it lies in E, in K(E), in K(K(E)) and so on (Rump 1983).
/// Nothing where no such E is found.
[[nodiscard]] std::optional<IntervalVector> fixed_points(const IntervalVector& z, const IntervalMatrix& c);

// Upper solutions of linear systems of differential inequalities u_i' <= sum of A_ij u_j + g_i whose couplings A_ij,
// i != j, and g are not negative: Mueller's theorem, stiff or not (docs/stance.md §9).

/// |u(t)| between the two at the ends of a step, on straight lines.
struct UpperSolution {
  Eigen::VectorXd start, end;
};

/// For all u >= 0 with u(0) <= initial: u(t) <= start + (t/length) (end - start) for t in [0, length], proven. Nothing
/// where none is found. Preconditions: as above; `initial` not negative; `length` contains that of the step, above 0.
[[nodiscard]] std::optional<UpperSolution> upper_solution(const Eigen::MatrixXd& rate, const Eigen::VectorXd& forcing,
                                                          const Eigen::VectorXd& initial,
                                                          const verify::Interval& length);

// Enclosures of the solutions of linear systems A(p) x = b(p) over a box of parameters p, and of their derivatives by
// p, by Krawczyk's operator with an approximate inverse at the box's centre (docs/stance.md §3; for parametric systems
// Rump 1994).

/// A and the residual b - A x of one x, at a point c of the box, and how they change.
struct ParametricLinearSystem {
  /// By one of the parameters.
  struct Variation {
    verify::Interval deviation;  ///< contains p_k - c_k, and 0
    IntervalMatrix matrix;       ///< contains the partial derivatives of A at all points of the box
    IntervalVector residual;     ///< of the residual
  };
  Eigen::VectorXd approximation;  ///< x, near the solution at c; any x is sound
  IntervalMatrix matrix;
  IntervalVector residual;
  std::vector<Variation> variations;
};

struct ParametricSolution {
  /// Contains the solution for every p of the box; the overestimation is of second order in the box's widths.
  IntervalVector solution;
  /// By variation: contains the solution's partial derivatives by that parameter at all points of the box.
  std::vector<IntervalVector> derivatives;
};

/// Nothing where it is not proven that A(p) is regular for every p. Precondition: the box is convex and contains c.
/// Throws std::domain_error for numbers beyond binary64.
[[nodiscard]] std::optional<ParametricSolution> solve(const ParametricLinearSystem& system);

/// By variation: how much it keeps `solve` from a proof. To compare with each other.
[[nodiscard]] std::vector<double> obstructions(const ParametricLinearSystem& system);

// Products of interval matrices by midpoints and radii: four ordinary products, and a bound of all rounding errors.

/// All matrices within `radius` of `midpoint`, entry by entry.
struct MidpointRadius {
  Eigen::MatrixXd midpoint, radius;

  MidpointRadius(const Eigen::MatrixXd& exact);     // NOLINT(google-explicit-constructor): a matrix is a thin one
  MidpointRadius(const IntervalMatrix& intervals);  // NOLINT(google-explicit-constructor): the same set or a larger one

  [[nodiscard]] IntervalMatrix intervals() const;

 private:
  MidpointRadius(Eigen::MatrixXd midpoint_of_all, Eigen::MatrixXd radius_of_all);
  friend MidpointRadius operator*(const MidpointRadius& a, const MidpointRadius& b);
};

/// Contains all products of the two. At most 1.5 times as wide as the narrowest that does, but for rounding (Rump 1999,
/// Fast and parallel interval arithmetic). Throws std::domain_error beyond binary64.
[[nodiscard]] MidpointRadius operator*(const MidpointRadius& a, const MidpointRadius& b);

// Real coordinates in which a linear system nearly falls apart into its modes: blocks of one, or of two for a pair of
// complex eigenvalues, each measured by its Euclidean length.

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
