/// Finds certificates of penetration depths: by hulls of differences first, then by the solids themselves.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <variant>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/penetration.hpp>

#include "verify/numbers/rounding.hpp"
#include "verify/proof/exact_checker.hpp"
#include "verify/proof/pair_checker.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verify/search/overlap.hpp"
#include "verify/search/solid_distance.hpp"
#include "verify/solids/model.hpp"

namespace verisq::verify {

namespace {

using Vector = Coordinates<long double>;
using Plain = Coordinates<double>;

/// A surface that proves a lower end has no more: they take a second to find and to check.
constexpr std::size_t most_facets = 4000;

/// No closer to the exact depth than this share of the size: vertices are rounded and pulled in.
constexpr double finest_relative_tolerance = 0x1p-40;

Plain plain(const Vector& v) {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

Vector wide(const Plain& v) {
  return {v[0], v[1], v[2]};
}

ApproximateMotion<long double> about(const RigidMotion& motion) {
  const auto middle = [](const PreciseVector& v) {
    return Vector{v[0].lower().to_long_double(), v[1].lower().to_long_double(), v[2].lower().to_long_double()};
  };
  return {{middle(motion.rotation.row(0)), middle(motion.rotation.row(1)), middle(motion.rotation.row(2))},
          middle(motion.translation)};
}

// About the farthest points of whole models.

/// The vertices of a mesh that have triangles.
class MeshCorners {
 public:
  explicit MeshCorners(const Primitive& primitive) {
    const ApproximateMotion<double> motion(primitive.pose);
    const Mesh& mesh = *primitive.mesh;
    std::vector<bool> is_corner(mesh.vertices.size(), false);
    for (const auto& triangle : mesh.triangles)
      for (const std::uint32_t corner : triangle) is_corner[corner] = true;
    for (std::size_t i = 0; i < is_corner.size(); ++i)
      if (is_corner[i]) corners_.push_back(motion.point(mesh.vertices[i]));
  }

  [[nodiscard]] Vector operator()(const Vector& direction) const {
    const Plain n = plain(direction);
    return wide(*std::ranges::max_element(corners_, {}, [&](const Point& x) { return dot(n, x); }));
  }

 private:
  std::vector<Point> corners_;
};

/// A bent superquadric: the farthest point of all its sections.
class BentSolid {
 public:
  explicit BentSolid(const Primitive& primitive)
      : mapping_(primitive), motion_(primitive.pose), half_length_(primitive.superquadric.semi_axes[2]) {}

  [[nodiscard]] Vector operator()(const Vector& direction) const {
    const Plain n = motion_.inverse_direction(plain(direction));
    Plain best{};
    for (int k = 0; k < sections; ++k) {
      const auto height = [&](int i) { return half_length_ * (2.0 * i / sections - 1.0); };
      const Plain x = mapping_.support_point(n, mapping_.section(height(k), height(k + 1)));
      if (k == 0 || dot(n, x) > dot(n, best)) best = x;
    }
    return wide(motion_.point(best));
  }

 private:
  static constexpr int sections = 16;

  SectionMapping mapping_;
  ApproximateMotion<double> motion_;
  double half_length_;
};

/// A model in its frame, as its support function is bounded by the checker.
class FarthestPoints {
 public:
  explicit FarthestPoints(const Model& model) : set_(set_of(model)) {
    for (const Primitive& primitive : model.primitives) {
      if (primitive.mesh) {
        primitives_.emplace_back(MeshCorners(primitive));
      } else if (is_bent(primitive)) {
        primitives_.emplace_back(BentSolid(primitive));
      } else {
        primitives_.emplace_back(posed_set<long double>(primitive));
      }
    }
  }

  [[nodiscard]] Vector operator()(const Vector& n) const { return farthest(n, set_); }

 private:
  using Solid = std::variant<PosedSet<long double, SuperquadricSet<long double>>, MeshCorners, BentSolid>;

  [[nodiscard]] Vector farthest(const Vector& n, const SetExpression& set) const {
    if (set.operands.empty())
      return std::visit([&](const auto& solid) { return solid(n); }, primitives_[set.primitive]);
    Vector best = farthest(n, set.operands.front());
    if (set.operation == SetOperation::subtract) return best;
    for (std::size_t k = 1; k < set.operands.size(); ++k) {
      const Vector other = farthest(n, set.operands[k]);
      const bool is_farther = dot(n, other) > dot(n, best);
      if (is_farther == (set.operation == SetOperation::unite)) best = other;
    }
    return best;
  }

  SetExpression set_;
  std::vector<Solid> primitives_;
};

// Differences of two convex primitives.

/// In the own frame of A's primitive. Vertices are proven to be differences: both points are pulled in until they are.
class ConvexDifference {
 public:
  ConvexDifference(const Primitive& a, const Primitive& b, const PairBounds& pair)
      : a_(a.superquadric),
        b_(b.superquadric),
        pair_(pair),
        to_b_(pair.relative().inverse()),
        motion_(about(pair.relative())) {}

  [[nodiscard]] std::optional<FarthestPoint> operator()(const Vector& n) {
    const Vector a = a_(n);
    const Vector b = b_(motion_.inverse_direction({-n[0], -n[1], -n[2]}));
    const Vector farthest = difference(a, motion_.point(b));
    for (; pulled_in_ < most_pulled_in; pulled_in_ *= 16) {
      const Point on_a = plain(along<long double>(a, a, -pulled_in_));
      const Vector of_b = motion_.point(along<long double>(b, b, -pulled_in_));
      const Point vertex = plain(difference(wide(on_a), of_b));
      if (is_difference(on_a, vertex)) return FarthestPoint{farthest, vertex, on_a};
    }
    pulled_in_ = least_pulled_in;
    return std::nullopt;
  }

 private:
  static constexpr long double least_pulled_in = 0x1p-50L;
  static constexpr long double most_pulled_in = 0x1p-20L;

  [[nodiscard]] bool is_difference(const Point& on_a, const Point& vertex) const {
    const PreciseVector a = precise(on_a);
    const PreciseVector b = to_b_(PreciseVector(a - precise(vertex)));
    return pair_.a().bounds().gauge_up(a) <= Real(1) && pair_.b().bounds().gauge_up(b) <= Real(1);
  }

  SuperquadricSet<long double> a_;
  SuperquadricSet<long double> b_;
  PairBounds pair_;
  RigidMotion to_b_;
  ApproximateMotion<long double> motion_;  ///< from B's own frame to A's
  long double pulled_in_ = least_pulled_in;
};

}  // namespace

}  // namespace verisq::verify

namespace verisq {

using verify::Vector;

struct PenetrationDepth::State {
  State(const Model& first, const Model& second)
      : a(first), b(second), checker(first, second), farthest_a(first), farthest_b(second) {}

  [[nodiscard]] static std::vector<std::uint32_t> convex_parts(const Model& model) {
    std::vector<std::uint32_t> parts;
    if (!verify::is_union(model)) return parts;
    for (std::uint32_t i = 0; i < model.primitives.size(); ++i)
      if (!model.primitives[i].mesh && !is_bent(model.primitives[i])) parts.push_back(i);
    return parts;
  }

  [[nodiscard]] static bool is_convex(const Model& model) {
    return is_union_of_convex(model) && model.primitives.size() == 1;
  }

  [[nodiscard]] CertifiedPenetration certified(const Pose& pose, const PenetrationOptions& options) const;
  void improve(const Pose& pose, PenetrationCertificate other, CertifiedPenetration& result) const;
  void add_deepest_pair(const Pose& pose, const verify::DifferenceHull::Limits& limits,
                        PenetrationCertificate& result) const;
  [[nodiscard]] Point parting_direction(const Pose& pose, const verify::DifferenceHull::Limits& limits) const;

  Model a, b;
  PenetrationChecker checker;
  verify::FarthestPoints farthest_a, farthest_b;
};

/// The pair of members that lets least be proven of the whole is the one that reaches least into each other: the depth
/// of two unions is at least that of each pair of their members.
void PenetrationDepth::State::add_deepest_pair(const Pose& pose, const verify::DifferenceHull::Limits& limits,
                                               PenetrationCertificate& result) const {
  double deepest = 0.0;
  for (const std::uint32_t i : convex_parts(a)) {
    const verify::PosedSuperquadric one(a.primitives[i]);
    for (const std::uint32_t j : convex_parts(b)) {
      const verify::PosedSuperquadric other(b.primitives[j]);
      const verify::RigidMotion relative =
          one.motion().inverse().after(verify::RigidMotion(pose).after(other.motion()));
      const verify::PairBounds pair(one, other, relative);
      verify::DifferenceHull hull(verify::ConvexDifference(a.primitives[i], b.primitives[j], pair));
      verify::DifferenceHull::Limits until = limits;
      until.enough = deepest;
      hull.grow(until);
      if (is_convex(a) && is_convex(b)) {
        const auto own = verify::ApproximateMotion<long double>::of_own_frame(a.primitives[i]);
        result.direction = verify::plain(own.direction(hull.direction()));
      }
      if (!(hull.depth() > deepest)) continue;
      deepest = hull.depth();
      auto [mesh, on_a] = hull.surface();
      result.surface = DifferenceSurface{i, j, std::move(mesh), std::move(on_a)};
    }
  }
}

/// The models' hulls are parted by the same directions.
Point PenetrationDepth::State::parting_direction(const Pose& pose, const verify::DifferenceHull::Limits& limits) const {
  const verify::ApproximateMotion<long double> motion(pose);
  verify::DifferenceHull hull([&](const Vector& n) {
    const Vector on_b = motion.point(farthest_b(motion.inverse_direction({-n[0], -n[1], -n[2]})));
    const Vector farthest = verify::difference(farthest_a(n), on_b);
    return std::optional(verify::FarthestPoint{farthest, verify::plain(farthest), {}});
  });
  hull.grow(limits);
  return verify::plain(hull.direction());
}

/// First by hulls alone; where these leave the depth open, by the solids themselves.
CertifiedPenetration PenetrationDepth::State::certified(const Pose& pose, const PenetrationOptions& options) const {
  const std::function<bool()> interrupted = [&] { return options.interrupted && options.interrupted(); };
  double size = std::max(bounding_radius(a), bounding_radius(b));
  for (const double t : pose.translation) size = std::max(size, std::fabs(t));
  const double tolerance = std::max(options.tolerance, verify::finest_relative_tolerance * size);
  const verify::DifferenceHull::Limits limits{
      .tolerance = tolerance / 2, .enough = 0.0, .facets = verify::most_facets, .interrupted = interrupted};
  const bool are_convex = is_convex(a) && is_convex(b);
  CertifiedPenetration result{};
  PenetrationCertificate& certificate = result.certificate;
  add_deepest_pair(pose, limits, certificate);
  if (!are_convex) certificate.direction = parting_direction(pose, limits);
  result.depth = checker.prove(pose, certificate);
  if (result.depth.hi == 0.0 || verified(result.depth, tolerance) || interrupted()) return result;
  verify::Overlap overlap(a, b, pose, size, interrupted);
  const Point deep = overlap.deepest(options.common);
  improve(pose, {.direction = certificate.direction, .balls = overlap.balls_about(deep, tolerance / 4)}, result);
  if (!are_convex && !verified(result.depth, tolerance)) {
    improve(
        pose,
        {.direction = certificate.direction, .parting = overlap.parting(certificate.direction, result.depth.hi, deep)},
        result);
  }
  return result;
}

/// Takes over the parts that prove more.
void PenetrationDepth::State::improve(const Pose& pose, PenetrationCertificate other,
                                      CertifiedPenetration& result) const {
  const Enclosure proven = checker.prove(pose, other);
  auto& [depth, certificate] = result;
  if (proven.lo > depth.lo) {
    certificate.surface.reset();
    certificate.balls = std::move(other.balls);
    depth.lo = proven.lo;
  }
  if (proven.hi < depth.hi) {
    certificate.parting = std::move(other.parting);
    depth.hi = proven.hi;
  }
}

PenetrationDepth::PenetrationDepth(const Model& a, const Model& b) : state_(hidden<State>(a, b)) {}

CertifiedPenetration PenetrationDepth::operator()(const Pose& pose, const PenetrationOptions& options) const {
  verify::require_valid(pose, "pose");
  verify::require_tolerance(options.tolerance);
  return state_->certified(pose, options);
}

}  // namespace verisq
