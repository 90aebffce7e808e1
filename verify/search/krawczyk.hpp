/// Interval matrices and Krawczyk's test.
#pragma once

#include <Eigen/Core>
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <concepts>
#include <optional>
#include <stdexcept>

#include "verify/numbers/norms.hpp"
#include "verify/numbers/vector.hpp"

// Vectors and matrices of any size whose components are intervals: Eigen's.

template <class T>
struct Eigen::NumTraits<verisq::verify::BasicInterval<T>> : Eigen::GenericNumTraits<verisq::verify::BasicInterval<T>> {
  using Real = verisq::verify::BasicInterval<T>;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = Real;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = 2,
    AddCost = 8,
    MulCost = 16
  };
};

namespace verisq::verify {

// A block of a larger vector or matrix as one of three dimensions, and back.

template <class T>
[[nodiscard]] Eigen::Matrix<BasicInterval<T>, 3, 1> block(const Vector3<T>& v) {
  return {v[0], v[1], v[2]};
}

template <class T>
[[nodiscard]] Eigen::Matrix<BasicInterval<T>, 3, 3> block(const Matrix3<T>& m) {
  Eigen::Matrix<BasicInterval<T>, 3, 3> result;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) result(i, j) = m(i, j);
  }
  return result;
}

/// Components `first` to `first` + 2.
template <class T, int N>
[[nodiscard]] Vector3<T> three_of(const Eigen::Matrix<BasicInterval<T>, N, 1>& v, int first = 0) {
  return {v[first], v[first + 1], v[first + 2]};
}

// Krawczyk's operator: proves that a system of equations has exactly one zero in a box, and encloses it; or that a box
// has no two.

template <int N>
using IntervalVector = Eigen::Matrix<PreciseInterval, N, 1>;
template <int N>
using IntervalMatrix = Eigen::Matrix<PreciseInterval, N, N>;

/// Over a box V: F's values and Jacobians at all points of V.
template <int N>
struct SystemExpansion {
  IntervalVector<N> value;
  IntervalMatrix<N> jacobian;
};

/// A function F of N variables, N values. If F is not differentiable on all of a box, the Jacobian must be unbounded or
/// std::domain_error be thrown.
template <class System, int N>
concept ExpandableSystem = requires(const System& system, const IntervalVector<N>& box) {
  { system(box) } -> std::same_as<SystemExpansion<N>>;
};

namespace krawczyk_details {

/// Returns whether every component of `inner` lies in the interior of its counterpart.
template <int N>
[[nodiscard]] bool in_interior(const IntervalVector<N>& inner, const IntervalVector<N>& outer) {
  for (int i = 0; i < N; ++i) {
    if (!(inner[i].lower() > outer[i].lower() && inner[i].upper() < outer[i].upper())) return false;
  }
  return true;
}

/// A single point of the box.
template <int N>
[[nodiscard]] IntervalVector<N> lower_ends(const IntervalVector<N>& box) {
  IntervalVector<N> x;
  for (int i = 0; i < N; ++i) x[i] = box[i].lower();
  return x;
}

/// Twice as wide as the hull of `box` and `centre`, and some rounding errors more (epsilon-inflation).
template <int N>
[[nodiscard]] IntervalVector<N> inflated(const IntervalVector<N>& box, const IntervalVector<N>& centre) {
  const PreciseInterval rounding(Real(-0x1p-115), Real(0x1p-115));
  const PreciseInterval least(Real(-0x1p-1000), Real(0x1p-1000));
  IntervalVector<N> wide;
  for (int i = 0; i < N; ++i) {
    const Real radius = abs(PreciseInterval(box[i] - centre[i])).upper();
    wide[i] = centre[i] + PreciseInterval(2) * PreciseInterval(-radius, radius) + rounding * centre[i] + least;
  }
  return wide;
}

/// The inverse of the matrix of lower ends in 50 digits: near enough to an inverse of every matrix of a thin box.
template <int N>
[[nodiscard]] std::optional<IntervalMatrix<N>> approximate_inverse(const IntervalMatrix<N>& m) {
  Eigen::Matrix<FiftyDigits, N, N> centre;
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < N; ++j) centre(i, j) = to_fifty_digits(m(i, j).lower());
  }
  const Eigen::Matrix<FiftyDigits, N, N> inverse = centre.partialPivLu().inverse();
  IntervalMatrix<N> result;
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < N; ++j) {
      if (!isfinite(inverse(i, j))) return std::nullopt;
      result(i, j) = to_real(inverse(i, j));
    }
  }
  return result;
}

}  // namespace krawczyk_details

/// A box about `x` that contains exactly one zero of F; nothing if that is not proven. With m = x, any matrix Y and the
/// Jacobians J(V) over a box V about m,
///     K(V) = m - Y F(m) + (I - Y J(V)) (V - m)
/// contains every zero of F in V (mean value theorem, row by row). If it lies in the interior of V, there is exactly
/// one zero, and it lies in K(V) (Krawczyk 1969, Moore 1977). `x` should be near a zero: a few Newton steps refine it
/// first.
template <int N, ExpandableSystem<N> System>
[[nodiscard]] std::optional<IntervalVector<N>> krawczyk(const System& system,
                                                        const std::array<Real, static_cast<std::size_t>(N)>& x) {
  using namespace krawczyk_details;
  constexpr int refinements = 3;
  constexpr int most_inflations = 12;
  try {
    // Lazy products: Eigen's blocked ones, for larger matrices, compare scalars, which intervals do not.
    IntervalVector<N> m;
    for (int i = 0; i < N; ++i) m[i] = x[static_cast<std::size_t>(i)];
    std::optional<IntervalMatrix<N>> y;
    IntervalVector<N> newton;
    for (int i = 0; i <= refinements; ++i) {
      if (i > 0) m = lower_ends<N>(newton);
      const SystemExpansion<N> at_m = system(m);
      y = approximate_inverse<N>(at_m.jacobian);
      if (!y) return std::nullopt;
      newton = m - y->lazyProduct(at_m.value);
    }
    IntervalVector<N> image = newton;
    for (int i = 0; i < most_inflations; ++i) {
      const IntervalVector<N> box = inflated<N>(image, m);
      const IntervalMatrix<N> contraction = IntervalMatrix<N>::Identity() - y->lazyProduct(system(box).jacobian);
      image = newton + contraction.lazyProduct(IntervalVector<N>(box - m));
      if (in_interior<N>(image, box)) return image;
    }
  } catch (const std::domain_error&) {
    // F, or its derivative, is not defined on all of the box.
  }
  return std::nullopt;
}

/// Returns whether `box` is proven to contain no two zeros of F. For two zeros a and b, the mean value theorem gives,
/// row by row, 0 = Y (F(a) - F(b)) = Y J (a - b) with a J of J(V) over the box V. Hence a - b = (I - Y J)(a - b) for
/// any matrix Y. But that map makes |x| = max |x_i| / w_i smaller, for any w > 0, if |I - Y J(V)| w < w. The w are
/// proposed: the widths of the box, then the products of the matrix with them, which tend to its Perron vector.
/// `centre` is a point of the box about whose Jacobian Y is chosen.
template <int N, ExpandableSystem<N> System>
[[nodiscard]] bool contains_at_most_one_zero(const System& system, const IntervalVector<N>& centre,
                                             const IntervalVector<N>& box) {
  using namespace krawczyk_details;
  constexpr int proposals = 6;
  try {
    const auto y = approximate_inverse<N>(system(lower_ends<N>(centre)).jacobian);
    if (!y) return false;
    const IntervalMatrix<N> map = IntervalMatrix<N>::Identity() - y->lazyProduct(system(box).jacobian);
    IntervalVector<N> w;
    Real widest(0);
    for (int i = 0; i < N; ++i) {
      w[i] = (PreciseInterval(box[i].upper()) - PreciseInterval(box[i].lower())).upper();
      widest = std::max(widest, w[i].upper());
    }
    if (widest == Real(0)) return true;  // a single point
    for (int i = 0; i < N; ++i) w[i] = std::max(w[i].lower(), multiply(widest, Real(0x1p-20), Direction::up));
    for (int proposal = 0; proposal < proposals; ++proposal) {
      IntervalVector<N> image;
      bool smaller = true;
      for (int i = 0; i < N; ++i) {
        PreciseInterval sum(0);
        for (int j = 0; j < N; ++j) sum += abs(map(i, j)) * w[j];
        smaller = smaller && sum.upper() < w[i].lower();
        image[i] = sum.upper();
      }
      if (smaller) return true;
      for (int i = 0; i < N; ++i) w[i] = (w[i] + image[i]).upper();  // positive, as w is
    }
  } catch (const std::domain_error&) {
    // F, or its derivative, is not defined on all of the box.
  }
  return false;
}

// The equations of a point's orthogonal projection onto the surface of a superquadric, for Krawczyk's operator.

/// In the unknowns (p, λ) of the solid's own frame: p - q = λ Dg(p), g(p) = 1. With λ > 0 the point q lies beneath the
/// surface along its normal at p, with λ < 0 above it; both |p - q| and |λ| |Dg(p)| are the distance. The nearest point
/// p of the surface is a zero wherever g is differentiable at it: outside by the rule of multipliers, inside because
/// the ball about q touches the surface there, so that the only supporting plane is the ball's.
class ProjectionEquations {
 public:
  ProjectionEquations(const Superquadric& solid, const PreciseVector& q)
      : gauge_(NormFunction<PreciseInterval>::gauge(solid)),
        has_flat_faces_(solid.exponents[0] == 2.0 || solid.exponents[1] == 2.0),
        q_(q) {}

  /// g and its derivatives over a box. Throws std::domain_error if they are not defined on all of it. Between its
  /// planes of symmetry the gauge with an exponent p = 1 is smooth; the formula of its Hessian does not show the kinks
  /// in those planes.
  [[nodiscard]] NormExpansion<PreciseInterval> gauge(const PreciseVector& p) const {
    for (std::size_t k = 0; k < 3 && has_flat_faces_; ++k) {
      if (!(p[k].lower() > Real(0)) && !(p[k].upper() < Real(0))) throw std::domain_error("gauge: an edge");
    }
    return gauge_(p);
  }

  [[nodiscard]] SystemExpansion<4> operator()(const IntervalVector<4>& unknowns) const {
    const PreciseVector p = three_of(unknowns);
    const PreciseInterval& multiplier = unknowns[3];
    const NormExpansion<PreciseInterval> g = gauge(p);
    SystemExpansion<4> f;
    f.value.head<3>() = block(p - q_ - g.gradient * multiplier);
    f.value[3] = g.value - PreciseInterval(1);
    f.jacobian.topLeftCorner<3, 3>() = block(PreciseMatrix::identity() + -(g.hessian * multiplier));
    f.jacobian.topRightCorner<3, 1>() = block(-g.gradient);
    f.jacobian.bottomLeftCorner<1, 3>() = block(g.gradient).transpose();
    f.jacobian(3, 3) = PreciseInterval(0);
    return f;
  }

 private:
  NormFunction<PreciseInterval> gauge_;
  bool has_flat_faces_;
  PreciseVector q_;
};

}  // namespace verisq::verify
