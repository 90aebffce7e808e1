/// This file implements pair_checker.hpp.
#include "verify/proof/pair_checker.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "verify/proof/check_steps.hpp"
#include "verify/proof/mesh_pair_checker.hpp"
#include "verify/proof/verdict.hpp"
#include "verify/proof/way_checker.hpp"
#include "verify/solids/model.hpp"
#include "verify/solids/paths.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/path.hpp"

namespace verisq::verify {

Enclosure PairBounds::distance(const Separation& separation) const {
  const auto& [primitive_a, primitive_b, vector, on_a, on_b] = separation;
  const bool direction = usable({vector[0], vector[1], vector[2]});
  const auto finite = [](const Point& x) { return std::isfinite(x[0]) && std::isfinite(x[1]) && std::isfinite(x[2]); };
  const bool points = finite(on_a) && finite(on_b);
  return {direction ? lower_by_vector(precise(vector)).to_double(Direction::down) : -infinity,
          points ? upper_by_points(precise(on_a), precise(on_b)).to_double(Direction::up) : infinity};
}

namespace {

bool is_in(const PosedSuperquadric& solid, const RigidMotion& to_own_frame, const PreciseVector& x) {
  return solid.bounds().gauge(to_own_frame(x)).upper() <= Real(1);
}

}  // namespace

PosedPairs::PosedPairs(const PosedPrimitives& a, const PosedPrimitives& b, const RigidMotion& motion) : a_(&a), b_(&b) {
  for (const RigidMotion& own : b.motions) moved_.push_back(motion.after(own));
}

double PosedPairs::lower_by_spheres(std::size_t i, std::size_t j) const {
  const PreciseVector between = moved_[j].translation - a_->motions[i].translation;
  return (length<Real>(between) - a_->primitives[i].radius() - b_->primitives[j].radius())
      .lower()
      .to_double(Direction::down);
}

bool PosedPairs::share(const Point& x) const {
  if (!std::ranges::all_of(x, [](double c) { return std::isfinite(c); })) return false;
  const PreciseVector point = precise(x);
  bool in_a = false;
  for (std::size_t i = 0; i < size_a() && !in_a; ++i) in_a = is_in(a_->primitives[i], a_->inverse_motions[i], point);
  bool in_b = false;
  for (std::size_t j = 0; j < size_b() && !in_b; ++j) in_b = is_in(b_->primitives[j], moved_[j].inverse(), point);
  return in_a && in_b;
}

double MovingPairs::lower_by_spheres(std::size_t i, std::size_t j) const {
  const PreciseVector& centre = pairs_.motion_b(j).translation;
  const PreciseVector apart = centre - pairs_.motion_a(i).translation;
  return (length<Real>(apart) - motion_.way_of(centre) - pairs_.radius_a(i) - pairs_.radius_b(j))
      .lower()
      .to_double(Direction::down);
}

double MovingPairs::lower_by_vector(std::size_t i, std::size_t j, const Point& vector) const {
  if (!usable({vector[0], vector[1], vector[2]})) return -infinity;
  const PosedSuperquadric& solid_b = b_->primitives[j];
  const PreciseVector v = precise(vector);
  const PreciseVector n = pairs_.motion_a(i).rotation * v;
  const PreciseInterval far_side_of_a =
      PreciseInterval(a_->primitives[i].bounds().support_up(v)) + n.dot(pairs_.motion_a(i).translation);
  const RigidMotion& place = pairs_.motion_b(j);
  const auto reach_of_b = [&](const PreciseVector& m) {
    return solid_b.bounds().support_up(place.rotation.transpose() * m);
  };
  const PreciseInterval near_side_of_b =
      motion_.least_along(n, {place.translation, solid_b.radius()}, place.translation, reach_of_b);
  return ((near_side_of_b - far_side_of_a) / length<Real>(n)).lower().to_double(Direction::down);
}

namespace {

/// The least bound of all pairs. For primitives that both models have, it uses the certificate's vectors by
/// `by_vector`; for all others it uses spheres. No bound is NaN: each has been through an interval, which holds none.
template <class ByVector>
double least_distance(const MovingPairs& moving, const PairCertificate& certificate, const Hook& interrupted,
                      const ByVector& by_vector) {
  const std::size_t columns = moving.pairs().size_b();
  std::vector<double> lower;
  for (std::size_t i = 0; i < moving.pairs().size_a(); ++i) {
    for (std::size_t j = 0; j < columns; ++j) lower.push_back(moving.lower_by_spheres(i, j));
  }
  for (const Separation& separation : certificate.separations) {
    if (interrupted && interrupted()) return 0.0;
    const auto [i, j] = std::pair<std::size_t, std::size_t>(separation.primitive_a, separation.primitive_b);
    if (i >= moving.pairs().size_a() || j >= columns) continue;
    double& least = lower[i * columns + j];
    least = std::max(least, by_vector(i, j, separation));
  }
  return std::max(0.0, std::ranges::min(lower));
}

}  // namespace

std::variant<ModelPair::Convex, ModelPair::Solids, ModelPair::Meshes> ModelPair::models_of(const Model& a,
                                                                                           const Model& b) {
  for (const Model* const model : {&a, &b}) require_valid_with_meshes(*model);
  if (has_mesh(a) || has_mesh(b)) return std::make_shared<const MeshPairChecker>(a, b);
  if (is_union_of_convex(a) && is_union_of_convex(b)) return Convex{PosedPrimitives(a), PosedPrimitives(b)};
  return Solids{SolidParts(a), SolidParts(b)};
}

ModelPair::ModelPair(const Model& a, const Model& b) : models_(models_of(a, b)) {}

Enclosure ModelPair::distance(const RigidMotion& pose, const PairCertificate& certificate,
                              const Hook& interrupted) const {
  if (const auto* const solids = std::get_if<Solids>(&models_))
    return SolidPair(solids->a, solids->b, ShortMotion(pose), interrupted).at_moment(certificate);
  if (const auto* const meshes = std::get_if<Meshes>(&models_))
    return (*meshes)->distance(ShortMotion(pose), certificate.common, interrupted);
  const auto& [a, b] = std::get<Convex>(models_);
  const MovingPairs resting(a, b, ShortMotion(pose));
  const PosedPairs& pairs = resting.pairs();
  if (certificate.common && pairs.share(*certificate.common)) return {0.0, 0.0};
  double upper = infinity;
  const double lower = least_distance(resting, certificate, interrupted,
                                      [&](std::size_t i, std::size_t j, const Separation& separation) {
                                        const Enclosure proven = pairs(i, j).distance(separation);
                                        upper = std::min(upper, proven.hi);
                                        return proven.lo;
                                      });
  return between(lower, upper, [] { return "the distance of the models"; });
}

double ModelPair::lower(const ShortMotion& motion, const PairCertificate& certificate, const Hook& interrupted) const {
  if (const auto* const solids = std::get_if<Solids>(&models_))
    return std::max(0.0, SolidPair(solids->a, solids->b, motion, interrupted).lower(certificate));
  if (const auto* const meshes = std::get_if<Meshes>(&models_))
    return (*meshes)->distance(motion, std::nullopt, interrupted).lo;
  const auto& [a, b] = std::get<Convex>(models_);
  const MovingPairs moving(a, b, motion);
  return least_distance(moving, certificate, interrupted,
                        [&](std::size_t i, std::size_t j, const Separation& separation) {
                          return moving.lower_by_vector(i, j, separation.vector);
                        });
}

}  // namespace verisq::verify

namespace verisq {

struct PairChecker::State {
  verify::ModelPair models;
};

PairChecker::PairChecker(const Model& a, const Model& b) : state_(hidden<State>(State{verify::ModelPair(a, b)})) {}

Enclosure PairChecker::prove(const Pose& pose, const PairCertificate& certificate,
                             const std::function<bool()>& interrupted) const {
  verify::require_valid(pose, "pose");
  return state_->models.distance(verify::RigidMotion(pose), certificate, interrupted);
}

Finding PairChecker::operator()(const Pose& pose, const Enclosure& claimed, const PairCertificate& certificate,
                                const std::function<bool()>& interrupted) const {
  const Enclosure proven = prove(pose, certificate, interrupted);
  return verify::judged(claimed, proven, proven);
}

struct PathChecker::State {
  /// A lower bound of the distance: at least 0; 0 for a part that is not part of the path between two poses.
  [[nodiscard]] double lower(double begin, const PathPart& part, const verify::Hook& interrupted) const {
    const double until = part.until;
    const bool all_at_rest = path.last_time() == 0.0 && begin == 0.0 && until == 0.0;
    if (!(begin >= 0.0 && until <= path.last_time()) || !(begin < until || all_at_rest)) return 0.0;
    if (until > std::floor(begin) + 1.0) return 0.0;
    return models.lower(path.motion_between(begin, until), part.certificate, interrupted);
  }

  /// The upper end at `nearest`; infinity for a time outside the path.
  [[nodiscard]] double upper(const PathCertificate& certificate, const verify::Hook& interrupted) const {
    const double time = certificate.nearest;
    if (!(time >= 0.0 && time <= path.last_time())) return infinity;
    return models.distance(path.enclosed_pose(time), certificate.at_nearest, interrupted).hi;
  }

  verify::ModelPair models;
  verify::PosedPath path;
};

PathChecker::PathChecker(const Model& a, const Model& b, std::span<const Pose> path) {
  check_path(path);
  check_turns(path);
  state_ = hidden<State>(State{verify::ModelPair(a, b), verify::PosedPath(path)});
}

double PathChecker::lower(double begin, const PathPart& part) const {
  return state_->lower(begin, part, {});
}

// A part begins where the part before ends: the proof covers the path up to `begin`.
PathClaims PathChecker::prove(const PathCertificate& certificate, const CheckOptions& options) const {
  const std::vector<PathPart>& parts = certificate.parts;
  std::vector<double> lower(parts.size(), 0.0);
  verify::CheckSteps(parts.size(), options).each(parts.size(), [&](std::size_t k) {
    lower[k] = state_->lower(k == 0 ? 0.0 : parts[k - 1].until, parts[k], options.interrupted);
  });
  const double end = state_->path.last_time();
  double least = infinity;
  double begin = 0.0;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    if (lower[k] == 0.0) break;  // neither a distance nor a contact is known from here on
    least = std::min(least, lower[k]);
    begin = parts[k].until;
  }
  const bool whole = begin == end && least < infinity;
  const double upper = state_->upper(certificate, options.interrupted);
  const double meet_at = upper == 0.0 ? certificate.nearest : infinity;
  return {
      verify::between(whole ? least : 0.0, upper, [] { return "the smallest distance of the models on their way"; }),
      verify::between(whole ? infinity : begin, meet_at, [] { return "the first contact of the models"; })};
}

PathFindings check(const PathClaims& claimed, const PathClaims& proven) {
  PathFindings findings{verify::judged(claimed.smallest, proven.smallest, proven.smallest), std::nullopt};
  const Enclosure& contact = *proven.first_contact;
  if (claimed.first_contact) findings.first_contact = verify::judged(*claimed.first_contact, contact, contact);
  return findings;
}

}  // namespace verisq
