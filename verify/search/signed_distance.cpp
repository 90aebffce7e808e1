/// This file implements the signed distances of verisq/distance.hpp.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "verify/proof/exact_checker.hpp"
#include "verify/proof/uncertain_model.hpp"
#include "verify/search/certified_distance.hpp"
#include "verify/search/mesh_union.hpp"
#include "verify/search/set_tree.hpp"
#include "verify/search/solid_certificate.hpp"
#include "verify/search/solid_distance.hpp"
#include "verify/search/union_of_convex.hpp"
#include "verify/solids/model.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/error.hpp"
#include "verisq/model.hpp"

namespace verisq::verify {
namespace {

void add_leaves(const SetNode& node, std::set<std::uint32_t>& leaves) {
  if (node.kind == SetNode::Kind::leaf) leaves.insert(node.primitive);
  for (const SetNode& operand : node.operands) add_leaves(operand, leaves);
}

/// A primitive of the tree, alone.
class Part {
 public:
  Part(const Primitive& primitive, std::uint32_t index) : index_(index), part_(part_of(primitive)) {
    if (!is_bent(primitive)) return;
    const Model alone{.units = {}, .primitives = {primitive}};
    inside_ = std::make_unique<SolidDistance>(alone);
    roughness_ = 1e-3 * bounding_radius(alone);
  }

  [[nodiscard]] std::uint32_t index() const { return index_; }
  [[nodiscard]] double lower_by_sphere(const Point& x) const { return verify::lower_by_sphere(part_, x); }
  [[nodiscard]] ClosestSurfacePoint closest(const Point& x) const { return closest_surface_point(part_, x); }

  /// Contains the signed distance, inside bent ones, too.
  [[nodiscard]] Enclosure signed_distance(const Point& x) const {
    const Enclosure found = rough_distance(part_, x);
    if (!inside_ || found.lo > 0.0) return found;
    return (*inside_)(x, roughness_, {-infinity, found.hi}, [] { return false; });
  }

 private:
  std::uint32_t index_;
  UnionPart part_;
  std::unique_ptr<SolidDistance> inside_;  ///< for bent parts
  double roughness_ = 0.0;
};

/// The known distance of a part's surface from x.
struct Surface {
  const Part* part;
  Enclosure distance;  ///< signed

  /// Bounds of the distance of x from the surface.
  [[nodiscard]] double nearest() const { return std::max({distance.lo, -distance.hi, 0.0}); }
  [[nodiscard]] double farthest() const { return std::max(distance.hi, -distance.lo); }
};

ClosestPoint answer_of(const Surface& surface, const Point& x, bool is_complement) {
  auto [distance, point, normal, unique] = surface.part->closest(x);
  if (!unique && std::isinf(distance.lower().to_double(Direction::down))) {
    ClosestPoint found = closest_point_within(surface.distance, x);
    if (is_complement) found.distance = {-surface.distance.hi, -surface.distance.lo};
    found.primitive = surface.part->index();
    return found;
  }
  if (is_complement) {
    distance = -distance;
    for (std::size_t k = 0; k < 3; ++k) normal[k] = -normal[k];
  }
  return {rounded_outward(distance), rounded_outward(point), rounded_outward(normal), surface.part->index(), unique};
}

}  // namespace

struct SetClosestPoint::State {
  explicit State(const Model& model) : tree(normal_form(model, Side::inside)), primitives(model.primitives.size()) {
    std::set<std::uint32_t> leaves;
    add_leaves(tree, leaves);
    parts.reserve(leaves.size());
    for (const std::uint32_t leaf : leaves) parts.emplace_back(model.primitives[leaf], leaf);
  }

  /// The model's relation to the primitive `deciding` within the distance of its surface: black if the model is that
  /// primitive there, white if it is the primitive's complement, gray if neither is proven. The ball lies outside of
  /// all parts that are not among `known`.
  [[nodiscard]] Colour share(const Surface& deciding, std::span<const Surface> known) const {
    std::vector<Colour> colours(primitives, Colour::white);
    for (const Surface& other : known) {
      // Strictly: then the same holds of a larger ball, and about p, too.
      if (!(other.nearest() > deciding.farthest()))
        colours[other.part->index()] = Colour::gray;
      else if (other.distance.hi < 0.0)
        colours[other.part->index()] = Colour::black;
    }
    colours[deciding.part->index()] = Colour::black;
    const Colour where_it_is = colour(tree, colours);
    colours[deciding.part->index()] = Colour::white;
    const Colour where_it_is_not = colour(tree, colours);
    if (where_it_is == Colour::gray || where_it_is_not == Colour::gray || where_it_is == where_it_is_not)
      return Colour::gray;
    return where_it_is;
  }

  SetNode tree;
  std::vector<Part> parts;
  std::size_t primitives;
};

SetClosestPoint::SetClosestPoint(const Model& model) : state_(hidden<State>(model)) {}

std::optional<ClosestPoint> SetClosestPoint::operator()(const Point& x, double farthest) const {
  const std::vector<Part>& parts = state_->parts;
  const auto order = nearest_spheres_first(parts.size(), [&](std::size_t i) { return parts[i].lower_by_sphere(x); });
  std::vector<Surface> known;       // all parts whose bounding spheres are no farther than the present one
  std::vector<Surface> candidates;  // of these, the ones that have not been asked
  for (std::size_t next = 0; next <= order.size(); ++next) {
    // Parts from here on lie outside a ball of that radius.
    const double clear = next < order.size() ? order[next].sphere_bound : infinity;
    std::ranges::sort(candidates, {}, &Surface::farthest);
    auto candidate = candidates.begin();
    for (; candidate != candidates.end() && candidate->farthest() < clear; ++candidate) {
      if (candidate->nearest() > farthest) return std::nullopt;
      const Colour share = state_->share(*candidate, known);
      if (share != Colour::gray) return answer_of(*candidate, x, share == Colour::white);
    }
    candidates.erase(candidates.begin(), candidate);
    if (next == order.size()) break;
    const Part& part = parts[order[next].index];
    known.push_back({&part, part.signed_distance(x)});
    candidates.push_back(known.back());
  }
  return std::nullopt;
}

}  // namespace verisq::verify

namespace verisq {

namespace {

bool removes(const SetExpression& expression) {
  return (expression.operation == SetOperation::subtract && expression.operands.size() > 1) ||
         std::ranges::any_of(expression.operands, removes);
}

/// The primitives that a tree names, with a removed use of a primitive apart from a kept use. A solid grows if its kept
/// primitives grow, and shrinks if its removed ones do (docs/mathematics.md §8).
class NamedPrimitives {
 public:
  struct Use {
    std::uint32_t primitive;
    bool removed;
    bool operator==(const Use&) const = default;
  };

  /// The same tree, with indices of uses(). A primitive removed from a removed operand is kept.
  [[nodiscard]] SetExpression renamed(const SetExpression& expression, bool removed = false) {
    SetExpression result{.operation = expression.operation};
    for (std::size_t i = 0; i < expression.operands.size(); ++i) {
      const bool turns = expression.operation == SetOperation::subtract && i > 0;
      result.operands.push_back(renamed(expression.operands[i], removed != turns));
    }
    if (expression.operands.empty()) result.primitive = index_of({expression.primitive, removed});
    return result;
  }
  [[nodiscard]] const std::vector<Use>& uses() const { return uses_; }

 private:
  [[nodiscard]] std::uint32_t index_of(const Use& use) {
    const auto found = std::ranges::find(uses_, use);
    const auto index = static_cast<std::uint32_t>(found - uses_.begin());
    if (found == uses_.end()) uses_.push_back(use);
    return index;
  }

  std::vector<Use> uses_;
};

/// Exchanges the removed primitives of both models: where one model has the smallest primitive, the other has the
/// largest.
void exchange_what_is_removed(Bracket& models) {
  NamedPrimitives named;
  const SetExpression csg = named.renamed(*models.smallest.csg);
  Model smallest{models.smallest.units, {}, csg};
  Model largest{models.largest.units, {}, csg};
  for (const auto& [primitive, removed] : named.uses()) {
    smallest.primitives.push_back((removed ? models.largest : models.smallest).primitives[primitive]);
    largest.primitives.push_back((removed ? models.smallest : models.largest).primitives[primitive]);
  }
  models.smallest = std::move(smallest);
  models.largest = std::move(largest);
}

}  // namespace

Bracket bracket(const UncertainModel& model) {
  Bracket result = verify::bracket_of_primitives(model);
  if (is_exact(model)) return result;
  if (result.shift > 0.0) verify::require_union_of_convex(result.largest, "intervals of translations");
  if (model.csg && removes(*model.csg)) exchange_what_is_removed(result);
  return result;
}

namespace {

constexpr Enclosure nothing_known{-infinity, infinity};

/// Narrower enclosures are not searched for, in parts of the model's radius.
constexpr double search_limit = 1e-10;

/// Share of a tolerance inside. The upper end that one primitive alone proves may be loose: most is left for that.
constexpr double share_of_escape = 1.0 / 16;

bool never() {
  return false;
}

/// The data for certificates of convex primitives.
struct ConvexUnion {
  explicit ConvexUnion(const Model& model) : primitives(model.primitives.begin(), model.primitives.end()) {}

  /// Outside, and for a single primitive, certificates are tight. If primitives may overlap, their union is deeper than
  /// each of them, and the escape along a ray may be far from the shortest.
  [[nodiscard]] bool loose(const Enclosure& found, double tolerance) const {
    return primitives.size() > 1 && !(found.lo > 0.0) && !verified(found, tolerance);
  }

  std::vector<verify::ConvexPrimitive> primitives;
};

void require_query(const Point& point, double tolerance) {
  verify::require_finite(point, "point");
  verify::require_tolerance(tolerance);
}

std::vector<verify::UnionPart> parts_of(const Model& model) {
  std::vector<verify::UnionPart> parts;
  for (const Primitive& primitive : model.primitives) parts.push_back(verify::part_of(primitive));
  return parts;
}

}  // namespace

namespace {

/// For models of superquadrics alone.
struct Superquadrics {
  explicit Superquadrics(const Model& model)
      : search(model),
        checker(model),
        parts(parts_of(model)),
        is_union(verify::is_union(model)),
        resolution(search_limit * bounding_radius(model)) {
    if (is_union_of_convex(model))
      convex.emplace(model);
    else if (!is_union)
      operations.emplace(model);
  }

  [[nodiscard]] Enclosure searched(const Point& point, double tolerance, const Enclosure& known,
                                   const std::function<bool()>& interrupted) const {
    return search(point, std::max(tolerance, resolution), known, interrupted);
  }

  /// `known`: contains the signed distance; only saves time.
  [[nodiscard]] std::optional<ClosestPoint> proven_closest_point(const Point& point, const Enclosure& known) const {
    if (convex) return verify::closest_point(convex->primitives, point);
    if (operations) return (*operations)(point, std::max(-known.lo, known.hi));
    return verify::closest_point(parts, point);
  }

  [[nodiscard]] ClosestPoint closest_point_within(const Enclosure& distance, const Point& point) const {
    ClosestPoint result = verisq::closest_point_within(distance, point);
    if (parts.size() == 1) result.primitive = 0;  // no other has a surface
    return result;
  }

  /// The enclosure that single primitives prove for a union, without covers.
  [[nodiscard]] CertifiedEnclosure certified(const Point& point, double tolerance,
                                             const std::function<bool()>& interrupted) const {
    const double width = std::max(tolerance, resolution);
    if (!convex) {
      return verify::bent_union_certificate(
          parts, checker, point, [&] { return search.escape(point, share_of_escape * width, interrupted); },
          interrupted);
    }
    const auto proven = [&](CertifiedEnclosure found) {
      found.distance = checker(point, found.distance, found.certificate, interrupted);
      return found;
    };
    const CertifiedEnclosure found = proven(verify::signed_distance(convex->primitives, point, tolerance));
    if (!convex->loose(found.distance, width)) return found;
    CertifiedEnclosure nearer = found;
    nearer.certificate.escape = search.escape(point, std::max(share_of_escape * tolerance, resolution), interrupted);
    nearer = proven(nearer);
    return nearer.distance.lo > found.distance.lo ? nearer : found;
  }

  std::optional<ConvexUnion> convex;
  std::optional<verify::SetClosestPoint> operations;  ///< set if there are other operations than the union
  verify::SolidDistance search;
  verify::ExactChecker checker;
  std::vector<verify::UnionPart> parts;
  bool is_union;
  double resolution;
};

}  // namespace

/// One of the three.
struct SignedDistance::State {
  explicit State(const Model& model) : resolution(search_limit * bounding_radius(model)) {
    if (!has_mesh(model))
      superquadrics.emplace(model);
    else if (verify::is_union(model))
      meshes.emplace(model);
    else
      sets_of_meshes.emplace(model);
  }

  [[nodiscard]] std::optional<ClosestPoint> proven_closest_point(const Point& point, const Enclosure& known) const {
    if (superquadrics) return superquadrics->proven_closest_point(point, known);
    return meshes ? meshes->closest_point(point) : std::nullopt;
  }

  [[nodiscard]] ClosestPoint closest_point_within(const Enclosure& distance, const Point& point) const {
    return superquadrics ? superquadrics->closest_point_within(distance, point)
                         : verisq::closest_point_within(distance, point);
  }

  std::optional<Superquadrics> superquadrics;
  std::optional<verify::MeshUnion> meshes;              ///< with superquadrics or without
  std::optional<verify::SolidDistance> sets_of_meshes;  ///< of other set operations
  double resolution;
};

SignedDistance::SignedDistance(const Model& model) {
  verify::require_valid_with_meshes(model);
  state_ = hidden<State>(model);
}

Enclosure SignedDistance::operator()(const Point& point, double tolerance) const {
  return (*this)(point, tolerance, never);
}

Enclosure SignedDistance::operator()(const Point& point, double tolerance,
                                     const std::function<bool()>& interrupted) const {
  require_query(point, tolerance);
  if (state_->meshes) return (*state_->meshes)(point, tolerance, false, interrupted).distance;
  if (state_->sets_of_meshes) {
    const double width = std::max(tolerance, state_->resolution);
    return (*state_->sets_of_meshes)(point, width, nothing_known, interrupted);
  }
  const Superquadrics& solids = *state_->superquadrics;
  if (!solids.convex) return solids.searched(point, tolerance, nothing_known, interrupted);
  const Enclosure known = verify::signed_distance(solids.convex->primitives, point, tolerance).distance;
  if (!solids.convex->loose(known, std::max(tolerance, solids.resolution))) return known;
  return solids.searched(point, tolerance, known, interrupted);
}

ClosestPoint SignedDistance::closest_point(const Point& point, double tolerance,
                                           const std::function<bool()>& interrupted) const {
  require_query(point, tolerance);
  if (const std::optional<ClosestPoint> found = state_->proven_closest_point(point, nothing_known)) return *found;
  const std::function<bool()> uninterrupted = never;
  return state_->closest_point_within((*this)(point, tolerance, interrupted ? interrupted : uninterrupted), point);
}

ClosestPoint SignedDistance::closest_point(const Point& point, const Enclosure& known) const {
  verify::require_finite(point, "point");
  if (!(known.lo <= known.hi))
    throw Error(ErrorKind::input, fmt::format("known = [{}, {}]: must hold a number", known.lo, known.hi));
  const std::optional<ClosestPoint> found = state_->proven_closest_point(point, known);
  return found ? *found : state_->closest_point_within(known, point);
}

CertifiedEnclosure SignedDistance::certified(const Point& point, double tolerance) const {
  return certified(point, tolerance, never);
}

CertifiedEnclosure SignedDistance::certified(const Point& point, double tolerance,
                                             const std::function<bool()>& interrupted, bool covers) const {
  require_query(point, tolerance);
  if (state_->meshes) return (*state_->meshes)(point, tolerance, true, interrupted);
  if (state_->sets_of_meshes)
    throw Error(ErrorKind::input, "certificates: not supported for set operations with meshes, but for their union");
  const Superquadrics& state = *state_->superquadrics;
  if (!covers && !state.is_union) throw Error(ErrorKind::input, "certificates without covers: only for unions");
  const CertifiedEnclosure found =
      state.is_union ? state.certified(point, tolerance, interrupted) : CertifiedEnclosure{nothing_known, {}};
  if (!covers) return found;
  const double width = std::max(tolerance, state.resolution);
  return verify::covered({state.parts, state.search, state.checker}, point, found, width, interrupted);
}

}  // namespace verisq
