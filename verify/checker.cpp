/// The checker's whole logic: what normals, spheres, escapes and contained balls prove about one point.
#include "verisq/checker.hpp"

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include "verify/contained_ball.hpp"
#include "verify/pose.hpp"

namespace verisq {

namespace {

using namespace verify;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Proposal proposal(const std::array<double, 3>& v) {
  return {v[0], v[1], v[2]};
}

/// One primitive K. Distances are rounded outward to binary64: comparing them with claims loses nothing, because the
/// claims are binary64 numbers themselves.
class PosedSuperquadric {
 public:
  explicit PosedSuperquadric(const Primitive& primitive)
      : superquadric_(primitive.superquadric), bounds_(primitive.superquadric), frame_(primitive.pose) {
    const auto& a = superquadric_.semi_axes;
    radius_ = length<Real>(PreciseVector(Real(a[0]), Real(a[1]), Real(a[2])));
  }

  /// K lies in a sphere about its centre: sd(x) >= |x - centre| - radius.
  [[nodiscard]] double lower_by_sphere(const Point& x) const {
    return (length<Real>(frame_.local_point(x)) - radius_).lower().to_double(Direction::down);
  }

  /// sd(x) >= (v·x - h(v)) / |v|
  [[nodiscard]] double lower_by_normal(const Point& x, const Proposal& v) const {
    return lower_bound(bounds_, frame_.local_point(x), v);
  }

  /// sd(x) <= |x - b|, where b = (x - v) / g(x - v) lies in K.
  [[nodiscard]] double upper_by_normal(const Point& x, const Proposal& v) const {
    if (!usable(v)) return kInfinity;
    const PreciseVector q = frame_.local_point(x);
    return upper_bound_at(bounds_, q, PreciseVector(q - precise(v)));
  }

  /// `claimed` or less if it can be proven with v, else what can be.
  [[nodiscard]] double upper(const Point& x, const Proposal& v, double claimed) const {
    const double by_normal = claimed > 0.0 ? upper_by_normal(x, v) : kInfinity;
    if (by_normal <= claimed) return by_normal;
    if (!contains(x)) return upper_by_normal(x, v);
    return claimed < 0.0 && contains_ball_about(x, -claimed) ? claimed : 0.0;
  }

  [[nodiscard]] bool excludes(const Point& x) const {
    return lower_by_sphere(x) > 0.0 || bounds_.gauge(frame_.local_point(x)).lower() > Real(1);
  }

  [[nodiscard]] bool contains(const Point& x) const { return bounds_.gauge(frame_.local_point(x)).upper() <= Real(1); }

  [[nodiscard]] bool contains_ball_about(const Point& x, double radius) const {
    return contains_ball(superquadric_, bounds_, frame_.local_point(x), radius);
  }

 private:
  Superquadric superquadric_;
  SuperquadricBounds<Real> bounds_;
  Frame frame_;
  PreciseInterval radius_;
};

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
      least = std::min(least, primitives[index].upper(x, proposal(v), claimed));
      if (least <= claimed) break;
    }
    return least;
  }
};

Checker::Checker(const Model& model) : state_(std::make_unique<State>()) {
  for (const Primitive& primitive : model.primitives) state_->primitives.emplace_back(primitive);
}

Checker::~Checker() = default;
Checker::Checker(Checker&&) noexcept = default;
Checker& Checker::operator=(Checker&&) noexcept = default;

Finding Checker::operator()(const Point& point, const Enclosure& claimed, const Certificate& certificate) const {
  Certificate known = certificate;
  std::erase_if(known.normals, [&](const Normal& normal) { return normal.primitive >= state_->primitives.size(); });
  const Enclosure proven{state_->lower(point, known), state_->upper(point, claimed.hi, known.normals)};
  if (claimed.lo > claimed.hi || claimed.lo > proven.hi || claimed.hi < proven.lo) return {Verdict::refuted, proven};
  if (proven.lo >= claimed.lo && proven.hi <= claimed.hi) return {Verdict::proved, proven};
  return {Verdict::unproved, proven};
}

}  // namespace verisq
