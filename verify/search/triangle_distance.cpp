/// Proves the proposed points and directions, primitive by primitive, the nearest bounding sphere first.
#include "verisq/triangle_distance.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "verify/proof/convex_union.hpp"
#include "verify/proof/exact_checker.hpp"
#include "verify/proof/intersection.hpp"
#include "verify/proof/triangle_certificate.hpp"
#include "verify/proposals/triangle.hpp"
#include "verify/search/candidates.hpp"
#include "verify/search/certified_distance.hpp"
#include "verify/search/contact.hpp"
#include "verify/search/triangle_contact.hpp"
#include "verisq/enclosure.hpp"

namespace verisq {

namespace {

using namespace verify;

constexpr double kShortest = 0x1p-900;  // of a vector whose components are normal numbers, unless they do not matter

/// What is proven of one primitive, and by what.
struct ProvenDistance {
  Enclosure distance{0.0, infinity};
  Weights weights{};
  Proposal upper_normal{};  ///< of the point that the weights give
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
    return proven_;
  }

 private:
  /// Whether what is left is of the order of rounding: else a better proposal is worth looking for.
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

  /// From the closest point to q. Inside and on the surface, where the contact's normal is a direction only, very
  /// short: then it leads back to q itself, scaled to the surface.
  [[nodiscard]] static Proposal normal_at(const Proposal& q, const Contact& found) {
    return found.point == q ? along(Proposal{}, found.normal, static_cast<long double>(kShortest)) : found.normal;
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
      const double lo = lower_by_normal(solid_, triangle_, direction);
      if (lo > proven_.distance.lo) {
        proven_.distance.lo = lo;
        proven_.lower_normal = direction;
      }
      if (closed()) return;
    }
  }

  /// The loss of a lower end is of first order in v·(t_j - t_i) for the corners that tie at the closest point, and of
  /// second order in every other error of v: on an edge v loses its part along the edge, on the face it is the normal.
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
  std::array<Proposal, 3> edges_;  ///< from corner i to corner i + 1
  long double reach_ = 0.0L;
  ProvenDistance proven_;
};

/// As long as the distance, for a vector that only needs a direction: within the range of binary64.
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
  state_ = std::make_unique<State>(model);
}

TriangleDistance::~TriangleDistance() = default;
TriangleDistance::TriangleDistance(TriangleDistance&&) noexcept = default;
TriangleDistance& TriangleDistance::operator=(TriangleDistance&&) noexcept = default;

Enclosure TriangleDistance::operator()(const Triangle& triangle) const {
  return state_->enclose(triangle).distance;
}

CertifiedEnclosure TriangleDistance::certified(const Triangle& triangle) const {
  CertifiedEnclosure found = state_->enclose(triangle);
  found.distance = state_->checker(triangle, found.distance, found.certificate);
  return found;
}

}  // namespace verisq
