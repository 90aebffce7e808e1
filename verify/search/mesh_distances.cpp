/// This file implements mesh_distances.hpp.
#include "verify/search/mesh_distances.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "verify/numbers/rounding.hpp"
#include "verify/proof/triangle_piece.hpp"
#include "verify/proof/verdict.hpp"

namespace verisq::verify {

namespace {

constexpr std::size_t pieces_a_task = 1024;
/// A piece smaller than this is not halved any more: the remaining width is rounding.
constexpr double smallest_in_displacements = 8.0;
/// Convexity is tested if the solid is nearer than so many radii of the piece; elsewhere distances alone are enough.
constexpr double near_in_radii = 4.0;

struct Leaf {
  TrianglePiece piece;
  PieceDistances distances;
  double radius = 0.0;  ///< of the piece
};

}  // namespace

class MeshSearch::Pieces {
 public:
  Pieces(const Mesh& mesh, std::span<const Enclosure> at_vertices, const DeviationSearch& search,
         const MeshRegions& regions)
      : search_(search), regions_(regions), lower_(std::max<std::size_t>(1, regions.count)), where_(lower_.size()) {
    for (std::uint32_t n = 0; n < mesh.triangles.size(); ++n) {
      const auto& [a, b, c] = mesh.triangles[n];
      const Triangle whole{mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
      displacement_.push_back(displacement(whole));
      area_.push_back(area_of(whole));
      leaves_.push_back({{.corners = whole,
                          .triangle = n,
                          .convex = search.convex,
                          .at_corners = {at_vertices[a], at_vertices[b], at_vertices[c]},
                          .at_centre = {-infinity, infinity}},
                         {{0.0, infinity}, {0.0, infinity}}});
      for (const std::uint32_t i : {a, b, c}) note(at_vertices[i], mesh.vertices[i], n);
    }
    found_.ended = !complete(leaves_);
  }

  void search_largest() {
    halve_while_chosen([this](std::vector<bool>& chosen) { choose_for_largest(chosen); });
  }

  void search_statistics(std::span<const double> percentiles) {
    percentiles_ = percentiles;
    halve_while_chosen([this](std::vector<bool>& chosen) {
      const std::vector<WeightedCell> cells = all_cells();
      measure(cells);
      choose_for_mean(cells, chosen);
      choose_for_percentiles(cells, chosen);
    });
    measure(all_cells());
  }

  void search_within(double distance, double width) {
    halve_while_chosen([=, this](std::vector<bool>& chosen) {
      for (const std::vector<std::size_t>& region : leaves_by_region())
        choose_for_share(region, distance, width, chosen);
    });
  }

  [[nodiscard]] std::vector<AreaWithin> within_by_region(double distance) const {
    std::vector<AreaWithin> found;
    for (const std::vector<std::size_t>& region : leaves_by_region()) {
      std::vector<WeightedCell> cells;
      for (const std::size_t i : region) cells.push_back(cell(leaves_[i]));
      found.push_back(area_within(cells, distance));
    }
    return found;
  }

  [[nodiscard]] AreaWithin within(double distance) const { return area_within(all_cells(), distance); }

  [[nodiscard]] MeshDistances found() const {
    MeshDistances found = found_;
    const std::vector<double> uppers = largest_by_region();
    const auto farthest = static_cast<std::size_t>(std::ranges::max_element(lower_) - lower_.begin());
    found.where = where_[farthest];
    found.largest = largest_between(lower_[farthest], *std::ranges::max_element(uppers));
    return found;
  }

  [[nodiscard]] std::vector<MeshDistances> found_by_region() const {
    std::vector<std::vector<WeightedCell>> cells(lower_.size());
    for (const Leaf& leaf : leaves_) cells[region_of(leaf.piece.triangle)].push_back(cell(leaf));
    const std::vector<double> uppers = largest_by_region();
    std::vector<MeshDistances> found(lower_.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      found[i].largest = largest_between(lower_[i], uppers[i]);
      found[i].where = where_[i];
      found[i].mean = cells[i].empty() ? Enclosure{0.0, 0.0} : mean_of(cells[i]);
    }
    return found;
  }

 private:
  template <class Choose>
  void halve_while_chosen(const Choose& choose) {
    while (!found_.ended) {
      std::vector<bool> chosen(leaves_.size(), false);
      choose(chosen);
      std::vector<std::size_t> indices;
      for (std::size_t i = 0; i < chosen.size(); ++i) {
        if (chosen[i] && divisible(leaves_[i])) indices.push_back(i);
      }
      if (indices.empty()) return;
      found_.ended = search_.ended() || found_.samples + 3 * indices.size() > search_.most_samples || !halve(indices);
    }
  }

  [[nodiscard]] std::size_t region_of(std::uint32_t triangle) const {
    return regions_.count == 0 ? 0 : regions_.region_of[triangle];
  }

  void note(const Enclosure& signed_distance, const Point& point, std::uint32_t triangle) {
    const double lower = magnitude(signed_distance).lo;
    const std::size_t region = region_of(triangle);
    if (!(lower > lower_[region])) return;
    lower_[region] = lower;
    where_[region] = point;
  }

  /// The rows of points that are off by the displacement of their triangle. False where it ended early.
  [[nodiscard]] bool ask(const SignedDistances& distances, std::span<const Point> points,
                         std::span<const std::uint32_t> triangles, std::vector<Enclosure>& rows) {
    rows.assign(points.size(), {-infinity, infinity});
    if (!distances(points, rows)) return false;
    found_.samples += points.size();
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = widened(rows[i], displacement_[triangles[i]]);
    return true;
  }

  /// Computes the distances of the centres and the bounds about them. False if it ended early: then the leaves are
  /// unusable.
  [[nodiscard]] bool complete(std::vector<Leaf>& leaves) {
    std::vector<Point> points(leaves.size());
    std::vector<std::uint32_t> triangles(leaves.size());
    for (std::size_t i = 0; i < leaves.size(); ++i) {
      points[i] = centre(leaves[i].piece.corners);
      triangles[i] = leaves[i].piece.triangle;
    }
    std::vector<Enclosure> rows;
    if (!ask(search_.to_model, points, triangles, rows)) return false;
    for (std::size_t i = 0; i < leaves.size(); ++i) {
      leaves[i].piece.at_centre = rows[i];
      note(rows[i], points[i], triangles[i]);
    }
    if (!find_convex(leaves)) return false;
    bound(leaves);
    return true;
  }

  void bound(std::vector<Leaf>& leaves) const {
    const std::size_t tasks = (leaves.size() + pieces_a_task - 1) / pieces_a_task;
    search_.in_parallel(tasks, [&](std::size_t task) {
      const std::size_t end = std::min(leaves.size(), (task + 1) * pieces_a_task);
      for (std::size_t i = task * pieces_a_task; i < end; ++i) bound(leaves[i]);
    });
  }

  /// Bounds proven for a larger piece are valid for its parts; but the parts' means are their own.
  void bound(Leaf& leaf) const {
    const auto what = [] { return "distances on a triangle and on its part"; };
    const PieceShape shape = shape_of(leaf.piece.corners, displacement_[leaf.piece.triangle]);
    const PieceDistances own = distances_on(leaf.piece, shape);
    leaf.radius = shape.radius;
    leaf.distances.range = intersection(leaf.distances.range, own.range, what);
    leaf.distances.mean = intersection(leaf.distances.range, own.mean, what);
    leaf.distances.affine = own.affine;
  }

  /// If all primitives but one are proven to be far, the signed distance is the distance to that one. Far means: no
  /// ball about a point of the piece that reaches no farther than the solid meets them.
  [[nodiscard]] bool find_convex(std::vector<Leaf>& leaves) {
    if (search_.to_primitives.empty()) return true;
    std::vector<std::size_t> open;
    std::vector<Point> points;
    std::vector<std::uint32_t> triangles;
    std::vector<double> reach;  // of these balls about the centre
    for (std::size_t i = 0; i < leaves.size(); ++i) {
      const TrianglePiece& piece = leaves[i].piece;
      const double radius = shape_of(piece.corners, displacement_[piece.triangle]).radius;
      const double away = magnitude(piece.at_centre).hi;
      if (piece.convex || !(away < near_in_radii * radius)) continue;
      open.push_back(i);
      points.push_back(centre(piece.corners));
      triangles.push_back(piece.triangle);
      reach.push_back(add(away, multiply(2.0, radius, Direction::up), Direction::up));
    }
    if (open.empty()) return true;
    std::vector<std::size_t> within(open.size(), 0);
    std::vector<Enclosure> rows;
    for (const SignedDistances& to_primitive : search_.to_primitives) {
      if (!ask(to_primitive, points, triangles, rows)) return false;
      for (std::size_t i = 0; i < open.size(); ++i) within[i] += rows[i].lo > reach[i] ? 0 : 1;
    }
    for (std::size_t i = 0; i < open.size(); ++i) leaves[open[i]].piece.convex = within[i] <= 1;
    return true;
  }

  [[nodiscard]] bool divisible(const Leaf& leaf) const {
    const double off = displacement_[leaf.piece.triangle];
    return leaf.piece.halvings < most_halvings_of_piece && leaf.radius > smallest_in_displacements * off;
  }

  [[nodiscard]] WeightedCell cell(const Leaf& leaf) const {
    const Enclosure& area = area_[leaf.piece.triangle];
    const double share = std::ldexp(1.0, -leaf.piece.halvings);
    return {{multiply(area.lo, share, Direction::down), multiply(area.hi, share, Direction::up)},
            leaf.distances.range,
            leaf.distances.mean,
            leaf.distances.affine};
  }

  [[nodiscard]] bool is_narrow(const Enclosure& result) const {
    return result.hi - result.lo <= search_.allowed(result.lo);
  }

  [[nodiscard]] static Enclosure largest_between(double lower, double upper) {
    return between(lower, upper, [] { return "the largest distance of the mesh"; });
  }

  [[nodiscard]] std::vector<double> largest_by_region() const {
    std::vector<double> uppers(lower_.size(), 0.0);
    for (const Leaf& leaf : leaves_) {
      double& upper = uppers[region_of(leaf.piece.triangle)];
      upper = std::max(upper, leaf.distances.range.hi);
    }
    return uppers;
  }

  [[nodiscard]] std::vector<WeightedCell> all_cells() const {
    std::vector<WeightedCell> cells;
    cells.reserve(leaves_.size());
    for (const Leaf& leaf : leaves_) cells.push_back(cell(leaf));
    return cells;
  }

  void measure(const std::vector<WeightedCell>& cells) {
    found_.mean = mean_of(cells);
    const Distribution distribution(cells);
    found_.percentiles.clear();
    for (const double percent : percentiles_) found_.percentiles.push_back(distribution.percentile(percent));
  }

  void choose_for_largest(std::vector<bool>& chosen) const {
    std::vector<double> targets;
    for (const double lower : lower_) targets.push_back(add(lower, search_.allowed(lower), Direction::down));
    double worst = 1.0;  // of target to bound
    for (std::size_t i = 0; i < leaves_.size(); ++i) {
      const double upper = leaves_[i].distances.range.hi;
      const double target = targets[region_of(leaves_[i].piece.triangle)];
      if (!(upper > target)) continue;
      chosen[i] = true;
      worst = std::min(worst, target / upper);
    }
    search_.progress(worst);
  }

  void choose_for_mean(const std::vector<WeightedCell>& cells, std::vector<bool>& chosen) const {
    if (is_narrow(*found_.mean)) return;
    double weight = 0.0;
    std::vector<std::pair<double, std::size_t>> widths;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      weight += cells[i].weight.hi;
      widths.emplace_back(cells[i].weight.hi * (cells[i].mean.hi - cells[i].mean.lo), i);
    }
    choose_widest(widths, search_.allowed(found_.mean->lo) * weight, chosen);
  }

  /// Cells whose part up to about the percentile is not known well.
  void choose_for_percentiles(const std::vector<WeightedCell>& cells, std::vector<bool>& chosen) const {
    for (const Enclosure& value : found_.percentiles) {
      if (is_narrow(value)) continue;
      const double middle = 0.5 * value.lo + 0.5 * value.hi;
      double excess = 0.0;
      std::vector<std::pair<double, std::size_t>> widths;
      for (std::size_t i = 0; i < cells.size(); ++i) {
        const Enclosure part = part_up_to(cells[i], middle);
        const double width = cells[i].weight.hi * (part.hi - part.lo);
        if (!(width > 0.0)) continue;
        widths.emplace_back(width, i);
        excess += width;
      }
      choose_widest(widths, excess * search_.allowed(value.lo) / (value.hi - value.lo), chosen);
    }
  }

  [[nodiscard]] std::vector<std::vector<std::size_t>> leaves_by_region() const {
    std::vector<std::vector<std::size_t>> regions(lower_.size());
    for (std::size_t i = 0; i < leaves_.size(); ++i) regions[region_of(leaves_[i].piece.triangle)].push_back(i);
    return regions;
  }

  /// Chooses the pieces with the least known share of points no farther than `distance`.
  void choose_for_share(const std::vector<std::size_t>& region, double distance, double width,
                        std::vector<bool>& chosen) const {
    double area = 0.0;
    double open = 0.0;
    std::vector<std::pair<double, std::size_t>> widths;
    for (const std::size_t i : region) {
      const WeightedCell leaf = cell(leaves_[i]);
      const Enclosure part = part_up_to(leaf, distance);
      area += leaf.weight.hi;
      if (!(part.hi > part.lo)) continue;
      widths.emplace_back(leaf.weight.hi * (part.hi - part.lo), i);
      open += widths.back().first;
    }
    if (open > width * area) choose_widest(widths, width * area, chosen);
  }

  /// False where it ended early: the leaves are as before.
  [[nodiscard]] bool halve(const std::vector<std::size_t>& chosen) {
    std::vector<Point> middles(chosen.size());
    std::vector<std::uint32_t> triangles(chosen.size());
    std::vector<LongestSide> sides(chosen.size());
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      const TrianglePiece& piece = leaves_[chosen[i]].piece;
      sides[i] = longest_side(piece.corners);
      middles[i] = sides[i].middle;
      triangles[i] = piece.triangle;
    }
    std::vector<Enclosure> rows;
    if (!ask(search_.to_model, middles, triangles, rows)) return false;
    std::vector<Leaf> parts;
    parts.reserve(2 * chosen.size());
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      note(rows[i], middles[i], triangles[i]);
      for (const TrianglePiece& half : halves(leaves_[chosen[i]].piece, sides[i], rows[i])) {
        parts.push_back({half, {leaves_[chosen[i]].distances.range, {0.0, infinity}}});
      }
    }
    if (!complete(parts)) return false;
    for (std::size_t i = 0; i < chosen.size(); ++i) leaves_[chosen[i]] = parts[2 * i];
    for (std::size_t i = 0; i < chosen.size(); ++i) leaves_.push_back(parts[2 * i + 1]);
    return true;
  }

  std::span<const double> percentiles_;
  const DeviationSearch& search_;
  std::vector<double> displacement_;  // of each triangle
  std::vector<Enclosure> area_;       // likewise
  std::vector<Leaf> leaves_;
  MeshRegions regions_;
  std::vector<double> lower_;  // of the largest distance, of each region
  std::vector<Point> where_;   // likewise
  MeshDistances found_{};
};

MeshSearch::MeshSearch(const Mesh& mesh, std::span<const Enclosure> at_vertices, const DeviationSearch& search,
                       const MeshRegions& regions)
    : pieces_(hidden<Pieces>(mesh, at_vertices, search, regions)) {}

void MeshSearch::search_largest() {
  pieces_->search_largest();
}

void MeshSearch::search_statistics(std::span<const double> percentiles) {
  pieces_->search_statistics(percentiles);
}

std::vector<MeshDistances> MeshSearch::found_by_region() const {
  return pieces_->found_by_region();
}

void MeshSearch::search_within(double distance, double width) {
  pieces_->search_within(distance, width);
}

std::vector<AreaWithin> MeshSearch::within_by_region(double distance) const {
  return pieces_->within_by_region(distance);
}

AreaWithin MeshSearch::within(double distance) const {
  return pieces_->within(distance);
}

MeshDistances MeshSearch::found() const {
  return pieces_->found();
}

}  // namespace verisq::verify
