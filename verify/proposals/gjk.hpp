/// The nearest points of two convex bodies, and normals between them, in floating point.
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>

#include "verify/proposals/support_mapping.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {

// The Gilbert-Johnson-Keerthi algorithm: closest points of two convex sets given by support mappings alone.
//
// It proposes and proves nothing: its directions and points go into certificates. The paper uses GJK through SOLID
// (§5.1). This one finds the closest point of a simplex by signed volumes (Montanari, Petrinic, Barbieri 2017). It ends
// in every case, because the distance must fall strictly from step to step. In binary64 it is accurate to rounding but
// for sets that nearly touch or hardly overlap. There the simplices are slivers, and it stalls at up to 1e-8 of the
// size for a point, 1e-5 for two solids, some thousand times less in long double.

/// `set(v)` is a point of a convex set where v·x is largest, for every v, zero included.
template <class Set, class Float>
concept SupportMapping = requires(const Set& set, const Coordinates<Float>& v) {
  { set(v) } -> std::same_as<Coordinates<Float>>;
};

/// GJK stops when |b - a| exceeds the distance by at most `relative` |b - a| + `absolute`. With both zero it works
/// until the rounding of Float stops it.
template <class Float>
struct GjkTolerance {
  Float relative = 0;
  Float absolute = 0;
  int most_steps = 200;
};

enum class GjkEnd {
  converged,  ///< within the tolerance
  common,     ///< the sets meet, or touch, as far as Float can tell
  stalled,    ///< no further progress: near the rounding error of Float, or of the support mappings
  exhausted,  ///< the step limit was reached
};

template <class Float>
struct GjkResult {
  Coordinates<Float> on_a;        ///< the closest points found; a common point each, but for rounding, where `common`
  Coordinates<Float> on_b;        ///<
  Coordinates<Float> separation;  ///< the direction from A to B with the best lower bound; it has any length but zero
  Float lower;  ///< the bound by `separation`, but for rounding; minus infinity if no direction was tried
  Float upper;  ///< |on_b - on_a|
  GjkEnd end;
  int steps;  ///< calls of each support mapping
};

/// A point of B - A with the points it comes from.
template <class Float>
struct GjkVertex {
  Coordinates<Float> on_a;
  Coordinates<Float> on_b;
  Coordinates<Float> difference;  ///< on_b - on_a
};

/// Up to four points of B - A: GJK's whole state.
template <class Float>
class GjkSimplex {
 public:
  explicit GjkSimplex(const GjkVertex<Float>& vertex);

  [[nodiscard]] bool contains(const Coordinates<Float>& difference) const;

  /// Adds a vertex, then drops the vertices that the point closest to the origin does not need. Precondition: fewer
  /// than four vertices.
  void add(const GjkVertex<Float>& vertex);

  /// Returns whether a tetrahedron is left: the origin lies in it.
  [[nodiscard]] bool full() const { return size_ == 4; }
  /// The point closest to the origin, and the points of A and B that it comes from.
  [[nodiscard]] GjkVertex<Float> closest() const;
  /// The largest |coordinate| of all vertices ever added, of A and of B: the scale of rounding errors.
  [[nodiscard]] Float scale() const { return scale_; }

 private:
  void measure(const GjkVertex<Float>& vertex);

  std::array<GjkVertex<Float>, 4> vertices_;
  std::array<Float, 4> weights_{1};
  std::size_t size_ = 1;
  Float scale_ = 0;
};

extern template class GjkSimplex<double>;
extern template class GjkSimplex<long double>;

/// `start` is a guess of the direction from A to B; it may be poor, or zero. Float is double or long double.
template <class Float, SupportMapping<Float> SetA, SupportMapping<Float> SetB>
[[nodiscard]] GjkResult<Float> gjk(const SetA& a, const SetB& b, const Coordinates<Float>& start,
                                   const GjkTolerance<Float>& tolerance = {}) {
  const auto support = [&](const Coordinates<Float>& v) {
    const Coordinates<Float> on_a = a(v);
    const Coordinates<Float> on_b = b({-v[0], -v[1], -v[2]});
    return GjkVertex<Float>{on_a, on_b, difference(on_b, on_a)};
  };
  GjkSimplex<Float> simplex(support(start));
  GjkVertex<Float> best = simplex.closest();
  Coordinates<Float> v = best.difference;
  GjkResult<Float> result{
      best.on_a, best.on_b, v, -std::numeric_limits<Float>::infinity(), std::sqrt(dot(v, v)), GjkEnd::exhausted, 1};
  while (result.steps < tolerance.most_steps) {
    // Touching: the length of v is rounding error, and so is its direction.
    if (result.upper <= 4 * std::numeric_limits<Float>::epsilon() * simplex.scale()) {
      result.end = GjkEnd::common;
      return result;
    }
    const GjkVertex<Float> vertex = support(v);
    ++result.steps;
    // B - A lies in the half-space {x : v·x >= v·w}, w being its support point against v.
    const Float lower = dot(v, vertex.difference) / result.upper;
    if (lower > result.lower) {
      result.lower = lower;
      result.separation = v;
    }
    if (result.upper - result.lower <= tolerance.relative * result.upper + tolerance.absolute) {
      result.end = GjkEnd::converged;
      return result;
    }
    result.end = GjkEnd::stalled;
    // A vertex found again cannot bring the simplex closer: without this test rounding errors let GJK cycle.
    if (simplex.contains(vertex.difference)) return result;
    simplex.add(vertex);
    best = simplex.closest();
    v = best.difference;
    const Float upper = std::sqrt(dot(v, v));
    if (!(upper < result.upper)) return result;
    result.on_a = best.on_a;
    result.on_b = best.on_b;
    result.upper = upper;
    result.end = simplex.full() ? GjkEnd::common : GjkEnd::exhausted;
    if (simplex.full()) return result;
  }
  return result;
}

// The best of some normals that may separate two convex sets, in plain floating point. Proposes, proves nothing.

/// Of all offered normals keeps the one along which B lies farthest beyond A.
template <SupportMapping<double> SetA, SupportMapping<double> SetB>
class BestNormal {
 public:
  /// Both have to outlive this.
  BestNormal(const SetA& a, const SetB& b) : a_(a), b_(b) {}

  /// Offers a normal of any length. A normal along which numbers overflow is ignored.
  void offer(const Coordinates<double>& n) {
    const double gap = (dot(n, b_({-n[0], -n[1], -n[2]})) - dot(n, a_(n))) / std::sqrt(dot(n, n));
    if (!(gap > gap_)) return;
    normal_ = n;
    gap_ = gap;
  }

  /// Offers the normal of a triangle, and its opposite.
  void offer_normals_of(const std::array<Coordinates<double>, 3>& corners) {
    const Coordinates<double> n = cross(difference(corners[1], corners[0]), difference(corners[2], corners[0]));
    offer(n);
    offer({-n[0], -n[1], -n[2]});
  }

  /// Zero before one was offered.
  [[nodiscard]] const Coordinates<double>& normal() const { return normal_; }
  /// About how far that is; negative where the sets are not apart along it.
  [[nodiscard]] double gap() const { return gap_; }

 private:
  const SetA& a_;
  const SetB& b_;
  Coordinates<double> normal_{};
  double gap_ = -std::numeric_limits<double>::infinity();
};

// The normal of a superquadric where it is nearest to a point, in plain floating point. Proposes, proves nothing.

/// Tapered or not, not bent.
class NearestNormal {
 public:
  explicit NearestNormal(const Superquadric& solid);

  struct Found {
    Coordinates<double> normal;  ///< of length 1; zero where nothing was found
    double distance;             ///< signed, about
  };

  /// q is in the solid's own frame, whose origin is its focus. The search is by GJK for points outside, by the shortest
  /// walk found for points inside.
  [[nodiscard]] Found operator()(const Coordinates<double>& q) const;

 private:
  [[nodiscard]] Found from_outside(const Coordinates<double>& q) const;

  SuperquadricSet<double> set_;
  Boundary<double> boundary_;
  bool tapered_;
};

}  // namespace verisq::verify
