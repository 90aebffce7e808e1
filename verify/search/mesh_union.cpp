/// This file implements mesh_union.hpp.
#include "verify/search/mesh_union.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "verify/numbers/functions.hpp"
#include "verify/numbers/points.hpp"
#include "verify/search/set_tree.hpp"
#include "verify/solids/model.hpp"

namespace verisq::verify {

namespace {

/// The closest point of one triangle, and the corner, side or face that it is the inside of: by its corners in order,
/// the others repeated. Equal ones are one feature of the mesh.
struct Foot {
  PreciseVector point;
  PreciseInterval distance;
  std::array<Point, 3> feature;
};

bool is_at_most_0(const PreciseInterval& x) {
  return x.upper() <= Real(0);
}

bool is_above_0(const PreciseInterval& x) {
  return x.lower() > Real(0);
}

Foot foot(const PreciseVector& query, const PreciseVector& point, std::array<Point, 3> feature) {
  std::ranges::sort(feature);
  return {point, length<Real>(PreciseVector(query - point)), feature};
}

/// A point p of a convex set is its closest point if and only if (q - p)·(v - p) <= 0 for all v in it: of a triangle,
/// for its corners.
std::optional<Foot> corner_foot(const PreciseVector& query, const Triangle& triangle, std::size_t k) {
  const PreciseVector corner = precise(triangle[k]);
  const PreciseVector way = query - corner;
  for (const std::size_t other : {(k + 1) % 3, (k + 2) % 3}) {
    if (!is_at_most_0(way.dot(precise(triangle[other]) - corner))) return std::nullopt;
  }
  return foot(query, corner, {triangle[k], triangle[k], triangle[k]});
}

/// Along the side from k to the next corner the product is 0: it is left to show for the third.
std::optional<Foot> side_foot(const PreciseVector& query, const Triangle& triangle, std::size_t k) {
  const Point& a = triangle[k];
  const Point& b = triangle[(k + 1) % 3];
  const PreciseVector side = precise(b) - precise(a);
  const PreciseInterval square_of_side = side.dot(side);
  if (!is_above_0(square_of_side)) return std::nullopt;
  const PreciseInterval share = PreciseVector(query - precise(a)).dot(side) / square_of_side;
  if (!is_above_0(share) || !is_above_0(PreciseInterval(1) - share)) return std::nullopt;
  const PreciseVector point = precise(a) + side * share;
  if (!is_at_most_0(PreciseVector(query - point).dot(precise(triangle[(k + 2) % 3]) - point))) return std::nullopt;
  return foot(query, point, {a, std::min(a, b), b});  // the same from either end, when it is sorted
}

/// The foot on the plane, where it lies before the inside of each side.
std::optional<Foot> face_foot(const PreciseVector& query, const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  const PreciseVector normal = cross<Real>(precise(b) - precise(a), precise(c) - precise(a));
  const PreciseInterval square_of_normal = normal.dot(normal);
  if (!is_above_0(square_of_normal)) return std::nullopt;
  for (std::size_t k = 0; k < 3; ++k) {
    const PreciseVector from = precise(triangle[k]);
    const PreciseVector inward = cross<Real>(normal, PreciseVector(precise(triangle[(k + 1) % 3]) - from));
    if (!is_above_0(inward.dot(query - from))) return std::nullopt;
  }
  const PreciseInterval height = PreciseVector(query - precise(a)).dot(normal) / square_of_normal;
  return foot(query, query - normal * height, {a, b, c});
}

std::optional<Foot> foot_on(const PreciseVector& query, const Triangle& triangle) {
  if (auto found = face_foot(query, triangle)) return found;
  for (std::size_t k = 0; k < 3; ++k) {
    if (auto found = side_foot(query, triangle, k)) return found;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    if (auto found = corner_foot(query, triangle, k)) return found;
  }
  return std::nullopt;
}

/// The only closest point of all triangles within reach. Any triangle that holds a closest point is among them.
std::optional<Foot> only_foot(const PreciseVector& query, const Point& about, double reach, const WideTree& tree) {
  std::vector<std::uint32_t> near;
  tree.within(about, reach, near);
  std::vector<Foot> feet;
  for (const std::uint32_t n : near) {
    if (distance_bounds(about, tree.triangle(n)).lower > reach) continue;
    const std::optional<Foot> found = foot_on(query, tree.triangle(n));
    if (!found) return std::nullopt;
    feet.push_back(*found);
  }
  if (feet.empty()) return std::nullopt;
  const auto nearest =
      std::ranges::min_element(feet, {}, [](const Foot& one) { return one.distance.upper().to_double(Direction::up); });
  for (const Foot& other : feet) {
    if (other.feature != nearest->feature && !(other.distance.lower() > nearest->distance.upper())) return std::nullopt;
  }
  return *nearest;
}

PreciseVector in_model(const PosedMesh& mesh, const PreciseVector& own) {
  return mesh.motion() ? (*mesh.motion())(own) : own;
}

PreciseVector turned_to_model(const PosedMesh& mesh, const PreciseVector& own) {
  return mesh.motion() ? mesh.motion()->rotation * own : own;
}

}  // namespace

/// If triangles do not cross, the surface is the solid's boundary, and one closest point makes the distance
/// differentiable, with the normal as its gradient.
std::optional<ClosestPoint> closest_point(const PosedMesh& mesh, const Point& point) {
  const ClosedMesh::Distance found = mesh.signed_distance(point);
  const Enclosure& distance = found.signed_distance;
  const bool inside = distance.hi < 0.0;
  if (!inside && !(distance.lo > 0.0)) return std::nullopt;
  if (inside && !mesh.mesh().facts().depth_is_exact()) return std::nullopt;
  const PreciseVector query = mesh.motion() ? mesh.motion()->local_point(point) : precise(point);
  Point about;
  for (std::size_t i = 0; i < 3; ++i) about[i] = query[i].lower().to_double(Direction::down);
  // `about` lies within the width of `distance` of the exact place, on both of whose sides the pose widened it.
  const double reach = std::max(std::abs(distance.lo), std::abs(distance.hi)) + 2.0 * distance.width() +
                       0x1p-48 * largest_coordinate(about);
  const std::optional<Foot> closest = only_foot(query, about, reach, mesh.mesh().tree());
  if (!closest) return std::nullopt;
  const PreciseVector way = PreciseVector(query - closest->point) / closest->distance;
  const PreciseVector outward = turned_to_model(mesh, inside ? -way : way);
  const Enclosure to_foot = rounded_outward(inside ? -closest->distance : closest->distance);
  return ClosestPoint{{std::max(to_foot.lo, distance.lo), std::min(to_foot.hi, distance.hi)},
                      rounded_outward(in_model(mesh, closest->point)),
                      rounded_outward(outward),
                      std::nullopt,
                      true};
}

namespace {

constexpr double anything = infinity;

bool never() {
  return false;
}

double size_of(const Model& model) {
  const Box box = bounding_box(model);
  return std::max(largest_coordinate(box.lower), largest_coordinate(box.upper));
}

Point moved(const Point& from, const Point& direction, double way) {
  Point to;
  for (std::size_t i = 0; i < 3; ++i) to[i] = from[i] + direction[i] * way;
  return to;
}

}  // namespace

MeshUnion::MeshUnion(const Model& model) : size_(size_of(model)) {
  require_union(model, "meshes");
  Model others{model.units, {}, {}};
  for (std::uint32_t n = 0; n < model.primitives.size(); ++n) {
    if (model.primitives[n].mesh) {
      meshes_.push_back({n, PosedMesh(model.primitives[n])});
    } else {
      others.primitives.push_back(model.primitives[n]);
      index_of_.push_back(n);
    }
  }
  if (model.primitives.size() > 1) search_ = std::make_unique<SolidDistance>(model);
  if (others.primitives.empty()) return;
  to_others_ = std::make_unique<SignedDistance>(others);
  others_ = std::move(others);
}

MeshUnion::~MeshUnion() = default;
MeshUnion::MeshUnion(MeshUnion&&) noexcept = default;
MeshUnion& MeshUnion::operator=(MeshUnion&&) noexcept = default;

CertifiedEnclosure MeshUnion::operator()(const Point& point, double tolerance, bool certified,
                                         const std::function<bool()>& interrupted) const {
  std::vector<ClosedMesh::Distance> to_meshes;
  to_meshes.reserve(meshes_.size());
  for (const Part& part : meshes_) to_meshes.push_back(part.mesh.signed_distance(point));
  std::optional<CertifiedEnclosure> to_others;
  if (to_others_) {
    to_others = certified ? to_others_->certified(point, tolerance, interrupted, false)
                          : CertifiedEnclosure{(*to_others_)(point, tolerance, interrupted), {}};
  }
  CertifiedEnclosure found = joined(point, to_meshes, to_others);
  narrow(point, tolerance, certified, interrupted, found);
  return found;
}

namespace {

/// Share of the size: no narrower enclosure is searched for.
constexpr double search_limit = 1e-10;

}  // namespace

void MeshUnion::narrow(const Point& point, double tolerance, bool certified, const std::function<bool()>& interrupted,
                       CertifiedEnclosure& found) const {
  const double width = std::max(tolerance, search_limit * size_);
  Enclosure& distance = found.distance;
  if (!search_ || distance.width() <= width) return;
  if (!certified) {
    distance = (*search_)(point, width, distance, interrupted);
    return;
  }
  const std::optional<Point> out = search_->escape(point, 0.25 * width, interrupted);
  if (!out || !(distance.lo < 0.0) || !(-distance_up(point, *out) > distance.lo) || !is_outside(*out)) return;
  distance.lo = -distance_up(point, *out);
  found.certificate.escape = out;
}

/// The union is no farther than any part. Outside of all parts, not on them, it is as far as the nearest. Elsewhere a
/// point outside of all parts bounds how deep the query lies.
CertifiedEnclosure MeshUnion::joined(const Point& point, std::span<const ClosedMesh::Distance> to_meshes,
                                     const std::optional<CertifiedEnclosure>& to_others) const {
  CertifiedEnclosure result{{infinity, infinity}, {}};
  const auto join = [&](const Enclosure& of_part) {
    result.distance = {std::min(result.distance.lo, of_part.lo), std::min(result.distance.hi, of_part.hi)};
  };
  for (const ClosedMesh::Distance& distance : to_meshes) join(distance.signed_distance);
  if (to_others) {
    join(to_others->distance);
    result.certificate.normals = renumbered(to_others->certificate.normals);
  }
  if (to_meshes.size() + index_of_.size() == 1 || result.distance.lo > 0.0) return result;
  result.distance.lo = -infinity;
  result.certificate.escape = escape(point, to_meshes, to_others && !(to_others->distance.lo > 0.0));
  if (result.certificate.escape) result.distance.lo = -distance_up(point, *result.certificate.escape);
  return result;
}

std::vector<Normal> MeshUnion::renumbered(std::vector<Normal> normals) const {
  for (Normal& normal : normals) normal.primitive = index_of_[normal.primitive];
  return normals;
}

bool MeshUnion::is_outside(const Point& point) const {
  const auto misses = [&](const Part& part) { return part.mesh.signed_distance(point).signed_distance.lo > 0.0; };
  return std::ranges::all_of(meshes_, misses) && (!to_others_ || (*to_others_)(point, anything, never).lo > 0.0);
}

/// Tries a little before the closest point of each part, and at last beyond the box of all.
std::optional<Point> MeshUnion::escape(const Point& point, std::span<const ClosedMesh::Distance> to_meshes,
                                       bool may_be_in_others) const {
  std::optional<Point> nearest;
  double least = infinity;
  const auto offer = [&](const Point& from, const Point& outward) {
    for (const double share : {0x1p-48, 0x1p-44, 0x1p-38, 0x1p-30}) {
      const Point candidate = moved(from, outward, share * size_);
      const double way = distance_up(point, candidate);
      if (way >= least) return;
      if (!is_outside(candidate)) continue;
      nearest = candidate;
      least = way;
      return;
    }
  };
  for (const ClosedMesh::Distance& distance : to_meshes) offer(distance.closest, distance.normal);
  if (may_be_in_others) {
    const ClosestPoint closest = to_others_->closest_point(point, Enclosure{-infinity, infinity});
    Point from;
    Point outward;
    for (std::size_t i = 0; i < 3; ++i) {
      from[i] = 0.5 * closest.point[i].lo + 0.5 * closest.point[i].hi;
      outward[i] = 0.5 * closest.normal[i].lo + 0.5 * closest.normal[i].hi;
    }
    if (closest.unique) offer(from, outward);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    for (const double side : {-1.0, 1.0}) {
      Point beyond = point;
      beyond[i] = side * size_;
      Point outward{};
      outward[i] = side;
      offer(beyond, outward);
    }
  }
  return nearest;
}

std::optional<ClosestPoint> MeshUnion::closest_point(const Point& point) const {
  std::vector<Enclosure> distances;
  for (const Part& part : meshes_) distances.push_back(part.mesh.signed_distance(point).signed_distance);
  if (to_others_) distances.push_back((*to_others_)(point, 0.0));
  const auto nearest =
      static_cast<std::size_t>(std::ranges::min_element(distances, {}, &Enclosure::hi) - distances.begin());
  // The closest point of a part is that of the union if all others are farther, and the query is outside of all.
  for (std::size_t n = 0; n < distances.size(); ++n) {
    if (n != nearest && !(distances[n].lo > distances[nearest].hi)) return std::nullopt;
  }
  if (distances.size() > 1 && !(distances[nearest].lo > 0.0)) return std::nullopt;
  if (nearest == meshes_.size()) {
    ClosestPoint found = to_others_->closest_point(point, distances[nearest]);
    if (found.primitive) found.primitive = index_of_[*found.primitive];
    return found;
  }
  std::optional<ClosestPoint> found = verify::closest_point(meshes_[nearest].mesh, point);
  if (found) found->primitive = meshes_[nearest].primitive;
  return found;
}

}  // namespace verisq::verify
