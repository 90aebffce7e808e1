/// Distances of models to models with meshes.
#include <algorithm>
#include <cmath>
#include <utility>

#include "verify/numbers/functions.hpp"
#include "verify/numbers/interval.hpp"
#include "verify/numbers/points.hpp"
#include "verify/proof/closed_surface.hpp"
#include "verify/proof/triangle_tree.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verify/search/mesh_union.hpp"
#include "verify/search/rounded_motion.hpp"
#include "verify/solids/model.hpp"

namespace verisq::verify {

namespace {

MeshPair joined(const MeshPair& a, const MeshPair& b) {
  return {{std::min(a.distance.lo, b.distance.lo), std::min(a.distance.hi, b.distance.hi)},
          std::max(a.depth, b.depth),
          a.common ? a.common : b.common};
}

/// Where points lie about a solid.
struct Lie {
  bool all_outside = true;  ///< proven
  double deepest = -1.0;    ///< one lies at least so deep in it; below 0 where none is proven to lie in it
  std::size_t which = 0;    ///< the index of that one

  [[nodiscard]] bool meets() const { return deepest >= 0.0; }
};

/// Roundings move each point as far as `displacement`. Looks no further than the first inside unless all are asked for.
Lie lie_of(std::span<const Point> points, const ClosedMesh& solid, const RoundedMotion& motion, double displacement,
           bool all = false) {
  Lie lie;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Enclosure distance = solid.signed_distance(motion(points[i])).signed_distance;
    lie.all_outside = lie.all_outside && distance.lo > displacement;
    const double depth = (Interval(-distance.hi) - Interval(displacement)).lower();
    if (depth > lie.deepest) {
      lie.deepest = depth;
      lie.which = i;
    }
    if (lie.meets() && !all) break;
  }
  return lie;
}

/// A mesh of a model, with what pairs ask of it.
struct Solid {
  explicit Solid(const MeshUnion::Part& part, const Mesh& mesh)
      : placed(&part.mesh),
        motion(motion_of(part.mesh)),
        triangles(triangles_of(mesh)),
        on_parts(one_on_each_part(mesh)) {
    for (const Triangle& triangle : triangles) largest = std::max(largest, largest_coordinate(triangle));
  }

  const PosedMesh* placed;
  RigidMotion motion;  ///< to the model's frame
  std::vector<Triangle> triangles;
  std::vector<Point> on_parts;  ///< a vertex of each part of the surface, in the own frame
  double largest = 0.0;
};

/// One of the two models.
struct Operand {
  explicit Operand(const Model& model) {
    if (!has_mesh(model)) {
      require_union_of_convex(model, "distances to meshes");
      others = model;
    } else {
      meshes.emplace(model);
      others = meshes->others();
      for (const MeshUnion::Part& part : meshes->meshes())
        solids.emplace_back(part, *model.primitives[part.primitive].mesh);
    }
    if (!others) return;
    of_triangles.emplace(*others);
    of_points.emplace(*others);
  }

  std::optional<MeshUnion> meshes;
  std::vector<Solid> solids;
  std::optional<Model> others;
  std::optional<TriangleDistance> of_triangles;
  std::optional<SignedDistance> of_points;
};

/// Proposes a point of the solid's inside about below a point of its surface, no deeper than `most`, with which
/// `serves` agrees. In the own frame.
template <class Serves>
std::optional<Point> inner_point(const Solid& solid, std::size_t triangle, const Point& on_surface, double most,
                                 const Serves& serves) {
  const auto& [a, b, c] = solid.triangles[triangle];
  const Point normal = cross(difference(b, a), difference(c, a));
  const double norm = std::sqrt(dot(normal, normal));
  if (!(norm > 0.0 && norm < infinity)) return std::nullopt;
  for (double step = 0.5 * most; step > 0x1p-30 * most; step *= 0.25) {
    for (const double way : {-step / norm, step / norm}) {
      const Point x = along(on_surface, normal, way);
      if (solid.placed->mesh().signed_distance(x).signed_distance.hi < 0.0 && serves(x)) return x;
    }
  }
  return std::nullopt;
}

/// One pair of a mesh and a mesh. `to_b` takes the frame of the mesh of A to that of the mesh of B.
class MeshesApart {
 public:
  MeshesApart(const Solid& a, const Solid& b, const RigidMotion& to_b)
      : a_(a),
        b_(b),
        to_b_(to_b),
        to_a_(to_b.inverse()),
        a_to_model_(a.motion),
        b_to_model_(a.motion.after(to_b.inverse())) {}

  /// Two solids whose surfaces keep off each other meet only if one holds a part of the other's surface: their common
  /// part would have a boundary, in one surface and in the other solid.
  [[nodiscard]] MeshPair operator()(const std::function<bool()>& interrupted) const {
    if (!to_b_.is_ordinary(a_.largest) || !to_a_.is_ordinary(b_.largest)) return {{0.0, infinity}};
    const Lie of_a = lie_of(a_.on_parts, b_.placed->mesh(), to_b_, to_b_.displacement(a_.largest));
    const Lie of_b = lie_of(b_.on_parts, a_.placed->mesh(), to_a_, to_a_.displacement(b_.largest));
    if (of_a.meets() || of_b.meets()) return deepest_point(they_meet);
    const bool b_has_tree = b_.triangles.size() >= a_.triangles.size();
    Enclosure distance = b_has_tree ? of_surfaces(a_, b_, to_b_, interrupted) : of_surfaces(b_, a_, to_a_, interrupted);
    if (!of_a.all_outside || !of_b.all_outside) distance.lo = 0.0;
    if (distance.lo > 0.0) return {distance};
    // Roundings hide where they cross: a corner that lies deeper shows that they do.
    return deepest_point(distance);
  }

 private:
  /// A point of one surface that lies deep in the other solid stays there if that moves by less.
  [[nodiscard]] MeshPair deepest_point(const Enclosure& distance) const {
    const Lie of_a = lie_of(points_on(a_), b_.placed->mesh(), to_b_, off(a_, to_b_), true);
    const Lie of_b = lie_of(points_on(b_), a_.placed->mesh(), to_a_, off(b_, to_a_), true);
    if (!of_a.meets() && !of_b.meets()) return {distance};
    if (of_a.deepest > of_b.deepest) return {they_meet, of_a.deepest, common_point(a_, of_a, b_, to_b_, a_to_model_)};
    return {they_meet, of_b.deepest, common_point(b_, of_b, a_, to_a_, b_to_model_)};
  }

  /// Below the deepest point of one surface in the other solid.
  static std::optional<Point> common_point(const Solid& from, const Lie& lie, const Solid& to,
                                           const RoundedMotion& motion, const RoundedMotion& to_model) {
    const std::size_t triangle = lie.which / 2;  // two points of each
    const Point deepest = points_on(from)[lie.which];
    const Point middle = ball_about(from.triangles[triangle]).centre;
    for (const double share : {0.0, 0.0625}) {
      const Point on_surface = along(deepest, difference(middle, deepest), share);
      const auto serves = [&](const Point& x) {
        return to.placed->mesh().signed_distance(motion(x)).signed_distance.hi < 0.0;
      };
      if (const auto x = inner_point(from, triangle, on_surface, lie.deepest, serves)) return to_model(*x);
    }
    return std::nullopt;
  }

  /// How far points of the solid may be from their exact places in the other frame.
  static double off(const Solid& solid, const RoundedMotion& motion) {
    return (Interval(motion.displacement(solid.largest)) + Interval(rounding_of_middle(solid.largest))).upper();
  }

  /// A corner of each triangle, and its middle: where solids are aligned, corners may touch, and not lie deeper.
  static std::vector<Point> points_on(const Solid& solid) {
    std::vector<Point> points;
    for (const Triangle& triangle : solid.triangles) {
      points.push_back(triangle[0]);
      points.push_back(ball_about(triangle).centre);
    }
    return points;
  }

  static Enclosure of_surfaces(const Solid& from, const Solid& to, const RoundedMotion& motion,
                               const std::function<bool()>& interrupted) {
    return widened_by(distance_of_triangles(motion(from.triangles), to.placed->mesh().tree(), interrupted),
                      motion.displacement(from.largest));
  }

  const Solid& a_;
  const Solid& b_;
  RoundedMotion to_b_;
  RoundedMotion to_a_;
  RoundedMotion a_to_model_;  ///< to A's frame, as the next
  RoundedMotion b_to_model_;
};

/// One pair of a mesh and superquadrics, in whose model's frame the mesh stands by `motion`.
class MeshAndSuperquadrics {
 public:
  MeshAndSuperquadrics(const Solid& solid, const Operand& superquadrics, const RigidMotion& motion)
      : solid_(solid), superquadrics_(superquadrics), motion_(motion), back_(motion.inverse()) {}

  /// A convex primitive that keeps off the surface lies on one side of it, as its centre does.
  [[nodiscard]] MeshPair operator()(const std::function<bool()>& interrupted) const {
    if (!motion_.is_ordinary(solid_.largest) || !back_.is_ordinary(largest_coordinate(centres())))
      return {{0.0, infinity}};
    const Lie of_centres = lie_of(centres(), solid_.placed->mesh(), back_, displacement_of_centres(), true);
    if (of_centres.meets()) return {they_meet, of_centres.deepest, centres()[of_centres.which]};
    const std::vector<Triangle> triangles = motion_(solid_.triangles);
    const double displacement = motion_.displacement(solid_.largest);
    std::vector<std::pair<double, std::size_t>> order;  // by a lower end
    double depth = -1.0;                                // of a middle in a superquadric
    std::size_t deepest = 0;
    for (std::size_t n = 0; n < triangles.size(); ++n) {
      const BallAboutTriangle ball = ball_about(triangles[n]);
      const Enclosure at_centre = (*superquadrics_.of_points)(ball.centre, infinity);
      const Interval off = Interval(displacement) + Interval(rounding_of_middle(largest_coordinate(triangles[n])));
      if (const double here = (Interval(-at_centre.hi) - off).lower(); here > depth) {
        depth = here;
        deepest = n;
      }
      order.emplace_back((Interval(at_centre.lo) - Interval(ball.radius)).lower(), n);
    }
    if (depth >= 0.0) return {they_meet, depth, common_point(deepest, depth)};
    std::ranges::sort(order);
    Enclosure found{infinity, infinity};
    for (const auto& [lower, n] : order) {
      if (!(lower < found.hi)) break;
      if (interrupted && interrupted()) return {{0.0, found.hi}};
      found = least_of(found, (*superquadrics_.of_triangles)(triangles[n]));
      if (found.hi == 0.0) break;
    }
    found = widened_by(found, displacement);
    if (!of_centres.all_outside) found.lo = 0.0;
    return {found};
  }

 private:
  [[nodiscard]] std::vector<Point> centres() const {
    std::vector<Point> points;
    for (const Primitive& primitive : superquadrics_.others->primitives) points.push_back(primitive.pose.translation);
    return points;
  }

  /// Below the middle of a triangle, in the frame of the superquadrics.
  [[nodiscard]] std::optional<Point> common_point(std::size_t triangle, double depth) const {
    const Point middle = ball_about(solid_.triangles[triangle]).centre;
    const auto serves = [&](const Point& x) { return (*superquadrics_.of_points)(motion_(x), infinity).hi < 0.0; };
    const auto found = inner_point(solid_, triangle, middle, depth, serves);
    return found ? std::optional(motion_(*found)) : std::nullopt;
  }

  [[nodiscard]] double displacement_of_centres() const { return back_.displacement(largest_coordinate(centres())); }

  const Solid& solid_;
  const Operand& superquadrics_;
  RoundedMotion motion_;
  RoundedMotion back_;
};

/// Returns whether every point so near to x is proven to lie in the model, in whose frame x is.
bool lies_in(const Operand& model, const Point& x, double displacement) {
  const auto is_deep = [&](double upper) { return (Interval(upper) + Interval(displacement)).upper() <= 0.0; };
  const auto holds = [&](const Solid& solid) { return is_deep(solid.placed->signed_distance(x).signed_distance.hi); };
  return std::ranges::any_of(model.solids, holds) || (model.of_points && is_deep((*model.of_points)(x, infinity).hi));
}

Proximity proximity_of(const Enclosure& distance) {
  if (distance.lo > 0.0) return Proximity::separated;
  return distance.hi == 0.0 ? Proximity::overlapping : Proximity::undecided;
}

}  // namespace

struct MeshPairDistance::State {
  State(const Model& first, const Model& second) : a(first), b(second) {
    if (a.others && b.others) between_others.emplace(*a.others, *b.others);
  }

  Operand a;
  Operand b;
  std::optional<ModelSearch> between_others;
};

MeshPairDistance::MeshPairDistance(const Model& a, const Model& b) : state_(hidden<State>(a, b)) {}

MeshPair MeshPairDistance::operator()(const Pose& pose, const std::function<bool()>& interrupted) const {
  const State& s = *state_;
  const RigidMotion b_to_a(pose);
  const RigidMotion a_to_b = b_to_a.inverse();
  MeshPair found{{infinity, infinity}};
  const auto join = [&](const auto& pair) {
    if (found.distance.hi != 0.0) found = joined(found, pair(interrupted));
  };
  for (const Solid& a : s.a.solids) {
    for (const Solid& b : s.b.solids) join(MeshesApart(a, b, b.motion.inverse().after(a_to_b.after(a.motion))));
    if (!s.b.others) continue;
    join([&](const std::function<bool()>& ended) {
      MeshPair pair = MeshAndSuperquadrics(a, s.b, a_to_b.after(a.motion))(ended);
      if (pair.common) pair.common = RoundedMotion(b_to_a)(*pair.common);
      return pair;
    });
  }
  if (s.a.others) {
    for (const Solid& b : s.b.solids) join(MeshAndSuperquadrics(b, s.a, b_to_a.after(b.motion)));
  }
  if (s.between_others) {
    join([&](const std::function<bool()>& ended) {
      const SearchedDistance others = (*s.between_others)(pose, {.tolerance = 0.0, .interrupted = ended});
      return MeshPair{others.distance, 0.0, others.common};
    });
  }
  return found;
}

SearchedDistance MeshPairDistance::searched(const Pose& pose, const SearchOptions& options) const {
  auto [distance, depth, common] = (*this)(pose, options.interrupted);
  if (common) {
    const RoundedMotion a_to_b(RigidMotion(pose).inverse());
    const double displacement = a_to_b.displacement(largest_coordinate(*common));
    if (!lies_in(state_->a, *common, 0.0) || !lies_in(state_->b, a_to_b(*common), displacement)) common.reset();
  }
  const double tightest = 0x1p-40 * (1.0 + distance.hi);
  const bool reached = distance.width() <= std::max(options.tolerance, tightest);
  return {distance, proximity_of(distance), std::nullopt, common, 0, reached};
}

}  // namespace verisq::verify
