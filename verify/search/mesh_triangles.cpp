/// Distances of triangles to triangles, and to models with meshes.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "verify/numbers/functions.hpp"
#include "verify/numbers/interval.hpp"
#include "verify/numbers/points.hpp"
#include "verify/proof/closed_surface.hpp"
#include "verify/proof/triangle_tree.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verify/search/mesh_union.hpp"
#include "verify/search/rounded_motion.hpp"
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
  std::vector<BallAboutTriangle> balls_;
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

MeshTriangleDistance::MeshTriangleDistance(const Model& model) : model_(model), solids_(model) {
  if (solids_.others()) to_others_.emplace(*solids_.others());
}

/// A triangle that keeps off the surface lies on one side of it: a corner proven to be outside says on which.
Enclosure MeshTriangleDistance::to_meshes(const Triangle& triangle) const {
  Enclosure distance{infinity, infinity};
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

Enclosure MeshTriangleDistance::operator()(const Triangle& triangle) const {
  const Enclosure distance = to_meshes(triangle);
  return to_others_ ? least_of(distance, (*to_others_)(triangle)) : distance;
}

CertifiedEnclosure MeshTriangleDistance::certified(const Triangle& triangle) const {
  CertifiedEnclosure found{to_meshes(triangle), {}};
  if (to_others_) {
    const CertifiedEnclosure of_others = to_others_->certified(triangle);
    found.distance = least_of(found.distance, of_others.distance);
    found.certificate = of_others.certificate;
    found.certificate.normals = solids_.renumbered(of_others.certificate.normals);
  }
  std::call_once(is_checker_made_, [&] { checker_.emplace(model_); });
  found.distance = (*checker_)(triangle, found.distance, found.certificate);
  return found;
}

}  // namespace verisq::verify
