/// Proves penetration depths again: support functions of whole models, closed surfaces of differences, inner balls.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <utility>
#include <variant>
#include <vector>
#include <verisq/penetration.hpp>

#include "verify/numbers/points.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/proof/mesh_solid.hpp"
#include "verify/proof/model_checker.hpp"
#include "verify/proof/pair_checker.hpp"
#include "verify/proof/solid_pair.hpp"
#include "verify/proof/verdict.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verify/solids/model.hpp"
#include "verisq/error.hpp"

namespace verisq::verify {

namespace {

// Upper bounds of support functions.

/// The vertices of a closed mesh that have triangles: the solid lies in their hull.
class MeshReach {
 public:
  explicit MeshReach(const Primitive& primitive) : motion_(primitive.pose) {
    const Mesh& mesh = *primitive.mesh;
    std::vector<bool> is_corner(mesh.vertices.size(), false);
    for (const auto& triangle : mesh.triangles)
      for (const std::uint32_t corner : triangle) is_corner[corner] = true;
    for (std::size_t i = 0; i < is_corner.size(); ++i)
      if (is_corner[i]) corners_.push_back(mesh.vertices[i]);
  }

  [[nodiscard]] Real towards(const PreciseVector& n) const {
    const PreciseVector own = motion_.rotation.transpose() * n;
    Real most(-infinity);
    for (const Point& corner : corners_) most = std::max(most, own.dot(precise(corner)).upper());
    return (PreciseInterval(most) + n.dot(motion_.translation)).upper();
  }

 private:
  RigidMotion motion_;
  std::vector<Point> corners_;
};

/// By sections, each with a slope that is about the best.
class SuperquadricReach {
 public:
  explicit SuperquadricReach(const Primitive& primitive)
      : sections_(primitive), mapping_(primitive), is_bent_(is_bent(primitive)) {}

  [[nodiscard]] Real towards(const PreciseVector& n) const {
    const PreciseVector own = sections_.motion().rotation.transpose() * n;
    Coordinates<double> about{};
    for (std::size_t k = 0; k < 3; ++k) about[k] = own[k].lower().to_double(Direction::down);
    const auto [lower, upper] = sections_.whole();
    const int count = is_bent_ ? most_sections : 1;
    Real most(-infinity);
    double from = lower;
    for (int k = 1; k <= count; ++k) {
      const double to = k == count ? upper : lower + (upper - lower) * (static_cast<double>(k) / count);
      const double slope = mapping_.slope(about, mapping_.section(from, to));
      most = std::max(most, sections_.reach(own, {from, to}, std::isfinite(slope) ? slope : 0.0));
      from = to;
    }
    return (PreciseInterval(most) + n.dot(sections_.motion().translation)).upper();
  }

 private:
  static constexpr int most_sections = 64;  // a section is loose by the square of its share of the whole bend

  PosedSections sections_;
  SectionMapping mapping_;
  bool is_bent_;
};

/// A whole model in its frame.
class Reach {
 public:
  explicit Reach(const Model& model) : set_(set_of(model)) {
    for (const Primitive& primitive : model.primitives) {
      if (primitive.mesh) {
        primitives_.emplace_back(std::in_place_type<MeshReach>, primitive);
      } else {
        primitives_.emplace_back(std::in_place_type<SuperquadricReach>, primitive);
      }
    }
  }

  /// No smaller than n·x of any point x of the solid; minus infinity of an empty one.
  [[nodiscard]] Real towards(const PreciseVector& n) const { return towards(n, set_); }

 private:
  /// An intersection lies in each of its operands, a difference in the first.
  [[nodiscard]] Real towards(const PreciseVector& n, const SetExpression& set) const {
    if (set.operands.empty())
      return std::visit([&](const auto& solid) { return solid.towards(n); }, primitives_[set.primitive]);
    Real reach = towards(n, set.operands.front());
    if (set.operation == SetOperation::subtract) return reach;
    for (std::size_t k = 1; k < set.operands.size(); ++k) {
      const Real of_operand = towards(n, set.operands[k]);
      reach = set.operation == SetOperation::unite ? std::max(reach, of_operand) : std::min(reach, of_operand);
    }
    return reach;
  }

  SetExpression set_;
  std::vector<std::variant<MeshReach, SuperquadricReach>> primitives_;
};

/// The way along n after which the plane n·x = h_A(n) has A on one side and B on the other.
double way_along(const Reach& a, const Reach& b, const RigidMotion& pose, const Point& direction) {
  if (!usable({direction[0], direction[1], direction[2]})) return infinity;
  const PreciseVector n = precise(direction);
  const Real of_b = b.towards(-(pose.rotation.transpose() * n));
  const PreciseInterval overlap = PreciseInterval(a.towards(n)) + PreciseInterval(of_b) - n.dot(pose.translation);
  const double way = (overlap / length<Real>(n)).upper().to_double(Direction::up);
  return std::max(0.0, way);
}

// Lower bounds.

/// Returns whether each vertex p is proven to be a - b with points a and b of the solids.
bool are_differences(const DifferenceSurface& difference, const PairBounds& pair, const Hook& interrupted) {
  const auto& [i, j, surface, on_a] = difference;
  if (on_a.size() != surface.vertices.size()) return false;
  const RigidMotion to_b = pair.relative().inverse();
  for (std::size_t k = 0; k < on_a.size(); ++k) {
    if (interrupted && interrupted()) return false;
    if (!is_finite(on_a[k]) || !is_finite(surface.vertices[k])) return false;
    const PreciseVector a = precise(on_a[k]);
    const PreciseVector b = to_b(PreciseVector(a - precise(surface.vertices[k])));
    if (pair.a().bounds().gauge_up(a) > Real(1) || pair.b().bounds().gauge_up(b) > Real(1)) return false;
  }
  return true;
}

/// A - B is convex. So it holds every point about which a closed surface of its points winds.
double depth_by(const DifferenceSurface& difference, const PairBounds& pair, const Hook& interrupted) {
  if (!are_differences(difference, pair, interrupted)) return 0.0;
  try {
    const MeshSolid hull(mesh_primitive("", difference.surface));
    return std::max(0.0, -hull.signed_distance_of(PreciseVector()).hi);
  } catch (const Error& error) {  // not closed, or indices out of range
    if (error.kind() != ErrorKind::input) throw;
    return 0.0;
  }
}

/// A primitive that is convex and a part of its model; nothing where the model has none of that number.
const Primitive* convex_part(const Model& model, std::uint32_t index) {
  if (!is_union(model) || index >= model.primitives.size()) return nullptr;
  const Primitive& primitive = model.primitives[index];
  return primitive.mesh || is_bent(primitive) ? nullptr : &primitive;
}

double depth_by(const DifferenceSurface& difference, const Model& a, const Model& b, const RigidMotion& pose,
                const Hook& interrupted) {
  const Primitive* const of_a = convex_part(a, difference.primitive_a);
  const Primitive* const of_b = convex_part(b, difference.primitive_b);
  if (of_a == nullptr || of_b == nullptr) return 0.0;
  const PosedSuperquadric one(*of_a);
  const PosedSuperquadric other(*of_b);
  const RigidMotion relative = one.motion().inverse().after(pose.after(other.motion()));
  return depth_by(difference, PairBounds(one, other, relative), interrupted);
}

/// Their centres are at least the sum of the radii apart in solids that are parted.
double depth_by(const std::array<InnerBall, 2>& balls, const ModelChecker& a, const ModelChecker& b,
                const RigidMotion& pose, const Hook& interrupted) {
  const auto radius = [&](const ModelChecker& solid, const InnerBall& ball) {
    if (!is_finite(ball.centre) || !(ball.radius >= 0.0)) return -infinity;
    return -solid(ball.centre, {-infinity, -ball.radius}, ball.proof, interrupted).hi;
  };
  const auto& [in_a, in_b] = balls;
  const double radius_a = radius(a, in_a);
  const double radius_b = radius(b, in_b);
  if (!(radius_a >= 0.0 && radius_b >= 0.0)) return 0.0;
  const PreciseInterval apart = length<Real>(PreciseVector(precise(in_a.centre) - pose(precise(in_b.centre))));
  const PreciseInterval depth = PreciseInterval(Real(radius_a)) + PreciseInterval(Real(radius_b)) - apart;
  return std::max(0.0, depth.lower().to_double(Direction::down));
}

/// After a translation that leaves them without a common point.
double way_of(const PartingTranslation& parting, const ModelPair& pair, RigidMotion pose, const Hook& interrupted) {
  if (!is_finite(parting.translation)) return infinity;
  const PreciseVector way = precise(parting.translation);
  pose.translation = pose.translation + way;
  if (!(pair.distance(pose, parting.proof, interrupted).lo > 0.0)) return infinity;
  return length<Real>(way).upper().to_double(Direction::up);
}

}  // namespace

}  // namespace verisq::verify

namespace verisq {

struct PenetrationChecker::State {
  State(const Model& first, const Model& second)
      : a(first), b(second), pair(first, second), reach_a(first), reach_b(second) {}

  [[nodiscard]] double lower(const verify::RigidMotion& pose, const PenetrationCertificate& certificate,
                             const verify::Hook& interrupted) const {
    double depth = 0.0;
    if (certificate.surface) depth = verify::depth_by(*certificate.surface, a, b, pose, interrupted);
    if (certificate.balls) {
      std::call_once(has_places, [this] {
        places_a.emplace(a);
        places_b.emplace(b);
      });
      depth = std::max(depth, verify::depth_by(*certificate.balls, *places_a, *places_b, pose, interrupted));
    }
    return depth;
  }

  [[nodiscard]] double upper(const verify::RigidMotion& pose, const PenetrationCertificate& certificate,
                             const verify::Hook& interrupted) const {
    const double along = verify::way_along(reach_a, reach_b, pose, certificate.direction);
    if (!certificate.parting) return along;
    return std::min(along, verify::way_of(*certificate.parting, pair, pose, interrupted));
  }

  Model a, b;
  verify::ModelPair pair;
  verify::Reach reach_a, reach_b;
  mutable std::once_flag has_places;
  mutable std::optional<verify::ModelChecker> places_a, places_b;  ///< made for the first balls
};

PenetrationChecker::PenetrationChecker(const Model& a, const Model& b) : state_(hidden<State>(a, b)) {}

Enclosure PenetrationChecker::prove(const Pose& pose, const PenetrationCertificate& certificate,
                                    const std::function<bool()>& interrupted) const {
  verify::require_valid(pose, "pose");
  const verify::RigidMotion motion(pose);
  return verify::between(state_->lower(motion, certificate, interrupted),
                         state_->upper(motion, certificate, interrupted), [] { return "the penetration depth"; });
}

Finding PenetrationChecker::operator()(const Pose& pose, const Enclosure& claimed,
                                       const PenetrationCertificate& certificate,
                                       const std::function<bool()>& interrupted) const {
  const Enclosure proven = prove(pose, certificate, interrupted);
  return verify::judged(claimed, proven, proven);
}

}  // namespace verisq
