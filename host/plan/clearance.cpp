/// This file implements clearance.hpp.
#include "host/plan/clearance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "host/threads/parallel.hpp"
#include "verify/numbers/rounding.hpp"
#include "verify/proof/clearance_claims.hpp"
#include "verify/proof/closed_surface.hpp"
#include "verify/proof/side_checker.hpp"
#include "verify/proof/triangle_piece.hpp"
#include "verify/proof/verdict.hpp"
#include "verify/proof/way_checker.hpp"
#include "verify/search/certified_distance.hpp"
#include "verify/search/set_tree.hpp"
#include "verify/solids/model.hpp"
#include "verisq/clearance.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/error.hpp"
#include "verisq/insertion.hpp"
#include "verisq/map.hpp"

namespace verisq {

Clearance certified_clearance(const Model& posed, const Cavity& cavity, const Fitness& fitness,
                              double penetration_limit, const MapOptions& options, const Sink<Point>& sink) {
  verify::require_valid_with_meshes(posed);
  ClearanceSum sum(cavity.areas, cavity.area_of, fitness, penetration_limit);
  std::span<const Point> rest = cavity.points;
  const Source<Point> source = [&rest](std::span<Point> chunk) {
    const std::size_t count = std::min(chunk.size(), rest.size());
    std::ranges::copy(rest.first(count), chunk.begin());
    rest = rest.subspan(count);
    return count;
  };
  const Sink<Point> sum_up = [&](std::span<const Point> points, std::span<const MapResult> rows,
                                 std::span<const Certificate> certificates) {
    sum.add(rows);
    sink(points, rows, certificates);
  };
  const MapSummary summary = PointMapper(posed, options).map(source, sum_up);
  Clearance clearance = sum.report();
  clearance.map = summary;
  return clearance;
}

namespace {

using verify::centre;
using verify::Direction;
using verify::displacement;

/// Share of the tolerance for the samples; the rest is for the balls.
constexpr double share_of_samples = 0.25;
/// Share of the depth beyond the limit: the accuracy to which a triangle's deepest point is sought.
constexpr double share_of_depth = 0.25;

/// Halvings before pieces are bounded by half-spaces: those cost a hundred samples.
constexpr int halvings_before_half_spaces = 1;

/// Rounds of halving before the distances of whole triangles are computed. For tapered solids the host computes them, a
/// thousand times slower than points; by then the points have left few triangles open.
constexpr int rounds_of_tapered = 6;
/// For bends and set operations whole triangles are searched, which takes as long as so many rounds of samples or more.
constexpr int rounds_of_searched = 10;

int rounds_before_whole_triangles_of(const Model& model) {
  if (!is_union_of_convex(model)) return rounds_of_searched;
  return verify::has_taper(model) ? rounds_of_tapered : 0;
}

/// A part of a triangle, by its corners to nearest; a thin one by its longest side, whose end comes twice then.
struct Piece {
  Triangle corners;
  std::uint32_t triangle;
  double displacement;     ///< no point between the corners is farther from the triangle
  double thickness = 0.0;  ///< the piece lies no farther than displacement + thickness from the hull of the corners
  int halvings = 0;
  double bound = -infinity;  ///< no signed distance on the piece is less
  bool in_overlap = false;   ///< half-spaces do not bound it
};

double distance_up(const Point& a, const Point& b) {
  double squares = 0.0;  // rounded up: sum of nonnegative terms
  for (std::size_t i = 0; i < 3; ++i) {
    const double apart =
        std::max(verify::subtract(a[i], b[i], Direction::up), verify::subtract(b[i], a[i], Direction::up));
    squares = verify::add(squares, verify::multiply(apart, apart, Direction::up), Direction::up);
  }
  return verify::square_root(squares, Direction::up);
}

/// The radius of a ball about `sample` that contains the exact piece: a ball that contains the corners contains their
/// hull.
double radius_up(const Piece& piece, const Point& sample) {
  double farthest = 0.0;
  for (const Point& corner : piece.corners) farthest = std::max(farthest, distance_up(corner, sample));
  return verify::add(farthest, verify::add(piece.displacement, piece.thickness, Direction::up), Direction::up);
}

/// The ends of the longest side first.
Triangle longest_side_first(const Triangle& corners) {
  const auto& [a, b, c] = corners;
  const std::array<double, 3> sides{distance_up(a, b), distance_up(b, c), distance_up(c, a)};
  const auto longest = static_cast<std::size_t>(std::ranges::max_element(sides) - sides.begin());
  return {corners[longest], corners[(longest + 1) % 3], corners[(longest + 2) % 3]};
}

/// About the point of a segment nearest to `apex`. It is off the segment by less than 16 u times the largest
/// coordinate, less than the displacement.
Point foot(const Point& apex, const Point& from, const Point& to) {
  double along = 0.0;
  double squared = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    along += (apex[i] - from[i]) * (to[i] - from[i]);
    squared += (to[i] - from[i]) * (to[i] - from[i]);
  }
  const double share = squared > 0.0 ? std::clamp(along / squared, 0.0, 1.0) : 0.0;
  Point foot;
  for (std::size_t i = 0; i < 3; ++i) foot[i] = from[i] + share * (to[i] - from[i]);
  return foot;
}

/// Halves of a needle lie side by side, more and more of them. So a piece no thicker than `thinnest` becomes a segment.
/// The distance to the longest side is convex and 0 at its ends, hence largest at the third corner.
Piece without_thinness(const Piece& piece, double thinnest) {
  const auto [from, to, apex] = longest_side_first(piece.corners);
  if (piece.thickness > 0.0 || from == to) return piece;
  const double height = distance_up(apex, foot(apex, from, to));
  if (!(height <= thinnest)) return piece;  // also for NaN, where numbers overflow
  Piece segment = piece;
  segment.corners = {from, to, to};
  segment.thickness = verify::add(height, piece.displacement, Direction::up);  // of the foot
  return segment;
}

/// Halves the piece at the middle of the longest side, so that slivers do not stay slivers.
std::array<Piece, 2> halves(const Piece& piece) {
  const auto [from, to, apex] = longest_side_first(piece.corners);
  Point middle;
  for (std::size_t i = 0; i < 3; ++i) middle[i] = 0.5 * from[i] + 0.5 * to[i];
  std::array<Piece, 2> halves{piece, piece};
  halves[0].corners = {from, middle, piece.thickness > 0.0 ? middle : apex};
  halves[1].corners = {middle, to, piece.thickness > 0.0 ? to : apex};
  for (Piece& half : halves) ++half.halvings;
  return halves;
}

/// The known facts about one triangle.
struct TriangleState {
  double deepest = infinity;  ///< the least upper bound of a sample's distance
  Point deepest_point{};
  bool unresolved = false;  ///< a piece may lie too deep, but this cannot be decided
};

/// Returns enclosures of a 1-Lipschitz function of the place; when interrupted, only those of the first points.
using Distances = std::function<std::vector<Enclosure>(std::span<const Point>)>;

/// Wide enclosures of samples cost less, but leave more samples to be processed.
double tolerance_of_samples(const MeshClearanceOptions& options) {
  return share_of_samples * std::min(options.tolerance, options.limit_tolerance.value_or(options.tolerance));
}

std::vector<Enclosure> distances_of(std::span<const MapResult> rows) {
  std::vector<Enclosure> distances;
  for (const MapResult& row : rows) distances.push_back(row.distance);
  return distances;
}

Distances distances_to(const Model& model, const MeshClearanceOptions& options) {
  const auto mapper = std::make_shared<PointMapper>(model, MapOptions{.tolerance = tolerance_of_samples(options),
                                                                      .device = options.device,
                                                                      .interrupted = options.interrupted});
  return [mapper](std::span<const Point> queries) {
    std::vector<MapResult> rows(queries.size());
    rows.resize(mapper->map(queries, rows).points);
    return distances_of(rows);
  };
}

Distances smallest_distances_along(std::span<const Pose> path, const Model& model,
                                   const MeshClearanceOptions& options) {
  return [=, &model](std::span<const Point> queries) {
    const Insertion insertion = smallest_distance_along(
        path, model, queries,
        {.tolerance = tolerance_of_samples(options), .device = options.device, .interrupted = options.interrupted});
    return distances_of(insertion.rows);
  };
}

class MeshSearch {
 public:
  /// With `deepens`, seeks about the deepest point of each triangle that lies too deep.
  MeshSearch(Distances distances, const Mesh& mesh, const MeshClearanceOptions& options, bool deepens)
      : options_(options),
        mesh_(mesh),
        distances_(std::move(distances)),
        deepens_(deepens),
        triangles_(mesh.triangles.size()) {
    for (std::uint32_t n = 0; n < mesh.triangles.size(); ++n) {
      const Triangle whole = corners_of(n);
      open_.push_back({.corners = whole, .triangle = n, .displacement = displacement(whole)});
    }
  }

  /// Uses bounds of whole triangles, too, if `distances` are those to the model, which must outlive the search.
  void use_whole_triangles(const Model& model) {
    whole_triangles_of_ = &model;
    rounds_before_whole_triangles_ = rounds_before_whole_triangles_of(model);
  }

  /// Uses bounds of half-spaces, too, for unions of convex primitives.
  void use_half_spaces(const Model& model) {
    if (is_union_of_convex(model)) half_spaces_.emplace(model);
  }

  /// The samples are about right only: their bounds may contradict each other.
  void estimate() { proves_ = false; }

  MeshClearance operator()() {
    for (int round = 0; !open_.empty() && !found_.interrupted; ++round) {
      const bool enough = found_.samples + open_.size() > options_.most_samples;
      if (rounds_before_whole_triangles_ && (enough || round >= *rounds_before_whole_triangles_)) {
        rounds_before_whole_triangles_.reset();
        bound_triangles_with_open_pieces();
        continue;
      }
      if (enough) break;
      sample();
      divide();
    }
    for (const Piece& piece : open_) settle(piece);
    summarise();
    return std::move(found_);
  }

 private:
  /// If a triangle does not meet the solid, its distance is the smallest signed one on it, which a certificate for the
  /// whole triangle proves at once. If it meets the solid, the distance is 0, above the smallest signed one. Returns
  /// the former, by triangle, and no bound for others.
  [[nodiscard]] std::vector<double> distances_of_whole(std::span<const std::uint32_t> triangles) {
    const bool certified = is_union_of_convex(*whole_triangles_of_);
    TriangleMapper mapper(*whole_triangles_of_, {.tolerance = certified ? share_of_samples * options_.tolerance
                                                                        : tolerance_of_samples(options_),
                                                 .device = options_.device,
                                                 .interrupted = options_.interrupted});
    std::vector<Triangle> corners;
    for (const std::uint32_t triangle : triangles) corners.push_back(corners_of(triangle));
    std::vector<MapResult> rows(triangles.size());
    const MapSummary map = mapper.map(corners, rows);
    std::vector<double> bounds(triangles_.size(), -infinity);
    for (std::size_t i = 0; i < map.points; ++i) {
      const Enclosure& distance = rows[i].distance;
      if (distance.lo > 0.0) bounds[triangles[i]] = distance.lo;
      smallest_hi_ = std::min(smallest_hi_, distance.hi);
    }
    found_.interrupted = map.interrupted;
    return bounds;
  }

  /// Bounds of a whole triangle are valid on its pieces.
  void bound_triangles_with_open_pieces() {
    std::vector<std::uint32_t> triangles;
    for (const Piece& piece : open_) triangles.push_back(piece.triangle);
    std::ranges::sort(triangles);
    triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
    const std::vector<double> bounds = distances_of_whole(triangles);
    for (Piece& piece : open_) piece.bound = std::max(piece.bound, bounds[piece.triangle]);
    settle_unless([this](const Piece& piece) { return is_open(piece); });
  }

  [[nodiscard]] bool too_deep(std::uint32_t triangle) const {
    return triangles_[triangle].deepest < -options_.penetration_limit;
  }

  /// Bounds every open piece by the distance of its centre; when interrupted, only the first of them.
  void sample() {
    std::vector<Point> samples;
    for (const Piece& piece : open_) samples.push_back(centre(piece.corners));
    const std::vector<Enclosure> distances = distances_(samples);
    for (std::size_t n = 0; n < distances.size(); ++n) bound(open_[n], samples[n], distances[n]);
    found_.interrupted = distances.size() < samples.size() || options_.interrupted();
    found_.samples += distances.size();
  }

  void bound(Piece& piece, const Point& sample, const Enclosure& distance) {
    piece.bound = std::max(piece.bound, verify::subtract(distance.lo, radius_up(piece, sample), Direction::down));
    const double hi = verify::add(distance.hi, piece.displacement, Direction::up);
    if (hi < smallest_hi_) found_.deepest = {sample, piece.triangle};
    smallest_hi_ = std::min(smallest_hi_, hi);
    TriangleState& triangle = triangles_[piece.triangle];
    if (hi >= triangle.deepest) return;
    triangle.deepest = hi;
    triangle.deepest_point = sample;
  }

  void bound_by_half_spaces(Piece& piece) const {
    if (piece.halvings < halvings_before_half_spaces || piece.in_overlap) return;
    const double bound = (*half_spaces_)(piece.corners);
    piece.in_overlap = bound == -infinity;
    const double off = verify::add(piece.displacement, piece.thickness, Direction::up);
    piece.bound = std::max(piece.bound, verify::subtract(bound, off, Direction::down));
  }

  void divide() {
    settle_unless([this](const Piece& piece) { return is_worth_halving(piece); });
    if (half_spaces_) {
      in_parallel(open_.size(), [this](std::size_t n) { bound_by_half_spaces(open_[n]); });
      settle_unless([this](const Piece& piece) { return is_open(piece); });
    }
    std::vector<Piece> next;
    for (const Piece& piece : open_)
      for (const Piece& half : halves(without_thinness(piece, thinnest()))) next.push_back(half);
    open_ = std::move(next);
  }

  [[nodiscard]] bool may_decide(const Piece& piece) const {
    return piece.bound < -options_.penetration_limit && !too_deep(piece.triangle);
  }

  [[nodiscard]] bool may_narrow(const Piece& piece) const { return piece.bound < smallest_hi_ - options_.tolerance; }

  /// May hold a point that is much deeper than the deepest known of its triangle.
  [[nodiscard]] bool may_deepen(const Piece& piece) const {
    const double deepest = triangles_[piece.triangle].deepest;
    return deepens_ && too_deep(piece.triangle) &&
           piece.bound < deepest - share_of_depth * (-options_.penetration_limit - deepest);
  }

  [[nodiscard]] bool is_open(const Piece& piece) const {
    return may_decide(piece) || may_deepen(piece) || may_narrow(piece);
  }

  [[nodiscard]] bool is_worth_halving(const Piece& piece) const {
    if (piece.halvings == verify::most_halvings_of_piece) return false;
    const double radius = radius_up(piece, centre(piece.corners));
    if (radius <= 8.0 * piece.displacement) return false;  // what is left is rounding
    return ((may_decide(piece) || may_deepen(piece)) &&
            radius > share_of_samples * options_.limit_tolerance.value_or(options_.tolerance)) ||
           (may_narrow(piece) && radius > share_of_samples * options_.tolerance);
  }

  template <class Keep>
  void settle_unless(const Keep& keep) {
    std::erase_if(open_, [&](const Piece& piece) {
      if (keep(piece)) return false;
      settle(piece);
      return true;
    });
  }

  void settle(const Piece& piece) {
    settled_lo_ = std::min(settled_lo_, piece.bound);
    if (!(piece.bound >= -options_.penetration_limit)) triangles_[piece.triangle].unresolved = true;
  }

  void summarise() {
    for (std::uint32_t n = 0; n < triangles_.size(); ++n) {
      if (too_deep(n)) {
        ++found_.proven_too_deep;
        found_.too_deep.push_back({triangles_[n].deepest_point, n});
      } else {
        ++(triangles_[n].unresolved ? found_.undecided : found_.proven_within);
      }
    }
    const double lo = proves_ ? settled_lo_ : std::min(settled_lo_, smallest_hi_);
    found_.smallest_distance = verify::between(lo, smallest_hi_, [] { return "the smallest distance of the mesh"; });
  }

  /// Half the largest distance from its sample of a piece that is not worth halving.
  [[nodiscard]] double thinnest() const {
    return 0.5 * share_of_samples * std::min(options_.tolerance, options_.limit_tolerance.value_or(options_.tolerance));
  }

  [[nodiscard]] Triangle corners_of(std::uint32_t triangle) const {
    const auto& [a, b, c] = mesh_.triangles[triangle];
    return {mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c]};
  }

  MeshClearanceOptions options_;
  const Mesh& mesh_;
  Distances distances_;
  bool deepens_;
  bool proves_ = true;
  const Model* whole_triangles_of_ = nullptr;
  std::optional<int> rounds_before_whole_triangles_;  ///< none if whole triangles have been used, or cannot be
  std::optional<verify::HalfSpaceBound> half_spaces_;
  std::vector<TriangleState> triangles_;
  std::vector<Piece> open_;
  double settled_lo_ = infinity;   ///< least bound of all pieces that are not open any more
  double smallest_hi_ = infinity;  ///< least upper end of all samples
  MeshClearance found_{};
};

}  // namespace

MeshClearance mesh_clearance(const Model& model, const Mesh& mesh, const MeshClearanceOptions& options) {
  verify::require_valid_with_meshes(model);
  if (mesh.triangles.empty()) throw Error(ErrorKind::input, "the mesh has no triangles");
  MeshSearch search(distances_to(model, options), mesh, options, true);
  search.use_whole_triangles(model);
  search.use_half_spaces(model);
  return search();
}

MeshClearance mesh_estimate(const ProposedDistances& distances, const Mesh& mesh, const MeshClearanceOptions& options) {
  const auto enclosed = [&distances](std::span<const Point> queries) {
    std::vector<Enclosure> rows;
    rows.reserve(queries.size());
    for (const double distance : distances(queries)) rows.push_back({distance, distance});
    return rows;
  };
  MeshSearch search(enclosed, mesh, options, true);
  search.estimate();
  return search();
}

MeshClearance mesh_clearance_along(std::span<const Pose> path, const Model& model, const Mesh& mesh,
                                   const MeshClearanceOptions& options) {
  verify::require_valid_with_meshes(model);
  if (mesh.triangles.empty()) throw Error(ErrorKind::input, "the mesh has no triangles");
  check_path(path);
  return MeshSearch(smallest_distances_along(path, model, options), mesh, options, false)();
}

std::vector<std::uint32_t> covering_primitives(const Model& model) {
  verify::require_valid_with_meshes(model);
  return verify::covering_primitives(model);
}

bool Sides::kept() const {
  return std::ranges::all_of(of_primitives, [](SideFinding finding) { return finding == SideFinding::kept; });
}

std::vector<SideClaim> claims_of(const Sides& sides, std::span<const SurfaceSide> required) {
  std::vector<SideClaim> claims;
  for (std::size_t k = 0; k < required.size(); ++k) {
    if (required[k] != SurfaceSide::any && sides.of_primitives[k] == SideFinding::kept)
      claims.push_back({k, required[k]});
  }
  return claims;
}

std::optional<int> facing_of(const Mesh& surface) {
  return verify::orientation_of(verify::closed_triangles(surface, verify::closing_over_rims(surface)));
}

bool faces_outward(const Mesh& surface) {
  return facing_of(surface) == 1;
}

void check_surface_has_sides(const Mesh& surface) {
  verify::require_sides(surface);
}

Sides prove_sides(const Model& model, const Mesh& surface, std::span<const SurfaceSide> required,
                  double penetration_limit, const std::function<bool()>& interrupted) {
  if (required.size() != model.primitives.size()) {
    throw Error(ErrorKind::input,
                fmt::format("sides: {} required of {} primitives", required.size(), model.primitives.size()));
  }
  const SideChecker checker(model, surface, penetration_limit);
  Sides sides{.of_primitives = {}, .rims = checker.rims()};
  for (std::size_t k = 0; k < required.size(); ++k) {
    sides.of_primitives.push_back(checker(
        {k, required[k]}, {.in_parallel = in_parallel<std::function<void(std::size_t)>>, .interrupted = interrupted}));
  }
  return sides;
}

}  // namespace verisq
