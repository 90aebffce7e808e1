/// The checker's whole logic: what normals, spheres, escapes, contained balls and weights prove about one point or
/// triangle.
#include "verisq/checker.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "verify/proof/convex_union.hpp"
#include "verify/proof/intersection.hpp"
#include "verify/proof/triangle_certificate.hpp"

namespace verisq {

namespace {

using namespace verify;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Proposal proposal(const std::array<double, 3>& v) {
  return {v[0], v[1], v[2]};
}

/// An upper end: `claimed` or less if it can be proven with v, else what can be.
double upper_end(const PosedSuperquadric& primitive, const Point& x, const Proposal& v, double claimed) {
  const double by_normal = claimed > 0.0 ? primitive.upper_by_normal(x, v) : kInfinity;
  if (by_normal <= claimed) return by_normal;
  if (!primitive.contains(x)) return primitive.upper_by_normal(x, v);
  return claimed < 0.0 && primitive.contains_ball_about(x, -claimed) ? claimed : 0.0;
}

Finding judged(const Enclosure& claimed, const Enclosure& proven) {
  if (claimed.lo > claimed.hi || claimed.lo > proven.hi || claimed.hi < proven.lo) return {Verdict::refuted, proven};
  if (proven.lo >= claimed.lo && proven.hi <= claimed.hi) return {Verdict::proved, proven};
  return {Verdict::unproved, proven};
}

}  // namespace

struct Checker::State {
  std::vector<PosedSuperquadric> primitives;

  /// Whether the exact signed distance is the least of the primitives': that of the union is where all are positive
  /// (not where one is 0: a point on a face that two solids share lies inside), and a single primitive's always.
  [[nodiscard]] double lower_by_normals(const Point& x, std::span<const Normal> normals) const {
    std::vector<double> lower;
    for (const PosedSuperquadric& primitive : primitives) lower.push_back(primitive.lower_by_sphere(x));
    for (const auto& [index, v] : normals) {
      lower[index] = std::max(lower[index], primitives[index].lower_by_normal(x, proposal(v)));
    }
    const double least = std::ranges::min(lower);
    return least > 0.0 || primitives.size() == 1 ? least : -kInfinity;
  }

  /// A point outside all primitives is no deeper inside than another outside of all is far.
  [[nodiscard]] double lower_by_escape(const Point& x, const Point& escape) const {
    const auto excludes = [&](const PosedSuperquadric& primitive) { return primitive.excludes(escape); };
    const bool proven = usable(proposal(escape)) && std::ranges::all_of(primitives, excludes);
    return proven ? -distance_up(x, escape) : -kInfinity;
  }

  [[nodiscard]] double lower(const Point& x, const Certificate& certificate) const {
    const double by_normals = lower_by_normals(x, certificate.normals);
    if (by_normals > 0.0 || !certificate.escape) return by_normals;
    return std::max(by_normals, lower_by_escape(x, *certificate.escape));
  }

  /// `claimed` or less as soon as a normal proves it, else the least that one proves.
  [[nodiscard]] double upper(const Point& x, double claimed, std::span<const Normal> normals) const {
    double least = kInfinity;
    for (const auto& [index, v] : normals) {
      least = std::min(least, upper_end(primitives[index], x, proposal(v), claimed));
      if (least <= claimed) break;
    }
    return least;
  }

  /// The normals of primitives that exist.
  [[nodiscard]] std::vector<Normal> known(std::vector<Normal> normals) const {
    std::erase_if(normals, [&](const Normal& normal) { return normal.primitive >= primitives.size(); });
    return normals;
  }

  /// The distance to a union is the least of the distances to its primitives, 0 where one of them is met.
  [[nodiscard]] double lower(const Triangle& triangle, std::span<const Normal> normals) const {
    std::vector<double> lower;
    for (const PosedSuperquadric& primitive : primitives) lower.push_back(lower_by_sphere(primitive, triangle));
    for (const auto& [index, v] : normals) {
      const PosedTriangle posed(triangle, primitives[index].frame());
      lower[index] = std::max(lower[index], lower_by_normal(primitives[index], posed, proposal(v)));
    }
    return std::max(0.0, std::ranges::min(lower));
  }

  /// By one point of the triangle; stops as soon as a normal proves `claimed` there.
  [[nodiscard]] double upper(const Triangle& triangle, double claimed, const std::optional<Weights>& weights,
                             std::span<const Normal> normals) const {
    double least = kInfinity;
    if (!weights || !in_triangle(*weights)) return least;
    for (const auto& [index, v] : normals) {
      const PreciseVector q = PosedTriangle(triangle, primitives[index].frame()).point(*weights);
      least = std::min(least, upper_by_point(primitives[index], q, proposal(v)));
      if (least <= claimed) break;
    }
    return least;
  }
};

Checker::Checker(const Model& model) : state_(std::make_unique<State>()) {
  require_union_of_convex(model, "certificates");
  for (const Primitive& primitive : model.primitives) state_->primitives.emplace_back(primitive);
}

Checker::~Checker() = default;
Checker::Checker(Checker&&) noexcept = default;
Checker& Checker::operator=(Checker&&) noexcept = default;

Finding Checker::operator()(const Point& point, const Enclosure& claimed, const Certificate& certificate) const {
  Certificate known = certificate;
  known.normals = state_->known(certificate.normals);
  return judged(claimed, between(state_->lower(point, known), state_->upper(point, claimed.hi, known.normals),
                                 [&] { return "the signed distance at " + text_of(point); }));
}

Finding Checker::operator()(const Triangle& triangle, const Enclosure& claimed, const Certificate& certificate) const {
  const std::vector<Normal> normals = state_->known(certificate.normals);
  const double upper = state_->upper(triangle, claimed.hi, certificate.weights, normals);
  return judged(claimed, between(state_->lower(triangle, normals), upper,
                                 [&] { return "the distance of the triangle from " + text_of(triangle[0]); }));
}

}  // namespace verisq
