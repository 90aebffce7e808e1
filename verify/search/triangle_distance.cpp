/// Distances of triangles to unions of convex solids.
#include <algorithm>
#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "verify/proof/exact_checker.hpp"
#include "verify/proof/posed_superquadric.hpp"
#include "verify/proof/verdict.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verify/search/certified_distance.hpp"
#include "verify/search/contact.hpp"
#include "verify/solids/model.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::verify {
namespace {

/// Rounds to binary64 without leaving the triangle.
Weights rounded_weights(long double first, long double second) {
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
  return rounded_weights(first, second);
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
    Vector vector;  ///< gradient of f outside the solid, along the gradient of the gauge inside
    bool inside;    ///< or so close to the surface that Float cannot decide
  };

  struct EdgePoint {
    Weights weights;
    Float squared_distance;
    bool optimal;  ///< no other point of the triangle is closer, to the accuracy of Float
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
    return rounded_weights(closest_at(height) * (1 - height), height);
  }

  const Superquadric& solid_;
  std::array<Vector, 3> corners_;
};

/// Offers weights of points, the most promising first, until `enough` returns true. Corners and the normal of the
/// triangle's plane, of any length, in the solid's frame; a degenerate triangle may come with any normal.
void offer_closest_points(const Superquadric& solid, const std::array<Proposal, 3>& corners, const Proposal& normal,
                          const std::function<bool(const Weights&)>& enough) {
  const std::optional<Weights> face = face_point(solid, corners, normal);
  if (face && enough(*face)) return;
  if (BoundarySearch<double>(solid, corners).offer(enough)) return;
  BoundarySearch<long double>(solid, corners).offer(enough);
}

}  // namespace
}  // namespace verisq::verify

namespace verisq {
namespace {

using namespace verify;

constexpr double kShortest = 0x1p-900;  // of a vector whose components are normal numbers, unless they do not matter

/// The proven distance of one primitive, and the vectors that prove it.
struct ProvenDistance {
  Enclosure distance{0.0, infinity};
  Weights weights{};
  Proposal upper_normal{};  ///< of the point with these weights
  Proposal lower_normal{};
};

Proposal normal_of_plane(const std::array<PreciseVector, 3>& corners) {
  const PreciseVector a = corners[1] - corners[0];
  const PreciseVector b = corners[2] - corners[0];
  return midpoint({a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]});
}

/// The part of v that is orthogonal to an edge.
Proposal projected(const Proposal& v, const Proposal& edge) {
  const long double squared = dot(edge, edge);
  return squared > 0.0L ? along(v, edge, -dot(v, edge) / squared) : v;
}

class TriangleProof {
 public:
  TriangleProof(const PosedSuperquadric& solid, const Triangle& triangle)
      : solid_(solid), triangle_(triangle, solid.motion()), normal_(normal_of_plane(triangle_.corners())) {
    const auto& corners = triangle_.corners();
    for (std::size_t i = 0; i < 3; ++i) {
      corners_[i] = midpoint(corners[i]);
      edges_[i] = midpoint(PreciseVector(corners[(i + 1) % 3] - corners[i]));
      for (const long double c : corners_[i]) reach_ = std::max(reach_, std::fabs(c));
    }
  }

  [[nodiscard]] ProvenDistance operator()() {
    const auto enough = [&](const Weights& weights) {
      prove(weights, fast_contact);
      return closed();
    };
    offer_closest_points(solid_.superquadric(), corners_, normal_, enough);
    if (!closed()) prove(proven_.weights, thorough_contact);
    if (!closed()) fall_back();
    return proven_;
  }

 private:
  /// Returns whether the remaining width is of the order of rounding: else a better proposal is worth a search.
  [[nodiscard]] bool closed() const {
    constexpr long double of_distance = 1e-14L;
    constexpr long double of_corners = 0x1p-60L;
    const long double size = std::max(std::ranges::max(solid_.superquadric().semi_axes), proven_.distance.hi);
    return proven_.distance.width() <= of_distance * size + of_corners * reach_;
  }

  using Solver = Contact (*)(const Superquadric&, const Proposal&);

  void offer_upper(const Weights& weights, const PreciseVector& q, const Proposal& v) {
    const double hi = upper_by_point(solid_, q, v);
    if (!(hi < proven_.distance.hi)) return;
    proven_.distance.hi = hi;
    proven_.weights = weights;
    proven_.upper_normal = v;
  }

  /// The vector from the closest point to q. Inside and on the surface, where the contact's normal is only a direction:
  /// a very short vector, which leads back to q itself, scaled to the surface.
  [[nodiscard]] static Proposal normal_at(const Proposal& q, const Contact& found) {
    return found.point == q ? along(Proposal{}, found.normal, static_cast<long double>(kShortest)) : found.normal;
  }

  /// For any proposal: no bound is looser than the bounds by the corners as points, by the solid's box and by the ball
  /// about it.
  void fall_back() {
    constexpr std::array<Weights, 3> at_corners{{{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}};
    for (const Weights& weights : at_corners) prove(weights, fast_contact);
    // No half-space with this normal is tighter than the supporting one, not even the one that touches the ball.
    offer_lower(proposed::closest_to_origin(corners_));
    for (std::size_t i = 0; i < 3; ++i) {
      Proposal axis{};
      axis[i] = 1.0L;
      offer_lower(axis);
      offer_lower(along(Proposal{}, axis, -1.0L));
    }
  }

  void offer_lower(const Proposal& direction) {
    const double lo = lower_by_normal(solid_, triangle_, direction);
    if (!(lo > proven_.distance.lo)) return;
    proven_.distance.lo = lo;
    proven_.lower_normal = direction;
  }

  void prove(const Weights& weights, Solver contact) {
    const PreciseVector q = triangle_.point(weights);
    const Proposal middle = midpoint(q);
    const Contact found = contact(solid_.superquadric(), middle);
    const Proposal v = normal_at(middle, found);
    offer_upper(weights, q, v);
    // Next to the flat end of a tapered solid the point is more accurate than the normal, which a section gives.
    if (solid_.bounds().is_tapered()) offer_upper(weights, q, difference(middle, found.point));
    if (proven_.distance.hi == 0.0) return;
    for (const Proposal& direction : directions(weights, v)) {
      offer_lower(direction);
      if (closed()) return;
    }
  }

  /// The loss of a lower end is of first order in v·(t_j - t_i) for the corners that tie at the closest point, and of
  /// second order in every other error of v. So on an edge v loses its part along the edge; on the face v becomes the
  /// normal.
  [[nodiscard]] std::array<Proposal, 5> directions(const Weights& weights, const Proposal& v) const {
    const Proposal face = along(Proposal{}, normal_, dot(normal_, v) < 0.0L ? -1.0L : 1.0L);
    std::array<Proposal, 5> candidates{v, projected(v, edges_[0]), projected(v, edges_[1]), projected(v, edges_[2]),
                                       face};
    const bool at_0 = weights[0] + weights[1] < 1.0;
    const bool at_1 = weights[0] > 0.0;
    const bool at_2 = weights[1] > 0.0;
    if (at_0 && at_1 && at_2) std::swap(candidates[0], candidates[4]);
    if (at_0 && at_1 && !at_2) std::swap(candidates[0], candidates[1]);
    if (!at_0 && at_1 && at_2) std::swap(candidates[0], candidates[2]);
    if (at_0 && !at_1 && at_2) std::swap(candidates[0], candidates[3]);
    return candidates;
  }

  const PosedSuperquadric& solid_;
  PosedTriangle triangle_;
  Proposal normal_;
  std::array<Proposal, 3> corners_;
  std::array<Proposal, 3> edges_;  ///< vectors from corner i to corner i + 1
  long double reach_ = 0.0L;
  ProvenDistance proven_;
};

/// As long as the distance, for a vector of which only the direction matters: within the range of binary64.
Proposal scaled(const Proposal& direction, double distance) {
  const long double length = std::hypot(direction[0], direction[1], direction[2]);
  return along(Proposal{}, direction, std::max(distance, kShortest) / length);
}

}  // namespace

struct TriangleDistance::State {
  explicit State(const Model& model) : checker(model), primitives(model.primitives.begin(), model.primitives.end()) {}

  [[nodiscard]] CertifiedEnclosure enclose(const Triangle& triangle) const {
    CertifiedEnclosure result{{infinity, infinity}, {}};
    auto& [distance, certificate] = result;
    Normal first{};  // that of the nearest primitive's point
    const auto sphere_bound = [&](std::size_t i) { return lower_by_sphere(primitives[i], triangle); };
    for (const auto& [bound, i] : nearest_spheres_first(primitives.size(), sphere_bound)) {
      const auto index = static_cast<std::uint32_t>(i);
      if (bound >= distance.hi) break;  // neither this primitive nor a later one is nearer
      const ProvenDistance found = TriangleProof(primitives[index], triangle)();
      certificate.normals.push_back({index, rounded(scaled(found.lower_normal, found.distance.hi))});
      distance.lo = std::min(distance.lo, found.distance.lo);
      if (!(found.distance.hi < distance.hi)) continue;
      distance.hi = found.distance.hi;
      certificate.weights = found.weights;
      first = {index, rounded(found.upper_normal)};
    }
    distance =
        between(distance.lo, distance.hi, [&] { return "the distance of the triangle from " + text_of(triangle[0]); });
    if (!(distance.lo > 0.0)) certificate.normals.clear();  // that distances are not negative needs no proof
    std::erase(certificate.normals, first);
    certificate.normals.insert(certificate.normals.begin(), first);
    return result;
  }

  ExactChecker checker;
  std::vector<PosedSuperquadric> primitives;
};

TriangleDistance::TriangleDistance(const Model& model) {
  require_union_of_convex(model, "distances of triangles");
  state_ = hidden<State>(model);
}

Enclosure TriangleDistance::operator()(const Triangle& triangle) const {
  return state_->enclose(triangle).distance;
}

CertifiedEnclosure TriangleDistance::certified(const Triangle& triangle) const {
  CertifiedEnclosure found = state_->enclose(triangle);
  found.distance = state_->checker(triangle, found.distance, found.certificate);
  return found;
}

}  // namespace verisq
