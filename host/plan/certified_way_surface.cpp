/// Certificates of distances along a way that hold between vertices too, and half-spaces that hold prisms.
#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>
#include <vector>
#include <verisq/distance.hpp>

#include "host/threads/parallel.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/proof/posed_superquadric.hpp"
#include "verify/proof/triangle_piece.hpp"
#include "verify/proof/way_checker.hpp"
#include "verify/proposals/gjk.hpp"
#include "verify/proposals/support_mapping.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/insertion.hpp"
#include "verisq/model.hpp"

namespace verisq {

/// Immutable: safe to call from many threads.
class PrismEscape {
 public:
  /// Precondition: is_union_of_convex(implant).
  explicit PrismEscape(const Model& implant);

  /// The directions in which points of the prism leave the implant soonest, those of the deepest points first; of
  /// length 1. None if the prism seems to be clear.
  [[nodiscard]] std::vector<Point> ways_out(const verify::WayPrism& prism) const;

  /// A moved cell that may prove that the moved prism is clear of all solids; nothing if it does not seem to be.
  /// `closely`: by a margin that is about the whole clearance.
  [[nodiscard]] std::optional<MovedCell> moved(const verify::WayPrism& prism, const Point& step, bool closely) const;

 private:
  struct Solid {
    verify::ApproximateMotion<double> motion;
    verify::SuperquadricSet<double> set;
    verify::NearestNormal nearest;
    double radius;  ///< about the origin of its own frame
  };

  std::vector<Solid> solids_;
};

namespace {

using verify::MovedPrism;
using verify::WayPrism;

constexpr std::size_t times_of_samples = 5;
constexpr std::size_t most_directions_out = 6;
/// Ways out that differ by less are one.
constexpr double same_direction = 1.0 - 1e-4;

constexpr verify::GjkTolerance<double> apart_at_all{.relative = 0.75, .absolute = 0.0, .most_steps = 60};
constexpr verify::GjkTolerance<double> apart_closely{.relative = 1e-5, .absolute = 0.0, .most_steps = 100};

/// Six points.
struct PrismSet {
  std::array<Point, 6> corners;

  Point operator()(const Point& v) const {
    return *std::ranges::max_element(corners, {}, [&](const Point& corner) { return verify::dot(v, corner); });
  }
};

PrismSet set_of(const MovedPrism& prism, const verify::ApproximateMotion<double>& motion) {
  PrismSet set{};
  for (std::size_t i = 0; i < 3; ++i) {
    set.corners[i] = motion.inverse_point(prism.begin[i]);
    set.corners[3 + i] = motion.inverse_point(prism.end[i]);
  }
  return set;
}

/// Corners and centroid, at some times.
std::vector<Point> samples_of(const MovedPrism& prism) {
  std::vector<Point> samples;
  for (std::size_t k = 0; k < times_of_samples; ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(times_of_samples - 1);
    Point centroid{};
    for (std::size_t i = 0; i < 3; ++i) {
      const Point x = verify::along(prism.begin[i], verify::difference(prism.end[i], prism.begin[i]), share);
      samples.push_back(x);
      centroid = verify::along(centroid, x, 1.0 / 3.0);
    }
    samples.push_back(centroid);
  }
  return samples;
}

/// Rounded to few decimals: the loss is small, and the text is short.
Point short_normal(const Point& v) {
  constexpr double digits = 1e6;
  const double size = std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])});
  Point result{};
  for (std::size_t i = 0; i < 3; ++i) result[i] = std::round(v[i] / size * digits) / digits;
  return result;
}

struct WayOut {
  Point direction;
  double depth;
};

}  // namespace

PrismEscape::PrismEscape(const Model& implant) {
  for (const Primitive& primitive : implant.primitives) {
    const verify::PosedSuperquadric posed(primitive);
    solids_.push_back({verify::ApproximateMotion<double>::of_own_frame(primitive),
                       verify::SuperquadricSet<double>(primitive.superquadric),
                       verify::NearestNormal(primitive.superquadric),
                       posed.radius().upper().to_double(verify::Direction::up)});
  }
}

std::vector<Point> PrismEscape::ways_out(const WayPrism& prism) const {
  std::vector<WayOut> ways;
  for (const Point& x : samples_of(verify::moved(prism, {}))) {
    WayOut deepest{{}, 0.0};
    for (const Solid& solid : solids_) {
      const Point own = solid.motion.inverse_point(x);
      if (!(std::sqrt(verify::dot(own, own)) < solid.radius)) continue;
      const auto [normal, distance] = solid.nearest(own);
      if (distance < -deepest.depth) deepest = {solid.motion.direction(normal), -distance};
    }
    if (deepest.depth > 0.0) ways.push_back(deepest);
  }
  std::ranges::sort(ways, std::ranges::greater{}, &WayOut::depth);
  std::vector<Point> directions;
  for (const WayOut& way : ways) {
    const auto is_same = [&](const Point& other) { return verify::dot(other, way.direction) > same_direction; };
    if (std::ranges::any_of(directions, is_same)) continue;
    directions.push_back(way.direction);
    if (directions.size() == most_directions_out) break;
  }
  return directions;
}

std::optional<MovedCell> PrismEscape::moved(const WayPrism& prism, const Point& step, bool closely) const {
  const MovedPrism hull = verify::moved(prism, step);
  MovedCell cell{step, {}};
  for (std::uint32_t k = 0; k < solids_.size(); ++k) {
    const Solid& solid = solids_[k];
    const PrismSet set = set_of(hull, solid.motion);
    Point middle{};
    for (const Point& corner : set.corners) middle = verify::along(middle, corner, 1.0 / 6.0);
    const auto gap = [&](const Point& v) {
      return verify::dot(v, set({-v[0], -v[1], -v[2]})) - verify::dot(v, solid.set(v));
    };
    if (!closely && gap(middle) > 0.0) continue;  // the checker tries that for itself
    const auto found = verify::gjk<double>(solid.set, set, middle, closely ? apart_closely : apart_at_all);
    if (!(found.lower > 0.0)) return std::nullopt;
    const Point shortened = short_normal(found.separation);
    cell.normals.push_back({k, gap(shortened) > 0.0 ? shortened : found.separation});
  }
  return cell;
}

namespace {

using verify::PiecesOnWay;
using verify::WayPiece;
using verify::WayPrism;

/// Limits of the cells for one triangle, and about for all divided triangles. At the limit, open cells are bounded
/// without further division.
constexpr std::size_t most_cells_of_triangle = 6000;
constexpr std::size_t most_cells_of_all = std::size_t{1} << 18U;
constexpr std::size_t least_cells_of_triangle = 16;
/// Shares of the tolerance for the deviation of ways from the straight ones, and for the deepest point.
constexpr double share_of_bulge = 0.25;
constexpr double share_of_witness = 0.05;
/// Steps are rounded to so many decimals of the power of ten above their length.
constexpr double decimals_of_step = 6.0;
/// The number of triangles between two reports of progress.
constexpr std::size_t triangles_at_a_time = 64;

/// A vector along `direction` as long as `length`, or a little shorter, with few decimals.
Point step_along(const Point& direction, double length) {
  const double digits = std::pow(10.0, decimals_of_step - std::ceil(std::log10(length)));
  const double shortened = length - 2.0 / digits;
  Point step{};
  for (std::size_t i = 0; i < 3; ++i) step[i] = std::round(direction[i] * shortened * digits) / digits;
  return step;
}

/// One cell of a triangle's division.
struct Cell {
  WayPiece piece;
  WayCell letter = WayCell::by_vertices;
  MovedCell moved = {};
  double lower = -infinity;
  std::size_t first_part = 0;  ///< index of the first part, if the cell is divided
  Point hint = {};             ///< the way out of the cell that it is a part of; zero without
};

class TriangleDivision {
 public:
  struct Terms {
    const verify::RigidPath& path;
    std::span<const verify::PosedSuperquadric> solids;
    const PrismEscape& escape;
    double goal;
    double tolerance;
    std::size_t most_cells;  ///< for each triangle
  };

  TriangleDivision(const Terms& terms, const Triangle& whole, const std::array<double, 3>& at_vertices)
      : terms_(terms), at_vertices_(at_vertices), pieces_(terms.path, whole) {
    cells_.push_back({pieces_.whole()});
  }

  /// Cell by cell, the larger ones first.
  [[nodiscard]] WayTriangle operator()(std::uint32_t triangle) {
    for (std::size_t n = 0; n < cells_.size(); ++n) settle_or_divide(n);
    WayTriangle proof{triangle, {}, {}};
    append(0, proof);
    return proof;
  }

 private:
  void settle_or_divide(std::size_t n) {
    Cell& cell = cells_[n];
    cell.lower = pieces_.least_on(cell.piece, at_vertices_);
    if (cell.lower >= terms_.goal) return;
    const WayPrism prism = pieces_.prism_of(cell.piece);
    const double bulge = std::max({prism.corners[0].bulge, prism.corners[1].bulge, prism.corners[2].bulge});
    const bool bends = bulge > share_of_bulge * terms_.tolerance;
    const std::vector<Point> ways = bends && may_halve(cell.piece) ? std::vector<Point>() : ways_out(cell, prism);
    if (!(bends && may_halve(cell.piece)) && reaches_goal(cell, prism, ways)) return;
    const bool full = cells_.size() + 4 > terms_.most_cells;
    if (full || !divide(n, bends, ways.empty() ? cell.hint : ways.front())) bound_as_it_is(cells_[n], prism, ways);
  }

  [[nodiscard]] std::vector<Point> ways_out(const Cell& cell, const WayPrism& prism) const {
    std::vector<Point> ways = terms_.escape.ways_out(prism);
    if (cell.hint != Point{}) ways.push_back(cell.hint);
    return ways;
  }

  /// The length by which the prism may be moved.
  [[nodiscard]] double room(const WayPrism& prism) const {
    const double offset = verify::offset_of(prism, verify::moved(prism, {}));
    return (-terms_.goal - offset) * (1.0 - 0x1p-40);
  }

  [[nodiscard]] bool reaches_goal(Cell& cell, const WayPrism& prism, const std::vector<Point>& ways) const {
    const double length = room(prism);
    if (ways.empty() || !(length > 0.0)) return is_proven(cell, prism, {}, !(length > 0.0));
    return std::ranges::any_of(
        ways, [&](const Point& way) { return is_proven(cell, prism, step_along(way, length), false); });
  }

  /// Keeps the step that proves the best bound of the cell.
  [[nodiscard]] bool is_proven(Cell& cell, const WayPrism& prism, const Point& step, bool closely) const {
    std::optional<MovedCell> moved = terms_.escape.moved(prism, step, closely);
    if (!moved) return false;
    const double lower = verify::lower_end(terms_.solids, prism, *moved);
    if (lower > cell.lower) {
      cell.lower = lower;
      cell.letter = WayCell::moved;
      cell.moved = std::move(*moved);
    }
    return cell.lower >= terms_.goal;
  }

  /// Tries ever longer steps, until one proves something.
  void bound_as_it_is(Cell& cell, const WayPrism& prism, const std::vector<Point>& ways) const {
    const Point way = ways.empty() ? Point{1.0, 0.0, 0.0} : ways.front();
    double length = std::max(room(prism), terms_.tolerance);
    for (int k = 0; k < 60 && cell.lower < -length; ++k) {
      length *= 1.1;
      (void)is_proven(cell, prism, step_along(way, length), false);
    }
  }

  [[nodiscard]] static bool may_halve(const WayPiece& piece) {
    const double middle = verify::middle_of_way(piece.begin, piece.end);
    return piece.begin < middle && middle < piece.end;
  }

  /// Across where it is longest along the way out. False where it cannot be divided.
  [[nodiscard]] bool divide(std::size_t n, bool bends, const Point& way_out) {
    const WayPiece piece = cells_[n].piece;
    const bool may_quarter = piece.quarterings < most_quarterings;
    const bool halves = may_halve(piece) && (bends || !may_quarter || is_longer_in_time(piece, way_out));
    if (!halves && !may_quarter) return false;
    cells_[n].letter = halves ? WayCell::halved : WayCell::quartered;
    cells_[n].first_part = cells_.size();
    const Point hint = way_out;
    if (halves) {
      const double middle = verify::middle_of_way(piece.begin, piece.end);
      cells_.push_back({.piece = {piece.corners, piece.begin, middle, piece.quarterings}, .hint = hint});
      cells_.push_back({.piece = {piece.corners, middle, piece.end, piece.quarterings}, .hint = hint});
    } else {
      for (const Triangle& part : verify::quarters(piece.corners))
        cells_.push_back({.piece = {part, piece.begin, piece.end, piece.quarterings + 1}, .hint = hint});
    }
    return true;
  }

  [[nodiscard]] bool is_longer_in_time(const WayPiece& piece, const Point& way_out) {
    const verify::MovedPrism hull = verify::moved(pieces_.prism_of(piece), {});
    const auto extent = [&](const Point& a, const Point& b) {
      const Point d = verify::difference(a, b);
      return way_out == Point{} ? std::sqrt(verify::dot(d, d)) : std::abs(verify::dot(way_out, d));
    };
    double in_time = 0.0;
    double in_space = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      in_time = std::max(in_time, extent(hull.begin[i], hull.end[i]));
      in_space = std::max(in_space, extent(hull.begin[i], hull.begin[(i + 1) % 3]));
    }
    return in_time > in_space;
  }

  void append(std::size_t n, WayTriangle& proof) const {
    const Cell& cell = cells_[n];
    proof.cells.push_back(cell.letter);
    if (cell.letter == WayCell::moved) proof.moved.push_back(cell.moved);
    const std::size_t parts = cell.letter == WayCell::quartered ? 4 : cell.letter == WayCell::halved ? 2 : 0;
    for (std::size_t i = 0; i < parts; ++i) append(cell.first_part + i, proof);
  }

  const Terms& terms_;
  std::array<double, 3> at_vertices_;
  PiecesOnWay pieces_;
  std::vector<Cell> cells_;
};

/// The weights of about the point of a triangle nearest to x, and for certain of some point of it.
std::array<double, 2> weights_of(const Point& x, const Triangle& triangle) {
  const Point u = verify::difference(triangle[1], triangle[0]);
  const Point v = verify::difference(triangle[2], triangle[0]);
  const Point d = verify::difference(x, triangle[0]);
  const double uu = verify::dot(u, u);
  const double uv = verify::dot(u, v);
  const double vv = verify::dot(v, v);
  const double determinant = uu * vv - uv * uv;
  if (!(determinant > 0.0)) return {0.0, 0.0};
  const double du = verify::dot(d, u);
  const double dv = verify::dot(d, v);
  const double first = std::clamp((vv * du - uv * dv) / determinant, 0.0, 1.0);
  const double second = std::clamp((uu * dv - uv * du) / determinant, 0.0, 1.0);
  return {first, std::max(0.0, std::min(second, (1.0 - first) * (1.0 - 0x1p-52)))};
}

Point point_with(const Triangle& triangle, const std::array<double, 2>& weights) {
  const Point along_first = verify::along(triangle[0], verify::difference(triangle[1], triangle[0]), weights[0]);
  return verify::along(along_first, verify::difference(triangle[2], triangle[0]), weights[1]);
}

/// The deepest point found, at its time, and the upper end that it claims to prove.
std::pair<WayWitness, double> witness_of(std::span<const Pose> path, const Model& implant, const Mesh& bone,
                                         const MeshClearance& found, const InsertionOptions& options) {
  WayWitness witness{found.deepest.triangle, {}, 0.0, {}};
  const Triangle triangle = verify::triangle_of(bone, witness.triangle);
  witness.weights = weights_of(found.deepest.point, triangle);
  const std::vector<Point> point{point_with(triangle, witness.weights)};
  const double width = share_of_witness * options.tolerance;
  witness.time = smallest_distance_along(path, implant, point, {.tolerance = width, .device = "host"}).deepest.front();
  const verify::RigidPath way(path, verify::seat_of(implant, path));
  const auto [centre, radius] = verify::moment_of(way, point.front(), witness.time).place;
  CertifiedEnclosure there = SignedDistance(implant).certified(centre, width);
  witness.certificate = std::move(there.certificate);
  // Twice the radius and more: the exact point is off the rounded one by less.
  return {std::move(witness), there.distance.hi + 4.0 * radius};
}

/// The triangles whose vertices do not prove the goal.
std::vector<std::uint32_t> open_triangles(const Mesh& bone, std::span<const Enclosure> of_vertices, double goal) {
  std::vector<std::uint32_t> open;
  for (std::uint32_t n = 0; n < bone.triangles.size(); ++n)
    if (!(verify::least_on(verify::triangle_of(bone, n), verify::lower_ends(bone, n, of_vertices)) >= goal))
      open.push_back(n);
  return open;
}

std::size_t cells_of_each(std::size_t triangles) {
  return std::clamp(most_cells_of_all / std::max<std::size_t>(triangles, 1), least_cells_of_triangle,
                    most_cells_of_triangle);
}

}  // namespace

CertifiedWaySurface certified_way_surface(std::span<const Pose> path, const Model& implant, const Mesh& bone,
                                          std::span<const Enclosure> of_vertices, const MeshClearance& found,
                                          const InsertionOptions& options) {
  const WaySurfaceChecker checker(implant, path, bone);  // refuses what it does not know
  CertifiedWaySurface result;
  WaySurfaceCertificate& certificate = result.certificate;
  double upper = verify::least_upper_end(bone, of_vertices);
  auto [witness, deepest] = witness_of(path, implant, bone, found, options);
  if (deepest < upper) {
    certificate.deepest = std::move(witness);
    upper = deepest;
  }
  const double goal = std::min(found.smallest_distance.lo, upper - options.tolerance);
  if (std::isfinite(goal)) {
    const verify::RigidPath way(path, verify::seat_of(implant, path));
    const std::vector<verify::PosedSuperquadric> solids = verify::solids_of(implant);
    const PrismEscape escape(implant);
    const std::vector<std::uint32_t> open = open_triangles(bone, of_vertices, goal);
    const TriangleDivision::Terms terms{way, solids, escape, goal, options.tolerance, cells_of_each(open.size())};
    certificate.triangles.resize(open.size());
    const std::size_t done = in_parallel_steps(
        open.size(), triangles_at_a_time, SeenInterruption(options.interrupted), options.progress, [&](std::size_t i) {
          TriangleDivision divide(terms, verify::triangle_of(bone, open[i]),
                                  verify::lower_ends(bone, open[i], of_vertices));
          certificate.triangles[i] = divide(open[i]);
        });
    result.interrupted = done < open.size();
    if (result.interrupted) return result;
  }
  const CheckOptions check{.in_parallel = in_parallel<std::function<void(std::size_t)>>,
                           .interrupted = options.interrupted};
  result.smallest_distance = checker(of_vertices, {goal, upper}, certificate, check).proven;
  result.interrupted = options.interrupted();
  return result;
}

}  // namespace verisq
