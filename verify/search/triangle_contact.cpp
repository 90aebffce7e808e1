/// Face in closed form, edges by monotone roots; first in double, where that is not enough in long double.
#include "verify/search/triangle_contact.hpp"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "verify/proposals/support_mapping.hpp"
#include "verify/proposals/triangle.hpp"
#include "verify/search/certified_distance.hpp"
#include "verify/search/contact_problem.hpp"
#include "verify/search/tapered_contact_problem.hpp"

namespace verisq::verify {

namespace {

/// To binary64 without leaving the triangle.
Weights rounded(long double first, long double second) {
  Weights weights{static_cast<double>(std::clamp(first, 0.0L, 1.0L)),
                  static_cast<double>(std::clamp(second, 0.0L, 1.0L))};
  double& larger = weights[0] < weights[1] ? weights[1] : weights[0];
  while (!in_triangle(weights)) larger = std::nextafter(larger, 0.0);
  return weights;
}

/// The point at s between corners i and i + 1. On the edge between corners 1 and 2 the weights add up to 1 exactly,
/// because the difference of 1 and the larger one is a binary64 number.
Weights on_edge(std::size_t i, long double s) {
  if (i == 0) return {static_cast<double>(s), 0.0};
  if (i == 2) return {0.0, static_cast<double>(1.0L - s)};
  const auto larger = static_cast<double>(std::max(s, 1.0L - s));
  const double smaller = 1.0 - larger;
  return s < 0.5L ? Weights{larger, smaller} : Weights{smaller, larger};
}

/// The candidate in the interior; none if it lies outside the triangle.
std::optional<Weights> face_point(const Superquadric& solid, const std::array<Proposal, 3>& corners,
                                  const Proposal& normal) {
  const long double offset = dot(normal, corners[0]);
  const long double side = offset < 0.0L ? -1.0L : 1.0L;
  Proposal x = SuperquadricSet<long double>(solid)({side * normal[0], side * normal[1], side * normal[2]});
  const long double support = side * dot(normal, x);
  if (side * offset <= support) x = along(Proposal{}, x, side * offset / support);
  const Proposal from_corner = difference(x, corners[0]);
  const long double squared = dot(normal, normal);
  const long double first = dot(normal, cross(from_corner, difference(corners[2], corners[0]))) / squared;
  const long double second = dot(normal, cross(difference(corners[1], corners[0]), from_corner)) / squared;
  if (!(first >= 0.0L && second >= 0.0L && first + second <= 1.0L)) return std::nullopt;
  return rounded(first, second);
}

template <class Float>
class BoundarySearch {
 public:
  using Vector = Coordinates<Float>;

  BoundarySearch(const Superquadric& solid, const std::array<Proposal, 3>& corners) : solid_(solid) {
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t k = 0; k < 3; ++k) corners_[i][k] = static_cast<Float>(corners[i][k]);
    }
  }

  /// The closest points of edges, those in question only, then one in the interior.
  bool offer(const std::function<bool(const Weights&)>& enough) const {
    std::optional<EdgePoint> nearest;
    for (const std::size_t i : edges_by_distance()) {
      const EdgePoint point = closest_on_edge(i);
      if (point.optimal && enough(point.weights)) return true;
      if (!point.optimal && (!nearest || point.squared_distance < nearest->squared_distance)) nearest = point;
    }
    return (nearest && enough(nearest->weights)) || enough(closest_in_interior());
  }

 private:
  struct Gradient {
    Vector vector;  ///< of f outside the solid, along that of the gauge inside
    bool inside;    ///< or so close to the surface that Float cannot tell
  };

  struct EdgePoint {
    Weights weights;
    Float squared_distance;
    bool optimal;  ///< no other point of the triangle is closer, as far as Float can tell
  };

  [[nodiscard]] Gradient gradient(const Vector& q) const {
    const Proposal point{q[0], q[1], q[2]};
    const Contact contact = this->contact(point);
    return {{static_cast<Float>(contact.normal[0]), static_cast<Float>(contact.normal[1]),
             static_cast<Float>(contact.normal[2])},
            contact.point == point};
  }

  [[nodiscard]] Contact contact(const Proposal& q) const {
    constexpr auto resolution = logarithmic::kResolution<Float>;
    return is_tapered(solid_) ? logarithmic::TaperedContactProblem<Float>(solid_, q, resolution).solve()
                              : logarithmic::ContactProblem<Float>(solid_, q, resolution).solve();
  }

  /// v·step, or 0 where that is rounding error.
  [[nodiscard]] static Float slope(const Vector& v, const Vector& step) {
    const Float value = dot(v, step);
    const Float noise = 4 * std::numeric_limits<Float>::epsilon() * std::sqrt(dot(v, v) * dot(step, step));
    return std::fabs(value) > noise ? value : Float(0);
  }

  /// The zero of a monotone function in [0, 1], or the end where it comes closest to zero.
  template <class Derivative>
  [[nodiscard]] static Float root(const Derivative& derivative) {
    const Float at_0 = derivative(Float(0));
    if (!(at_0 < 0)) return 0;
    const Float at_1 = derivative(Float(1));
    if (!(at_1 > 0)) return 1;
    constexpr Float finest = 2 * std::numeric_limits<Float>::epsilon();
    const auto narrow = [](Float low, Float high) { return high - low <= finest; };
    std::uintmax_t evaluations = 100;
    const auto bracket =
        boost::math::tools::toms748_solve(derivative, Float(0), Float(1), at_0, at_1, narrow, evaluations);
    return (bracket.first + bracket.second) / 2;
  }

  /// The edges near the solid first, in units of the semi-axes.
  [[nodiscard]] std::array<std::size_t, 3> edges_by_distance() const {
    std::array<Vector, 3> scaled = corners_;
    for (Vector& corner : scaled) {
      for (std::size_t k = 0; k < 3; ++k) corner[k] /= static_cast<Float>(solid_.semi_axes[k]);
    }
    std::array<Float, 3> distances;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector closest = closest_to_origin(scaled[i], scaled[(i + 1) % 3]);
      distances[i] = dot(closest, closest);
    }
    std::array<std::size_t, 3> order{0, 1, 2};
    std::ranges::sort(order, {}, [&](std::size_t i) { return distances[i]; });
    return order;
  }

  [[nodiscard]] EdgePoint closest_on_edge(std::size_t i) const {
    const Vector& start = corners_[i];
    const Vector edge = difference(corners_[(i + 1) % 3], start);
    const Float s = root([&](Float at) { return slope(gradient(along(start, edge, at)).vector, edge); });
    const Vector q = along(start, edge, s);
    const auto [v, inside] = gradient(q);
    const bool optimal = inside || !(slope(v, difference(corners_[(i + 2) % 3], q)) < 0);
    return {on_edge(i, s), inside ? Float(0) : dot(v, v), optimal};
  }

  /// Least over the segments parallel to the first edge: that of each is a convex function of its height.
  [[nodiscard]] Weights closest_in_interior() const {
    const Vector first = difference(corners_[1], corners_[0]);
    const Vector second = difference(corners_[2], corners_[0]);
    const auto closest_at = [&](Float height) {
      const Vector start = along(corners_[0], second, height);
      const Vector segment = along(Vector{}, first, 1 - height);
      return root([&](Float at) { return slope(gradient(along(start, segment, at)).vector, segment); });
    };
    const Float height = root([&](Float at) {
      const Float s = closest_at(at);
      const Vector upwards = along(second, first, -s);
      return slope(gradient(along(along(corners_[0], second, at), first, s * (1 - at))).vector, upwards);
    });
    return rounded(closest_at(height) * (1 - height), height);
  }

  const Superquadric& solid_;
  std::array<Vector, 3> corners_;
};

}  // namespace

void offer_closest_points(const Superquadric& solid, const std::array<Proposal, 3>& corners, const Proposal& normal,
                          const std::function<bool(const Weights&)>& enough) {
  const std::optional<Weights> face = face_point(solid, corners, normal);
  if (face && enough(*face)) return;
  if (BoundarySearch<double>(solid, corners).offer(enough)) return;
  BoundarySearch<long double>(solid, corners).offer(enough);
}

}  // namespace verisq::verify
