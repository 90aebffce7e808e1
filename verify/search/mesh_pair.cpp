/// This file implements mesh_pair.hpp.
#include "verify/search/mesh_pair.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "verify/numbers/functions.hpp"
#include "verify/numbers/interval.hpp"
#include "verify/numbers/points.hpp"
#include "verify/proof/closed_surface.hpp"
#include "verify/proof/triangle_tree.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verify/search/triangle_geometry.hpp"
#include "verify/solids/model.hpp"

namespace verisq::verify {

namespace {

/// Two triangles about the first corner of one. Differences of binary64 numbers round by u = 2^-53, relatively.
struct SeenPair {
  std::array<Point, 3> a;
  std::array<Point, 3> b;
  double magnitude = 0.0;  ///< M: no corner's sum of magnitudes is larger, but for rounding

  SeenPair(const Triangle& first, const Triangle& second) {
    for (std::size_t k = 0; k < 3; ++k) {
      a[k] = difference(first[k], first[0]);
      b[k] = difference(second[k], first[0]);
      for (const Point& corner : {a[k], b[k]})
        magnitude = std::max(magnitude, std::abs(corner[0]) + std::abs(corner[1]) + std::abs(corner[2]));
    }
  }
};

/// Squares below it may underflow: no vector so short is a normal.
constexpr double least_square = 0x1p-900;
/// More than what underflows anywhere in these sums may hide, whose roots are below 2^-530.
constexpr double underflow_of_length = 0x1p-500;

/// For any n, a lies in {n·x >= least} and b in {n·x <= most}: they are at least (least - most)/|n| apart. A product
/// n·x of a rounded difference is off by 4.1 u |n| M, two of them by 8.2 u |n| M; their difference, the root and the
/// quotient round by 5 u of the result. The factor takes off 8 u, the last term 16 u M.
double lower_by(const SeenPair& pair, const Point& n) {
  const double square = dot(n, n);
  if (!(square >= least_square)) return 0.0;
  const double least = std::min({dot(n, pair.a[0]), dot(n, pair.a[1]), dot(n, pair.a[2])});
  const double most = std::max({dot(n, pair.b[0]), dot(n, pair.b[1]), dot(n, pair.b[2])});
  const double lower =
      (least - most) / std::sqrt(square) * (1.0 - 0x1p-50) - 0x1p-49 * pair.magnitude - underflow_of_length;
  return lower > 0.0 && lower < infinity ? lower : 0.0;
}

double between_0_and_1(double share) {
  return share > 0.0 ? std::min(share, 1.0) : 0.0;  // 0 for NaN
}

/// From a point of the side of b to one of the side of a, about as near as they get.
/// Ericson, Real-Time Collision Detection (2005), 5.1.9.
Point way_between_sides(const Point& from_a, const Point& to_a, const Point& from_b, const Point& to_b) {
  const Point along_a = difference(to_a, from_a);
  const Point along_b = difference(to_b, from_b);
  const Point apart = difference(from_a, from_b);
  const double a = dot(along_a, along_a);
  const double e = dot(along_b, along_b);
  const double b = dot(along_a, along_b);
  const double c = dot(along_a, apart);
  const double f = dot(along_b, apart);
  double s = between_0_and_1((b * f - c * e) / (a * e - b * b));
  const double t = between_0_and_1((b * s + f) / e);
  s = between_0_and_1((b * t - c) / a);
  Point way;
  for (std::size_t i = 0; i < 3; ++i) way[i] = (from_a[i] + s * along_a[i]) - (from_b[i] + t * along_b[i]);
  return way;
}

/// The ends of the way lie on the sides, off by at most: each corner 1 u M, each difference of corners 2 u M + 2 u M,
/// its product 2 u M, each sum 3 u M, and the way 6 u M: less than 32 u M in length. The length rounds by 3 u.
double length_up(const Point& way, double magnitude) {
  const double length = std::sqrt(dot(way, way)) * (1.0 + 0x1p-50) + 0x1p-48 * magnitude + underflow_of_length;
  return length >= 0.0 ? length : infinity;
}

/// The bounds so far, and the way that is proposed as the normal.
struct BestWay {
  Enclosure distance{0.0, infinity};
  Point way{};
};

/// A pair of closest points lies in a corner of one and the other triangle, or in a side of each, unless they cross.
BestWay by_features(const SeenPair& seen, const Triangle& a, const Triangle& b) {
  BestWay best;
  const auto offer = [&](double upper, const Point& way) {
    if (upper < best.distance.hi) best = {{0.0, upper}, way};
  };
  for (std::size_t k = 0; k < 3; ++k) {
    const DistanceBounds of_a = distance_bounds(a[k], b);
    offer(of_a.upper, {-of_a.way[0], -of_a.way[1], -of_a.way[2]});
    const DistanceBounds of_b = distance_bounds(b[k], a);
    offer(of_b.upper, of_b.way);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const Point way = way_between_sides(seen.a[i], seen.a[(i + 1) % 3], seen.b[j], seen.b[(j + 1) % 3]);
      offer(length_up(way, seen.magnitude), way);
    }
  }
  return best;
}

/// Normals of both faces, and of both sides of each pair.
double lower_by_normals(const SeenPair& seen, double lower) {
  const auto offer = [&](const Point& n) {
    lower = std::max({lower, lower_by(seen, n), lower_by(seen, {-n[0], -n[1], -n[2]})});
  };
  std::array<Point, 3> sides_a;
  std::array<Point, 3> sides_b;
  for (std::size_t k = 0; k < 3; ++k) {
    sides_a[k] = difference(seen.a[(k + 1) % 3], seen.a[k]);
    sides_b[k] = difference(seen.b[(k + 1) % 3], seen.b[k]);
  }
  offer(cross(sides_a[0], sides_a[1]));
  offer(cross(sides_b[0], sides_b[1]));
  for (const Point& a : sides_a)
    for (const Point& b : sides_b) offer(cross(a, b));
  return lower;
}

/// True proves that the segment passes through the triangle: its ends lie on both sides of the plane, and the line
/// leaves the three sides on one hand, or meets them.
bool passes_through(const Point& from, const Point& to, const Triangle& triangle) {
  if (orientation(triangle, from) * orientation(triangle, to) >= 0) return false;
  int least = 1;
  int most = -1;
  for (std::size_t k = 0; k < 3; ++k) {
    const int side = orientation({from, to, triangle[k]}, triangle[(k + 1) % 3]);
    least = std::min(least, side);
    most = std::max(most, side);
  }
  return least * most >= 0;
}

bool cross_each_other(const Triangle& a, const Triangle& b) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (passes_through(a[k], a[(k + 1) % 3], b) || passes_through(b[k], b[(k + 1) % 3], a)) return true;
  }
  return false;
}

/// Below it a gap is worth more normals.
constexpr double tight = 0x1p-44;

}  // namespace

Enclosure distance_of_triangles(const Triangle& a, const Triangle& b) {
  const SeenPair seen(a, b);
  const BestWay best = by_features(seen, a, b);
  Enclosure distance = best.distance;
  distance.lo = lower_by(seen, best.way);
  if (distance.width() <= tight * (distance.hi + seen.magnitude)) return distance;
  distance.lo = lower_by_normals(seen, distance.lo);
  if (!(distance.lo > 0.0) && cross_each_other(a, b)) return {0.0, 0.0};
  return distance;
}

namespace {

/// A ball about a point that holds a triangle.
struct Ball {
  Point centre;
  double radius;  ///< rounded up
};

Ball ball_about(const Triangle& triangle) {
  Ball ball{{}, 0.0};
  for (const Point& corner : triangle)
    for (std::size_t i = 0; i < 3; ++i) ball.centre[i] += corner[i] / 3.0;
  for (const Point& corner : triangle) {
    const Point way = difference(corner, ball.centre);
    ball.radius = std::max(ball.radius, length(way[0], way[1], way[2]) * (1.0 + 0x1p-48) + 0x1p-1000);
  }
  return ball;
}

/// Bounds how far the centre of a ball about a triangle with no larger coordinate is from its middle: three quotients
/// and two sums round a coordinate by less than 4 u of it.
double rounding_of_middle(double largest) {
  return 0x1p-50 * largest;
}

/// Searches the pairs of near triangles; all others are farther than the upper end.
class NearestTriangles {
 public:
  NearestTriangles(std::span<const Triangle> triangles, const WideTree& tree) : triangles_(triangles), tree_(tree) {}

  Enclosure operator()(const std::function<bool()>& interrupted) {
    bound_by_balls();
    std::vector<std::size_t> order(triangles_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, {}, [&](std::size_t n) { return lower_[n]; });
    for (const std::size_t n : order) {
      // This one and all that follow are at least so far; as far as the upper end is enough.
      if (!(lower_[n] < found_.hi)) break;
      if (interrupted && interrupted()) return {0.0, found_.hi};
      search(n);
      if (found_.hi == 0.0) return {0.0, 0.0};
    }
    return {std::min(least_, found_.hi), found_.hi};
  }

 private:
  /// The nearest triangle to each centre gives a first upper end, too.
  void bound_by_balls() {
    std::optional<std::uint32_t> hint;
    for (const Triangle& triangle : triangles_) {
      balls_.push_back(ball_about(triangle));
      const WideTree::Nearest nearest = tree_.nearest(balls_.back().centre, hint);
      hint = nearest.triangle;
      lower_.push_back(std::max(0.0, (Interval(nearest.distance.lo) - Interval(balls_.back().radius)).lower()));
      found_.hi = std::min(found_.hi, (Interval(nearest.distance.hi) + Interval(balls_.back().radius)).upper());
    }
  }

  void search(std::size_t n) {
    near_.clear();
    tree_.within(balls_[n].centre, (Interval(found_.hi) + Interval(balls_[n].radius)).upper(), near_);
    for (const std::uint32_t other : near_) {
      const Enclosure distance = distance_of_triangles(triangles_[n], tree_.triangle(other));
      least_ = std::min(least_, distance.lo);
      found_.hi = std::min(found_.hi, distance.hi);
      if (found_.hi == 0.0) return;
    }
  }

  std::span<const Triangle> triangles_;
  const WideTree& tree_;
  std::vector<Ball> balls_;
  std::vector<double> lower_;  ///< of the distance of each triangle
  std::vector<std::uint32_t> near_;
  double least_ = infinity;  ///< of the lower ends of all pairs that were looked at
  Enclosure found_{0.0, infinity};
};

}  // namespace

Enclosure distance_of_triangles(std::span<const Triangle> triangles, const WideTree& tree,
                                const std::function<bool()>& interrupted) {
  return NearestTriangles(triangles, tree)(interrupted);
}

namespace {

/// A rigid motion in binary64.
class RoundedMotion {
 public:
  explicit RoundedMotion(const RigidMotion& motion) {
    for (std::size_t i = 0; i < 3; ++i) {
      translation_[i] = motion.translation[i].lower().to_double(Direction::down);
      for (std::size_t j = 0; j < 3; ++j) rows_[i][j] = in_binary64(motion.rotation(i, j)).lower();
    }
    is_exact_ = is_identity(motion);
  }

  [[nodiscard]] Point operator()(const Point& x) const {
    if (is_exact_) return x;
    Point moved;
    for (std::size_t i = 0; i < 3; ++i)
      moved[i] = rows_[i][0] * x[0] + rows_[i][1] * x[1] + rows_[i][2] * x[2] + translation_[i];
    return moved;
  }

  [[nodiscard]] std::vector<Triangle> operator()(std::span<const Triangle> triangles) const {
    std::vector<Triangle> moved(triangles.begin(), triangles.end());
    for (Triangle& triangle : moved)
      for (Point& corner : triangle) corner = (*this)(corner);
    return moved;
  }

  /// Points whose coordinates are at most so large stay where differences are below 2^300: distances need that.
  [[nodiscard]] bool is_ordinary(double largest) const {
    return largest < 0x1p299 && (is_exact_ || displacement(largest) < 0x1p250);
  }

  /// No point whose coordinates are at most so large is moved farther from its exact place. Elements of the rotation
  /// are off by 2 u, the translation by 2 u of itself; products and three sums round by 4 u: a coordinate is off by
  /// less than 7 u (Σ|x| + |t|), the point by less than 13 u (3 largest + Σ|t|).
  [[nodiscard]] double displacement(double largest) const {
    if (is_exact_) return 0.0;
    const double sum = std::abs(translation_[0]) + std::abs(translation_[1]) + std::abs(translation_[2]);
    return 0x1p-49 * (3.0 * largest + sum) + 0x1p-1000;
  }

 private:
  static bool is_identity(const RigidMotion& motion) {
    const auto is = [](const PreciseInterval& x, int value) {
      return x.lower() == Real(value) && x.upper() == Real(value);
    };
    bool same = true;
    for (std::size_t i = 0; i < 3; ++i) {
      same = same && is(motion.translation[i], 0);
      for (std::size_t j = 0; j < 3; ++j) same = same && is(motion.rotation(i, j), i == j ? 1 : 0);
    }
    return same;
  }

  std::array<Point, 3> rows_;
  Point translation_;
  bool is_exact_ = false;
};

RigidMotion motion_of(const PosedMesh& mesh) {
  return mesh.motion() ? *mesh.motion() : RigidMotion(Pose{});
}

Enclosure widened_by(const Enclosure& distance, double displacement) {
  if (displacement == 0.0) return distance;
  const Interval widened = Interval(distance.lo, distance.hi) + Interval(-displacement, displacement);
  return {std::max(0.0, widened.lower()), widened.upper()};
}

constexpr Enclosure they_meet{0.0, 0.0};

MeshPair least_of(const MeshPair& a, const MeshPair& b) {
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

Enclosure least_of(const Enclosure& a, const Enclosure& b) {
  return {std::min(a.lo, b.lo), std::min(a.hi, b.hi)};
}

}  // namespace

MeshTriangleDistance::MeshTriangleDistance(const Model& model) : solids_(model) {
  if (solids_.others()) to_others_.emplace(*solids_.others());
}

/// A triangle that keeps off the surface lies on one side of it: a corner proven to be outside says on which.
Enclosure MeshTriangleDistance::operator()(const Triangle& triangle) const {
  Enclosure distance = to_others_ ? (*to_others_)(triangle) : Enclosure{infinity, infinity};
  for (const MeshUnion::Part& part : solids_.meshes()) {
    bool is_outside = false;
    for (const Point& corner : triangle) {
      const Enclosure at_corner = part.mesh.signed_distance(corner).signed_distance;
      if (at_corner.hi <= 0.0) return they_meet;
      is_outside = is_outside || at_corner.lo > 0.0;
    }
    const RoundedMotion motion(motion_of(part.mesh).inverse());
    if (!motion.is_ordinary(largest_coordinate(triangle))) return {0.0, infinity};
    const std::vector<Triangle> own = motion(std::span(&triangle, 1));
    Enclosure to_surface = widened_by(distance_of_triangles(own, part.mesh.mesh().tree(), {}),
                                      motion.displacement(largest_coordinate(triangle)));
    if (!is_outside) to_surface.lo = 0.0;
    distance = least_of(distance, to_surface);
  }
  return distance;
}

namespace {

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
      const Ball ball = ball_about(triangles[n]);
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
    if (found.distance.hi != 0.0) found = least_of(found, pair(interrupted));
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
