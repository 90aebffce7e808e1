/// The contacts of pairs of model_distance.hpp.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "verify/numbers/norms.hpp"
#include "verify/proposals/gjk.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verify/search/contact.hpp"
#include "verify/search/model_distance.hpp"
#include "verify/search/pair_projection.hpp"
#include "verify/solids/superquadric.hpp"

namespace verisq::verify {

namespace {

template <class Float>
using Vector = Eigen::Matrix<Float, 3, 1>;
template <class Float>
using Matrix = Eigen::Matrix<Float, 3, 3>;

/// The motion from B's frame to A's in floating point, in units of `unit`.
template <class Float>
struct Relative {
  Matrix<Float> rotation;
  Vector<Float> offset;

  explicit Relative(const RigidMotion& motion, double unit) {
    const auto middle = [](const PreciseInterval& x) {
      if constexpr (std::is_same_v<Float, FiftyDigits>) {
        return to_fifty_digits(x.lower());
      } else {
        return static_cast<Float>(x.lower().to_long_double());
      }
    };
    for (int i = 0; i < 3; ++i) {
      offset[i] = middle(motion.translation[i]) / static_cast<Float>(unit);
      for (int j = 0; j < 3; ++j) rotation(i, j) = middle(motion.rotation(i, j));
    }
  }
};

/// A power of two near the largest semi-axis: in units of it nothing overflows unnecessarily, and scaling is exact.
double unit_of(const Superquadric& a, const Superquadric& b) {
  int exponent = 0;
  std::frexp(std::max(std::ranges::max(a.semi_axes), std::ranges::max(b.semi_axes)), &exponent);
  return std::ldexp(1.0, std::clamp(exponent, -1000, 1000));
}

Superquadric scaled(Superquadric solid, double unit) {
  for (double& axis : solid.semi_axes) axis /= unit;
  return solid;
}

template <class Float>
Vector<Float> vector_of(const std::array<Float, 3>& x) {
  return {x[0], x[1], x[2]};
}

template <class Float>
Proposal proposal_of(const Vector<Float>& x, long double unit = 1.0L) {
  return {unit * x[0], unit * x[1], unit * x[2]};
}

template <class Float>
bool finite(const Vector<Float>& x) {
  using std::isfinite;
  return isfinite(x[0]) && isfinite(x[1]) && isfinite(x[2]);
}

/// Closest points a and b, and a vector whose lower bound is near their distance.
template <class Float>
struct Estimate {
  Vector<Float> vector;
  Vector<Float> on_a;
  Vector<Float> on_b;  ///< in B's frame
};

/// ψ and its derivatives.
template <class Float>
class SeparationProblem {
 public:
  SeparationProblem(const Superquadric& a, const Superquadric& b, const Relative<Float>& relative)
      : a_(NormFunction<Float>::support(a)), b_(NormFunction<Float>::support_of_reflected(b)), relative_(relative) {}

  struct State {
    Vector<Float> v;
    NormExpansion<Float> a;
    NormExpansion<Float> b;  ///< the expansion of -B at R^T v: B's support point against v is minus its support point
    Vector<Float> residual;  ///< F(v)
    Float value;             ///< ψ(v)
  };

  [[nodiscard]] State at(const Vector<Float>& v) const {
    State s{v, a_(v), b_(Vector<Float>(relative_.rotation.transpose() * v)), {}, {}};
    s.residual = v - relative_.offset + s.a.gradient + relative_.rotation * s.b.gradient;
    s.value = v.dot(v) / 2 - v.dot(relative_.offset) + s.a.value + s.b.value;
    return s;
  }

  /// The largest lower bound, negative where v does not separate.
  [[nodiscard]] Float lower(const Vector<Float>& v) const {
    const State s = at(v);
    return (v.dot(relative_.offset) - s.a.value - s.b.value) / v.norm();
  }

  /// Damped Newton's method; `good` decides when the gap is closed.
  template <class Good>
  [[nodiscard]] State minimise(const Vector<Float>& start, const Good& good) const {
    State s = at(start);
    for (int i = 0; i < kMostSteps && !good(s); ++i) {
      const Matrix<Float> jacobian =
          Matrix<Float>::Identity() + s.a.hessian + relative_.rotation * s.b.hessian * relative_.rotation.transpose();
      const Vector<Float> step = -jacobian.llt().solve(s.residual);
      if (!finite<Float>(step)) break;
      const std::optional<State> next = along(s, step);
      if (!next) break;
      s = *next;
    }
    return s;
  }

 private:
  static constexpr int kMostSteps = 20;
  static constexpr int kMostCuts = 8;

  /// The first of the steps 1, 1/4, ... that lowers ψ, or the residual where ψ is at its rounding error.
  [[nodiscard]] std::optional<State> along(const State& s, const Vector<Float>& step) const {
    Float length = 1;
    for (int cut = 0; cut < kMostCuts; ++cut, length /= 4) {
      State next = at(s.v + length * step);
      if (next.value < s.value || next.residual.squaredNorm() < s.residual.squaredNorm() / 4) return next;
    }
    return std::nullopt;
  }

  NormFunction<Float> a_;
  NormFunction<Float> b_;
  Relative<Float> relative_;
};

using Point3 = Vector<long double>;

/// The midpoint m: φ(m) = (d_A(m)^2 + d_B(m)^2) / 2 is convex with the gradient (m - P_A m) + (m - P_B m); P is the
/// projection, and with v = m - P m its derivative I - DP = (I + D^2h(v))^-1, because m = v + s(v) (Moreau).
class MidpointProblem {
 public:
  using Projection = Contact (*)(const Superquadric&, const Proposal&);

  MidpointProblem(const Superquadric& a, const Superquadric& b, const Relative<long double>& relative,
                  Projection projection)
      : a_(&a),
        b_(&b),
        support_a_(NormFunction<long double>::support(a)),
        support_b_(NormFunction<long double>::support(b)),
        relative_(relative),
        project_(projection) {}

  struct State {
    Point3 m;
    Point3 on_a, on_b;          ///< projections, each in its solid's frame
    Point3 normal_a, normal_b;  ///< m - P m, each in its solid's frame, every component accurate relative to itself
    Point3 gradient;
    long double value;
  };

  [[nodiscard]] State at(const Point3& m) const {
    State s;
    s.m = m;
    const Point3 in_b = relative_.rotation.transpose() * (m - relative_.offset);
    project(*a_, m, s.on_a, s.normal_a);
    project(*b_, in_b, s.on_b, s.normal_b);
    s.gradient = s.normal_a + relative_.rotation * s.normal_b;
    s.value = (s.normal_a.squaredNorm() + s.normal_b.squaredNorm()) / 2;
    return s;
  }

  [[nodiscard]] State minimise(const Point3& start) const {
    State s = at(start);
    for (int i = 0; i < kMostSteps && s.value > 0; ++i) {
      if (s.gradient.squaredNorm() <= 1e-32L * s.value) break;
      const Matrix<long double> hessian =
          stiffness(support_a_, s.normal_a) + stiffness_b(s.normal_b) + 1e-18L * Matrix<long double>::Identity();
      const Point3 step = -hessian.llt().solve(s.gradient);
      if (!step.allFinite()) break;
      const std::optional<State> next = along(s, step);
      if (!next) break;
      s = *next;
    }
    return s;
  }

 private:
  static constexpr int kMostSteps = 40;
  static constexpr int kMostCuts = 12;

  void project(const Superquadric& solid, const Point3& q, Point3& point, Point3& normal) const {
    const Contact contact = project_(solid, proposal_of<long double>(q));
    point = vector_of(contact.point);
    normal = q - point;
    // For q inside, the contact's point is q and its normal of any length.
    if (normal.squaredNorm() > 0) {
      const Point3 direction = vector_of(contact.normal);
      normal = direction * (normal.norm() / direction.norm());
    }
  }

  [[nodiscard]] static Matrix<long double> stiffness(const NormFunction<long double>& h, const Point3& v) {
    if (!(v.squaredNorm() > 0)) return Matrix<long double>::Zero();
    const Matrix<long double> m = Matrix<long double>::Identity() + h(v).hessian;
    const Matrix<long double> inverse = m.llt().solve(Matrix<long double>::Identity());
    return inverse.allFinite() ? inverse : Matrix<long double>::Identity();
  }

  [[nodiscard]] Matrix<long double> stiffness_b(const Point3& v) const {
    return relative_.rotation * stiffness(support_b_, v) * relative_.rotation.transpose();
  }

  [[nodiscard]] std::optional<State> along(const State& s, const Point3& step) const {
    long double length = 1;
    for (int cut = 0; cut < kMostCuts; ++cut, length /= 2) {
      const State next = at(s.m + length * step);
      if (next.value < s.value || next.gradient.squaredNorm() < s.gradient.squaredNorm() / 4) return next;
    }
    return std::nullopt;
  }

  const Superquadric* a_;
  const Superquadric* b_;
  NormFunction<long double> support_a_;
  NormFunction<long double> support_b_;
  Relative<long double> relative_;
  Projection project_;
};

/// Returns whether support points jump from one direction to another. Then the derivatives of the support function are
/// those of a nearby solid (norms.hpp).
bool has_facets(const Superquadric& solid) {
  return solid.exponents[0] == 2.0 || solid.exponents[1] == 2.0;
}

/// Relative gaps at which GJK leaves the rest to Newton's method.
constexpr double kRough = 1e-3;
constexpr double kFine = 1e-13;

/// One pair in units of its larger solid.
class PairSolver {
 public:
  PairSolver(const Superquadric& a, const Superquadric& b, const RigidMotion& motion)
      : unit_(unit_of(a, b)),
        a_(scaled(a, unit_)),
        b_(scaled(b, unit_)),
        relative_(motion, unit_),
        precise_relative_(motion, unit_) {}

  [[nodiscard]] PairContact fast() const {
    const GjkResult<double> start = approximate(kRough);
    if (!(start.lower > 0)) {
      if (const auto common = common_point(a_, b_, relative_.rotation, relative_.offset)) return overlap(*common);
      return by_midpoint(start, fast_contact);
    }
    if (tapered()) {  // what finds midpoints in binary64 knows no taper
      if (has_facets(a_) || has_facets(b_)) return by_midpoint(approximate(kFine), fast_contact);
    } else {
      const Vector<double> middle = (vector_of(start.on_a) + vector_of(start.on_b)) / 2;
      if (const auto found = midpoint_contact(a_, b_, relative_.rotation, relative_.offset, middle))
        return contact<double>({found->vector, found->on_a, found->on_b});
    }
    if (const std::optional<PairContact> found = by_vector(start)) return *found;
    const GjkResult<double> finer = approximate(kFine);
    if (!(finer.lower > start.lower)) return by_midpoint(start, fast_contact);
    if (const std::optional<PairContact> found = by_vector(finer)) return *found;
    return by_midpoint(finer, fast_contact);
  }

  [[nodiscard]] PairContact thorough() const { return by_midpoint(approximate(kFine), thorough_contact); }

  [[nodiscard]] std::optional<PreciseContact> refined(const RigidMotion& motion, const PreciseVector& start) const {
    const SeparationProblem<FiftyDigits> problem(a_, b_, Relative<FiftyDigits>(motion, unit_));
    const auto good = [](const auto& s) {
      return s.residual.squaredNorm() <= FiftyDigits(1e-84) * (1 + s.v.squaredNorm());
    };
    Vector<FiftyDigits> v;
    for (int i = 0; i < 3; ++i) v[i] = to_fifty_digits(start[i].lower());
    const auto s = problem.minimise(v * FiftyDigits(problem.lower(v) / v.norm()), good);
    if (!finite(s.v) || !finite(s.a.gradient) || !finite(s.b.gradient) || s.v.isZero(0)) return std::nullopt;
    return PreciseContact{in_proofs(s.v), in_proofs(s.a.gradient), in_proofs(-s.b.gradient)};
  }

  [[nodiscard]] std::array<PreciseContact, 3> projected(const RigidMotion& motion) const {
    const auto s = midpoint_state(approximate(kFine), thorough_contact);
    const Relative<FiftyDigits> relative(motion, unit_);
    const Vector<FiftyDigits> on_a = s.on_a.cast<FiftyDigits>();
    const Vector<FiftyDigits> on_b = s.on_b.cast<FiftyDigits>();
    const Vector<FiftyDigits> between = relative.rotation * on_b + relative.offset - on_a;
    const Vector<FiftyDigits> normal_a = s.normal_a.cast<FiftyDigits>();
    const Vector<FiftyDigits> normal_b = -(relative.rotation * s.normal_b.cast<FiftyDigits>());
    const auto contact = [&](const Vector<FiftyDigits>& v) {
      return PreciseContact{in_proofs(v), in_proofs(on_a), in_proofs(on_b)};
    };
    return {contact(between), contact(normal_a), contact(normal_b)};
  }

 private:
  [[nodiscard]] bool tapered() const { return is_tapered(a_) || is_tapered(b_); }

  [[nodiscard]] PreciseVector in_proofs(const Vector<FiftyDigits>& x) const {
    return {to_real(FiftyDigits(x[0] * unit_)), to_real(FiftyDigits(x[1] * unit_)), to_real(FiftyDigits(x[2] * unit_))};
  }

  [[nodiscard]] MidpointProblem::State midpoint_state(const GjkResult<double>& start,
                                                      MidpointProblem::Projection projection) const {
    const MidpointProblem problem(a_, b_, precise_relative_, projection);
    const Point3 middle = (vector_of(start.on_a) + vector_of(start.on_b)).cast<long double>() / 2;
    // In 50 digits closest points of tapered solids take milliseconds each: few of them are computed, from a better
    // start.
    if (projection == thorough_contact && tapered()) return problem.minimise(midpoint_state(start, fast_contact).m);
    return problem.minimise(middle);
  }

  [[nodiscard]] GjkResult<double> approximate(double relative_gap) const {
    const SuperquadricSet<double> own_a(a_);
    const SuperquadricSet<double> own_b(b_);
    const auto set_b = [&](const Coordinates<double>& v) {
      const Vector<double> w = relative_.rotation.transpose() * vector_of(v);
      const Vector<double> x = relative_.rotation * vector_of(own_b({w[0], w[1], w[2]})) + relative_.offset;
      return Coordinates<double>{x[0], x[1], x[2]};
    };
    const auto& c = relative_.offset;
    return gjk<double>(own_a, set_b, {c[0], c[1], c[2]}, {.relative = relative_gap, .absolute = 0, .most_steps = 200});
  }

  [[nodiscard]] std::optional<PairContact> by_vector(const GjkResult<double>& start) const {
    const SeparationProblem<double> problem(a_, b_, relative_);
    const auto good = [](const auto& s) {
      const double length = s.v.norm();
      return s.residual.squaredNorm() <= 1e-17 * length * std::max(1.0, length);
    };
    const Vector<double> direction = vector_of(start.separation);
    const auto s = problem.minimise(direction * (start.lower / direction.norm()), good);
    if (!good(s)) return std::nullopt;
    return contact<double>({s.v, s.a.gradient, -s.b.gradient});
  }

  [[nodiscard]] PairContact by_midpoint(const GjkResult<double>& start, MidpointProblem::Projection projection) const {
    const MidpointProblem::State s = midpoint_state(start, projection);
    return contact<long double>({best_vector(s, start), s.on_a, s.on_b});
  }

  /// Each solid's own normal has the accurate small components that its faces need: the best of all decides.
  [[nodiscard]] Point3 best_vector(const MidpointProblem::State& s, const GjkResult<double>& start) const {
    const SeparationProblem<long double> problem(a_, b_, precise_relative_);
    const Point3 apart = precise_relative_.rotation * s.on_b + precise_relative_.offset - s.on_a;
    Point3 best = vector_of(start.separation).cast<long double>();
    long double highest = best.norm() > 0 ? problem.lower(best) : -std::numeric_limits<long double>::infinity();
    for (const Point3& v : {apart, s.normal_a, Point3(-(precise_relative_.rotation * s.normal_b))}) {
      if (!(v.norm() > 0)) continue;
      const long double bound = problem.lower(v);
      if (!(bound > highest)) continue;
      highest = bound;
      best = v;
    }
    return best;
  }

  template <class Float>
  [[nodiscard]] PairContact contact(const Estimate<Float>& e) const {
    return {proposal_of<Float>(e.vector, unit_), proposal_of<Float>(e.on_a, unit_), proposal_of<Float>(e.on_b, unit_),
            std::nullopt};
  }

  [[nodiscard]] PairContact overlap(const Vector<double>& common) const {
    return {{}, {}, {}, proposal_of<double>(common, unit_)};
  }

  double unit_;
  Superquadric a_;
  Superquadric b_;
  Relative<double> relative_;
  Relative<long double> precise_relative_;
};

}  // namespace

PairContact fast_pair_contact(const Superquadric& a, const Superquadric& b, const RigidMotion& relative) {
  return PairSolver(a, b, relative).fast();
}

PairContact thorough_pair_contact(const Superquadric& a, const Superquadric& b, const RigidMotion& relative) {
  return PairSolver(a, b, relative).thorough();
}

std::optional<PreciseContact> refined_pair_contact(const Superquadric& a, const Superquadric& b,
                                                   const RigidMotion& relative, const PreciseVector& start) {
  release_mpfr_cache_at_thread_exit();
  return PairSolver(a, b, relative).refined(relative, start);
}

std::array<PreciseContact, 3> projected_pair_contacts(const Superquadric& a, const Superquadric& b,
                                                      const RigidMotion& relative) {
  release_mpfr_cache_at_thread_exit();
  return PairSolver(a, b, relative).projected(relative);
}

}  // namespace verisq::verify
