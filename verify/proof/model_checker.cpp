/// This file implements model_checker.hpp: for a union with meshes, what meshes and the other primitives prove
/// together.
#include "verify/proof/model_checker.hpp"

#include <algorithm>

#include "verify/numbers/points.hpp"
#include "verify/proof/mesh_pair_checker.hpp"
#include "verify/proof/mesh_solid.hpp"
#include "verify/proof/verdict.hpp"
#include "verify/solids/model.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/error.hpp"

namespace verisq::verify {

ModelChecker::ModelChecker(const Model& model) {
  require_valid_with_meshes(model);
  if (!has_mesh(model)) {
    others_.emplace(model);
    return;
  }
  if (!is_union(model)) {
    throw Error(ErrorKind::input, "a model with meshes is checked only if it is the union of all its primitives");
  }
  Model others{model.units, {}};
  for (const Primitive& primitive : model.primitives) {
    place_.push_back(primitive.mesh ? std::nullopt
                                    : std::optional(static_cast<std::uint32_t>(others.primitives.size())));
    if (primitive.mesh) {
      meshes_.push_back(std::make_shared<const MeshSolid>(primitive));
    } else {
      others.primitives.push_back(primitive);
    }
  }
  if (!others.primitives.empty()) others_.emplace(others);
}

Enclosure ModelChecker::least_of_meshes(const Point& point) const {
  Enclosure least{infinity, infinity};
  for (const std::shared_ptr<const MeshSolid>& mesh : meshes_) {
    const Enclosure distance = mesh->signed_distance(point);
    least = {std::min(least.lo, distance.lo), std::min(least.hi, distance.hi)};
  }
  return least;
}

std::vector<Normal> ModelChecker::normals_of_others(const Certificate& certificate) const {
  std::vector<Normal> normals;
  for (const auto& [primitive, v] : certificate.normals) {
    if (primitive < place_.size() && place_[primitive]) normals.push_back({*place_[primitive], v});
  }
  return normals;
}

/// Minus the distance of a point that is proven to lie outside of all primitives.
double ModelChecker::lower_by_escape(const Point& point, const std::optional<Point>& escape) const {
  if (!escape || !is_finite(*escape)) return -infinity;
  if (!(least_of_meshes(*escape).lo > 0.0)) return -infinity;
  if (others_ && place_of(precise(*escape), others_->set(), others_->primitives()) != Place::outside) return -infinity;
  return -distance_up(point, *escape);
}

/// The signed distance of a union is at most that of each primitive, and the least of them if all are positive. A mesh
/// alone may be a surface that crosses itself, whose signed distance is no depth: an escape proves nothing about it.
Enclosure ModelChecker::operator()(const Point& point, const Enclosure& claimed, const Certificate& certificate,
                                   const Hook& interrupted) const {
  if (meshes_.empty()) return (*others_)(point, claimed, certificate, interrupted);
  const Enclosure of_meshes = least_of_meshes(point);
  if (place_.size() == 1) return of_meshes;
  Enclosure of_others{infinity, infinity};
  if (others_) {
    const Certificate by_normals{normals_of_others(certificate), std::nullopt};
    // The upper end that meshes prove is not asked for once more.
    const double upper_asked = of_meshes.hi <= claimed.hi ? infinity : claimed.hi;
    of_others = (*others_)(point, {claimed.lo, upper_asked}, by_normals, interrupted);
  }
  const double least = std::min(of_meshes.lo, of_others.lo);
  const double lower = least > 0.0 ? least : lower_by_escape(point, certificate.escape);
  return between(lower, std::min(of_meshes.hi, of_others.hi),
                 [&] { return "the signed distance at " + text_of(point); });
}

/// The distance to a union is the least of those to its primitives.
Enclosure ModelChecker::operator()(const Triangle& triangle, const Enclosure& claimed, const Certificate& certificate,
                                   const Hook& interrupted) const {
  Enclosure least{infinity, infinity};
  const auto join = [&](const Enclosure& of_part) {
    least = {std::min(least.lo, of_part.lo), std::min(least.hi, of_part.hi)};
  };
  for (const std::shared_ptr<const MeshSolid>& mesh : meshes_) join(distance_of(triangle, *mesh, interrupted));
  if (!others_) return least;
  if (meshes_.empty()) return (*others_)(triangle, claimed, certificate, interrupted);
  const Certificate of_others{normals_of_others(certificate), std::nullopt, certificate.weights};
  // The upper end that meshes prove is not asked for once more.
  join((*others_)(triangle, {claimed.lo, least.hi <= claimed.hi ? infinity : claimed.hi}, of_others, interrupted));
  return least;
}

CubePlaces::CubePlaces(const Model& model) {
  require_valid_with_meshes(model);
  set_ = set_of(model);
  for (const Primitive& primitive : model.primitives) {
    if (primitive.mesh) {
      solids_.emplace_back(std::make_shared<const MeshSolid>(primitive));
    } else {
      solids_.emplace_back(posed(primitive));
    }
  }
}

bool CubePlaces::lies(Place wanted, const PreciseVector& centre, const Real& half_width,
                      const Hook& interrupted) const {
  constexpr std::size_t most_parts = 4096;
  struct Part {
    PreciseVector centre;
    Real half;
  };
  std::vector<Part> parts{{centre, half_width}};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (interrupted && interrupted()) return false;
    const Part part = parts[i];
    std::vector<Place> places;
    bool may_be_settled = false;  // by smaller parts
    for (const Solid& solid : solids_) {
      const auto* const mesh = std::get_if<std::shared_ptr<const MeshSolid>>(&solid);
      places.push_back(mesh != nullptr ? (*mesh)->place_of_cube(part.centre, part.half)
                                       : place_of(part.centre + box_of({part.half, part.half, part.half}),
                                                  std::get<PosedPrimitive>(solid)));
      may_be_settled = may_be_settled || (mesh == nullptr && places.back() == Place::undecided);
    }
    const Place place = place_of(set_, places);
    if (place == wanted) continue;
    // A mesh is undecided where a triangle comes in: of one alone some part always stays so.
    may_be_settled = may_be_settled || std::ranges::count(places, Place::undecided) > 1;
    if (place != Place::undecided || !may_be_settled || parts.size() > most_parts) return false;
    const Real quarter = (PreciseInterval(part.half) * PreciseInterval(Real(0.5))).upper();
    for (unsigned n = 0; n < 8; ++n) {
      const auto step = [&](unsigned k) { return (n >> k & 1U) != 0 ? quarter : -quarter; };
      parts.push_back({part.centre + PreciseVector(step(0), step(1), step(2)), quarter});
    }
  }
  return true;
}

Real CubePlaces::reach(const PreciseVector& centre) const {
  const auto of_mesh = [&](const MeshSolid& mesh) {
    const auto [own, radius] = mesh.sphere();
    return length<Real>(PreciseVector(mesh.motion()(own) - centre)) + radius;
  };
  const auto of_primitive = [&](const auto& solid) {
    return length<Real>(PreciseVector(solid.motion().translation - centre)) + solid.radius();
  };
  Real farthest(0);
  for (const Solid& solid : solids_) {
    const auto* const mesh = std::get_if<std::shared_ptr<const MeshSolid>>(&solid);
    const PreciseInterval reach =
        mesh != nullptr ? of_mesh(**mesh) : std::visit(of_primitive, std::get<PosedPrimitive>(solid));
    farthest = std::max(farthest, reach.upper());
  }
  return farthest;
}

}  // namespace verisq::verify
