/// Best-first search over cubes of the model frame: the cube that may hold the nearest point is halved next.
#include "verify/search/solid_distance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <queue>
#include <span>
#include <utility>
#include <vector>

#include "verify/numbers/points.hpp"
#include "verify/proof/verdict.hpp"
#include "verify/search/bent_distance.hpp"
#include "verify/search/certified_distance.hpp"
#include "verify/search/closed_mesh.hpp"
#include "verify/search/convex_primitive.hpp"
#include "verify/search/octree_cube.hpp"
#include "verify/search/polytope_distance.hpp"
#include "verify/search/set_tree.hpp"
#include "verify/solids/superquadric.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/error.hpp"

namespace verisq::verify {

namespace {

constexpr std::size_t kMostCubes = 20000;
/// The largest number of leaf evaluations for the points that primitives propose before the search: each point is tried
/// against the whole tree.
constexpr std::size_t kMostLooks = std::size_t{1} << 16;

Proposal from(const Point& a, const Point& b) {
  const auto part = [&](std::size_t i) { return static_cast<long double>(b[i]) - a[i]; };
  return {part(0), part(1), part(2)};
}

/// The solid, ready for searches.
struct Scene {
  explicit Scene(const Model& model)
      : inside(normal_form(model, Side::inside)),
        outside(normal_form(model, Side::outside)),
        root(root_cube(bounding_box(model))) {
    for (const Primitive& primitive : model.primitives) {
      primitives.emplace_back(primitive);
      origins.push_back(primitive.pose.translation);
      const bool is_convex = !primitive.mesh && !is_bent(primitive);
      convex.push_back(is_convex ? std::optional<ConvexPrimitive>(primitive) : std::nullopt);
      bent.push_back(is_bent(primitive) ? std::optional<BentDistance>(primitive) : std::nullopt);
    }
  }

  [[nodiscard]] const PosedMesh* mesh(std::size_t primitive) const { return primitives[primitive].mesh(); }

  /// From p into the primitive. Bent or not, a superquadric contains the origin of its frame. Into a mesh leads the
  /// mean normal of the surface about p.
  [[nodiscard]] Proposal inwards(std::size_t primitive, const Point& p, double about) const {
    const PosedMesh* const solid = mesh(primitive);
    if (!solid) return from(p, origins[primitive]);
    Point n = half_space(*solid, {p, about}, Side::inside).normal;
    if (n == Point{}) n = solid->signed_distance(p).normal;
    return {-n[0], -n[1], -n[2]};
  }

  SetNode inside;
  SetNode outside;           ///< the closure of its complement
  std::optional<Cube> root;  ///< contains the solid; nothing if the solid is too large for binary64
  std::vector<BoxPrimitive> primitives;
  std::vector<Point> origins;                          ///< origins of the primitives' frames
  std::vector<std::optional<ConvexPrimitive>> convex;  ///< nothing if the primitive is bent, or a mesh
  std::vector<std::optional<BentDistance>> bent;       ///< nothing if the primitive is convex, or a mesh
};

/// The primitives of the leaves on that side.
void append_leaves(const SetNode& node, Side side, std::vector<std::uint32_t>& leaves) {
  if (node.kind == SetNode::Kind::leaf && node.side == side) leaves.push_back(node.primitive);
  for (const SetNode& operand : node.operands) append_leaves(operand, side, leaves);
}

/// Primitives that are subsets of the whole set: operands of unions alone.
void mark_subsets(const SetNode& node, std::vector<bool>& marks) {
  if (node.kind == SetNode::Kind::leaf && node.side == Side::inside) marks[node.primitive] = true;
  if (node.kind != SetNode::Kind::union_of) return;
  for (const SetNode& operand : node.operands) mark_subsets(operand, marks);
}

std::vector<Colour> colours_at(const Scene& scene, const Point& x) {
  std::vector<Colour> result;
  for (const BoxPrimitive& primitive : scene.primitives) result.push_back(primitive.colour({x, 0.0}));
  return result;
}

/// p moved by about `length` along v.
Point moved(const Point& p, const Proposal& v, long double length) {
  const long double scale = length / std::hypot(v[0], v[1], v[2]);
  return {static_cast<double>(p[0] + scale * v[0]), static_cast<double>(p[1] + scale * v[1]),
          static_cast<double>(p[2] + scale * v[2])};
}

/// The rounding error of lengths computed with numbers of this size.
double rounding_error(const Point& x, const Cube& root) {
  double size = root.half_width;
  for (std::size_t i = 0; i < 3; ++i) size = std::max({size, std::fabs(x[i]), std::fabs(root.centre[i])});
  return 0x1p-48 * size;
}

/// Solids may be so small that rounding errors underflow: parts of this are positive still.
constexpr double least_tolerance = 0x1p-1060;

/// A part of space that may hold the point of the target nearest to the query.
struct Node {
  Cube cube;
  SetNode tree;     ///< the target within the cube
  double lower;     ///< proven of the distance to the target within the cube
  Point candidate;  ///< a possible nearest point; proves nothing
};

struct LessPromising {
  bool operator()(const Node& a, const Node& b) const { return a.lower > b.lower; }
};

/// The distance d(x, T) of one point to one target set T within the root cube.
class Search {
 public:
  /// T is the solid, or with Side::outside the closure of its complement, for which x must lie in the root cube.
  /// `primitives_at_x` are the colours of all primitives at x; `known` encloses d(x, T).
  Search(const Scene& scene, Side side, const Point& x, std::span<const Colour> primitives_at_x, double tolerance,
         const Enclosure& known)
      : scene_(scene),
        target_(side == Side::inside ? scene.inside : scene.outside),
        x_(x),
        resolution_(rounding_error(x, *scene.root)),
        tolerance_(std::max({tolerance, 16.0 * resolution_, least_tolerance})),
        known_(known),
        upper_(known.hi),
        colours_(scene.primitives) {
    if (side == Side::outside) {
      // All that lies beyond the root cube belongs to T, and is settled.
      const Enclosure beyond = distance_to_faces(x, *scene.root);
      settled_ = beyond.lo;
      found_upper(beyond.hi);
    }
    both_sides_ = on_both_sides(target_);
    for (std::size_t i = 0; i < scene.primitives.size(); ++i) has_mesh_ = has_mesh_ || scene.mesh(i) != nullptr;
    for (auto& bounds : leaf_bounds_) bounds.assign(scene.primitives.size(), 0.0);
    bound_primitives(primitives_at_x);
    bound_complements(primitives_at_x);
  }

  Search(const Search&) = delete;  // refers to itself
  Search& operator=(const Search&) = delete;

  /// The point of T that proved the upper bound, unless a whole cube, a certificate or `known` did.
  [[nodiscard]] const std::optional<Point>& witness() const { return witness_; }

  [[nodiscard]] Enclosure run(const std::function<bool()>& interrupted) {
    examine(*scene_.root, target_);
    while (!open_.empty()) {
      const Node node = open_.top();
      // Best first: no open cube has a lower bound below this one's.
      if (node.lower >= settled_ || finished(node.lower) || examined_ >= kMostCubes || interrupted()) {
        return enclosure(node.lower);
      }
      open_.pop();
      if (worth_improving(node.cube)) improve_upper(node);
      if (finished(node.lower)) return enclosure(node.lower);
      divide(node);
    }
    return enclosure(infinity);
  }

 private:
  /// Every point of T lies in an open cube, in a settled or in a dropped one.
  [[nodiscard]] Enclosure enclosure(double least_open) const {
    const auto what = [&] { return "the distance of " + text_of(x_) + " to the solid or its complement"; };
    return intersection(known_, between(std::min({least_open, settled_, dropped_}), found_upper_, what), what);
  }

  void found_upper(double distance) {
    found_upper_ = std::min(found_upper_, distance);
    upper_ = std::min(upper_, distance);
  }

  [[nodiscard]] bool finished(double least_open) const { return verified(enclosure(least_open), tolerance_); }

  void divide(const Node& node) {
    const auto children = halves(node.cube);
    if (!children) {
      settled_ = std::min(settled_, node.lower);
      return;
    }
    for (const Cube& child : *children) examine(child, node.tree);
  }

  /// `tree` is the target within the cube.
  void examine(const Cube& cube, const SetNode& tree) {
    ++examined_;
    const std::span<const Colour> found = colours_(tree, cube);
    const Colour all = colour(tree, found);
    if (all == Colour::white) return;
    if (all == Colour::black) {
      const Enclosure to_cube = distance(x_, cube);
      settled_ = std::min(settled_, to_cube.lo);
      found_upper(to_cube.hi);
      return;
    }
    Node node{cube, simplified(tree, found), 0.0, {}};
    const PolytopeDistance bound = SetRelaxation(x_, cube, scene_.primitives, leaf_bound_)(node.tree);
    node.lower = bound.lower;
    node.candidate = bound.nearest;
    if (node.lower >= upper_) {  // proven to be no nearer than a proven point of T
      dropped_ = std::min(dropped_, node.lower);
    } else {
      open_.push(std::move(node));
    }
  }

  // --- Upper bounds: points proven to lie in T ---

  /// `tree` is the target about p.
  bool accept(const Point& p, const SetNode& tree) {
    if (!is_finite(p)) return false;
    if (colour(tree, colours_(tree, {p, 0.0})) != Colour::black) return accept_surface_about(p);
    const double far = distance_up(x_, p);
    if (far < upper_) witness_ = p;
    found_upper(far);
    return true;
  }

  /// A boundary may be all of T about p, as the boundary of A is in A - (A - B). Its points need not be binary64
  /// numbers, but between a point strictly inside a primitive and one outside it there is one.
  bool accept_surface_about(const Point& p) {
    return std::ranges::any_of(both_sides_, [&](std::uint32_t primitive) {
      const Proposal inwards = scene_.inwards(primitive, p, tolerance_ / 4);
      const long double reach = tolerance_ / 8;
      return usable(inwards) &&
             accept_surface(primitive, moved(p, inwards, reach), moved(p, inwards, -reach), {p, tolerance_ / 4});
    });
  }

  /// The ends of a way in the cube.
  bool accept_surface(std::uint32_t primitive, const Point& inner, const Point& outer, const Cube& cube) {
    const BoxPrimitive& solid = scene_.primitives[primitive];
    if (!is_finite(inner) || !is_finite(outer) || !contains(cube, inner) || !contains(cube, outer)) return false;
    if (solid.colour({inner, 0.0}) != Colour::black || solid.colour({outer, 0.0}) != Colour::white) return false;
    if (colour_of_surface(target_, colours_(target_, cube), primitive) != Colour::black) return false;
    found_upper(std::max(distance_up(x_, inner), distance_up(x_, outer)));
    return true;
  }

  [[nodiscard]] PolytopeDistance proposal(const Node& node, const Cube& about, double margin) const {
    static const LeafBound nothing = [](const SetNode&) { return 0.0; };
    return SetRelaxation(x_, about, scene_.primitives, nothing, margin)(node.tree);
  }

  bool accept_proposal(const Point& p, const Node& node) {
    return accept(p, contains(node.cube, p) ? node.tree : target_);
  }

  /// True at each new scale, and now and then: proposals cost as much as dividing a cube.
  [[nodiscard]] bool worth_improving(const Cube& cube) {
    const bool smaller = cube.half_width < finest_;
    finest_ = std::min(finest_, cube.half_width);
    return smaller || visited_++ % 8 == 0;
  }

  /// Sequential linearisation: each relaxation is made about the last one's nearest point, in a cube that shrinks
  /// nearly quadratically, as its error does.
  void improve_upper(const Node& node) {
    constexpr std::array<int, 7> halvings{1, 2, 3, 5, 8, 13, 21};
    constexpr double reach = 8.0;  // in margins: how far the nearest point moves at corners that are not too sharp
    const double margin = std::min(tolerance_, node.cube.half_width) / 8;
    if (!(margin > 0.0)) return;
    Cube about{node.candidate, node.cube.half_width};
    for (const int n : halvings) {
      const double half_width = std::ldexp(node.cube.half_width, -n);
      if (n > 1 && !(half_width > reach * margin)) break;
      about.half_width = half_width;
      const PolytopeDistance found = proposal(node, about, margin);
      about.centre = found.nearest;
      if (!is_finite(found.nearest)) return;
      if (found.lower == infinity) continue;  // on its way to the set
      if (found.lower >= upper_) return;
      if (accept_proposal(found.nearest, node) && upper_ - found.lower <= tolerance_ / 2) return;
    }
    for (double wider = 2.0 * margin; wider < node.cube.half_width; wider *= 4.0) {
      const PolytopeDistance found = proposal(node, {about.centre, reach * wider}, wider);
      if (found.lower != infinity && (found.lower >= upper_ || accept_proposal(found.nearest, node))) return;
    }
    improve_towards_centres(node);
    if (has_mesh_) improve_away_from_planes(node);
  }

  /// The leaves whose origins are nearest to p: more than these cost more than they find, in large trees.
  [[nodiscard]] std::vector<std::uint32_t> leaves_about(const Point& p, const SetNode& tree, Side side) const {
    constexpr std::size_t most = 16;
    std::vector<std::uint32_t> leaves;
    append_leaves(tree, side, leaves);
    std::ranges::sort(leaves);
    leaves.erase(std::unique(leaves.begin(), leaves.end()), leaves.end());
    if (leaves.size() <= most) return leaves;
    const auto apart = [&](std::uint32_t i) {
      const Point& o = scene_.origins[i];
      return std::hypot(o[0] - p[0], o[1] - p[1], o[2] - p[2]);
    };
    std::ranges::nth_element(leaves, leaves.begin() + most, {}, apart);
    leaves.resize(most);
    return leaves;
  }

  /// If one plane does not determine the shape, at a tip or an edge: moves from the candidate into the primitives whose
  /// tip it may be.
  void improve_towards_centres(const Node& node) {
    for (const std::uint32_t i : leaves_about(node.candidate, node.tree, Side::inside)) {
      accept_farther(node, scene_.inwards(i, node.candidate, tolerance_ / 4));
    }
  }

  /// Where sides of meshes and other boundaries meet: moves from the candidate away from all of them at once.
  void improve_away_from_planes(const Node& node) {
    Proposal inwards{};
    for (const Side side : {Side::inside, Side::outside}) {
      for (const std::uint32_t i : leaves_about(node.candidate, node.tree, side)) {
        const Point n = scene_.primitives[i].half_space({node.candidate, tolerance_ / 4}, side).normal;
        const long double length = std::hypot(n[0], n[1], n[2]);
        if (!(length > 0.0)) continue;
        for (std::size_t k = 0; k < 3; ++k) inwards[k] -= n[k] / length;
      }
    }
    accept_farther(node, inwards);
  }

  void accept_farther(const Node& node, const Proposal& inwards) {
    if (!usable(inwards)) return;
    for (double far = std::min(tolerance_, node.cube.half_width) / 8; far < 4 * node.cube.half_width; far *= 2) {
      if (accept_proposal(moved(node.candidate, inwards, far), node)) break;
    }
  }

  /// About p, farther and farther along v.
  void accept_along(const Point& p, const Proposal& v) {
    if (!usable(v)) return;
    for (const double margin : {tolerance_ / 8, tolerance_ / 2, 8 * tolerance_}) {
      if (accept(moved(p, v, margin), target_)) return;
    }
  }

  // --- Bounds by the certificates of single primitives ---

  [[nodiscard]] std::vector<bool> leaves(Side side) const {
    std::vector<std::uint32_t> leaves;
    append_leaves(target_, side, leaves);
    std::vector<bool> marks(scene_.primitives.size(), false);
    for (const std::uint32_t i : leaves) marks[i] = true;
    return marks;
  }

  /// Primitives K that are subsets of T.
  [[nodiscard]] std::vector<bool> subsets() const {
    std::vector<bool> marks(scene_.primitives.size(), false);
    mark_subsets(target_, marks);
    return marks;
  }

  double& leaf_bound_of(std::size_t primitive, Side side) {
    return leaf_bounds_[static_cast<std::size_t>(side)][primitive];
  }

  [[nodiscard]] double bound_by_sphere(std::size_t primitive) const {
    if (const PosedMesh* const mesh = scene_.mesh(primitive))
      return std::max(0.0, mesh->signed_distance(x_).signed_distance.lo);
    const auto& convex = scene_.convex[primitive];
    return std::max(0.0, convex ? convex->proof().lower_by_sphere(x_) : scene_.bent[primitive]->lower_by_sphere(x_));
  }

  /// d(x, K) and a point beside K's nearest.
  [[nodiscard]] BentDistance::Nearest nearest_of(std::size_t primitive) const {
    if (const PosedMesh* const mesh = scene_.mesh(primitive)) {
      const ClosedMesh::Distance found = mesh->signed_distance(x_);
      return {found.signed_distance, found.closest};
    }
    if (!scene_.convex[primitive]) return (*scene_.bent[primitive])(x_);
    const ConvexPrimitive& convex = *scene_.convex[primitive];
    const PrimitiveDistance found = convex.signed_distance(x_, tolerance_ / 4);
    const Proposal out = convex.model_direction(usable(found.witness) ? found.witness : found.direction);
    const Point surface = usable(out) ? moved(x_, out, -static_cast<long double>(found.distance.hi)) : x_;
    return {found.distance, surface};
  }

  /// d(x, K) of primitives K that x is outside of.
  void bound_primitives(std::span<const Colour> at_x) {
    const std::vector<bool> wanted = leaves(Side::inside);
    const std::vector<bool> subset = subsets();
    const auto by_sphere = [&](std::size_t i) {
      return wanted[i] && at_x[i] == Colour::white ? bound_by_sphere(i) : -1.0;
    };
    for (const auto& [bound, i] : nearest_spheres_first(scene_.primitives.size(), by_sphere)) {
      if (bound < 0.0) continue;
      leaf_bound_of(i, Side::inside) = bound;
      if (bound > upper_) continue;
      const BentDistance::Nearest found = nearest_of(i);
      leaf_bound_of(i, Side::inside) = std::max(bound, found.distance.lo);
      // First, for the witness: tighter bounds than its own have none.
      if (proposals_left_ > 0) accept_along(found.point, scene_.inwards(i, found.point, tolerance_ / 4));
      if (proposals_left_ > 0) --proposals_left_;
      if (subset[i]) found_upper(found.distance.hi);  // d(x, T) <= d(x, K)
    }
  }

  /// The way out of K through the surface point that is nearest to x, and how far it is.
  struct WayOut {
    Enclosure depth;
    Proposal direction;
  };

  [[nodiscard]] std::optional<WayOut> way_out(std::size_t primitive) const {
    if (const PosedMesh* const mesh = scene_.mesh(primitive)) {
      const ClosedMesh::Distance found = mesh->signed_distance(x_);
      return WayOut{{-found.signed_distance.hi, -found.signed_distance.lo},
                    {found.normal[0], found.normal[1], found.normal[2]}};
    }
    if (!scene_.convex[primitive]) return std::nullopt;
    const ConvexPrimitive& convex = *scene_.convex[primitive];
    const PrimitiveDistance found = convex.signed_distance(x_, tolerance_ / 4);
    return WayOut{{-found.distance.hi, -found.distance.lo}, convex.model_direction(found.direction)};
  }

  /// d(x, closure of K's complement) of primitives K that x is in. A ball about x that is free of a mesh's triangles
  /// lies in its interior.
  void bound_complements(std::span<const Colour> at_x) {
    const std::vector<bool> wanted = leaves(Side::outside);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      if (!wanted[i] || at_x[i] != Colour::black) continue;
      const std::optional<WayOut> out = way_out(i);
      if (!out) continue;
      leaf_bound_of(i, Side::outside) = std::max(0.0, out->depth.lo);
      if (!usable(out->direction) || proposals_left_ == 0) continue;
      accept_along(moved(x_, out->direction, static_cast<long double>(out->depth.hi)), out->direction);
      --proposals_left_;
    }
  }

  const Scene& scene_;
  const SetNode& target_;
  Point x_;
  double resolution_;
  double tolerance_;
  Enclosure known_;
  double upper_;                   ///< known or found: a point of T is no farther
  double found_upper_ = infinity;  ///< found here
  TreeColours colours_;
  std::optional<Point> witness_;
  std::vector<std::uint32_t> both_sides_;  ///< primitives whose boundaries may be left of T
  double settled_ = infinity;              ///< proven of the cubes that are not divided further
  double dropped_ = infinity;              ///< proven of the cubes that are farther than `upper_`
  std::array<std::vector<double>, 2> leaf_bounds_;
  LeafBound leaf_bound_ = [this](const SetNode& leaf) { return leaf_bound_of(leaf.primitive, leaf.side); };
  std::priority_queue<Node, std::vector<Node>, LessPromising> open_;
  std::size_t proposals_left_ = 1 + kMostLooks / scene_.primitives.size();
  std::size_t examined_ = 0;
  std::size_t visited_ = 0;
  double finest_ = infinity;
  bool has_mesh_ = false;
};

/// Finite, where everything is proven to be empty.
double at_most_finite(double lower) {
  return std::min(lower, std::numeric_limits<double>::max());
}

}  // namespace

struct SolidDistance::State {
  Scene scene;
};

void require_tolerance(double tolerance) {
  if (!(tolerance >= 0.0)) throw Error(ErrorKind::input, fmt::format("tolerance = {}: must be at least 0", tolerance));
}

SolidDistance::SolidDistance(const Model& model) : state_(hidden<State>(State{Scene(model)})) {}

Enclosure SolidDistance::operator()(const Point& x, double tolerance, const Enclosure& known,
                                    const std::function<bool()>& interrupted) const {
  const Scene& scene = state_->scene;
  if (!scene.root || !is_finite(x)) return known;
  const std::vector<Colour> at_x = colours_at(scene, x);
  const Colour here = contains(*scene.root, x) ? verify::colour(scene.inside, at_x) : Colour::white;
  // If the sign is open, the distances to either side bound half of the enclosure each.
  const double share = here == Colour::gray ? tolerance / 2 : tolerance;
  Enclosure result{-infinity, infinity};
  if (here != Colour::black) {
    const Enclosure outside{here == Colour::white ? std::max(0.0, known.lo) : 0.0, std::max(0.0, known.hi)};
    const Enclosure found = Search(scene, Side::inside, x, at_x, share, outside).run(interrupted);
    result.hi = std::min(result.hi, found.hi);  // whatever the sign is
    if (here == Colour::white || found.lo > 0.0) result.lo = std::max(result.lo, at_most_finite(found.lo));
  }
  if (here != Colour::white) {
    const Enclosure inside{here == Colour::black ? std::max(0.0, -known.hi) : 0.0, std::max(0.0, -known.lo)};
    const Enclosure found = Search(scene, Side::outside, x, at_x, share, inside).run(interrupted);
    result.lo = std::max(result.lo, -found.hi);  // whatever the sign is
    if (here == Colour::black || found.lo > 0.0) result.hi = std::min(result.hi, -found.lo);
  }
  return intersection(known, result, [&] { return "the signed distance at " + text_of(x); });
}

std::optional<Point> SolidDistance::nearest(const Point& x, Side side, double tolerance,
                                            const std::function<bool()>& interrupted) const {
  const Scene& scene = state_->scene;
  if (!scene.root || !is_finite(x)) return std::nullopt;
  if (side == Side::outside && !contains(*scene.root, x)) return std::nullopt;
  Search search(scene, side, x, colours_at(scene, x), tolerance, {0.0, infinity});
  static_cast<void>(search.run(interrupted));
  return search.witness();
}

Colour SolidDistance::colour(const Point& x) const {
  return verify::colour(state_->scene.inside, colours_at(state_->scene, x));
}

}  // namespace verisq::verify
