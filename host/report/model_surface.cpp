/// A grid over each primitive, and of it what lies on the boundary of the whole.
#include "host/report/model_surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <vector>

#include "host/tessellation/placed_primitive.hpp"
#include "host/tessellation/solid.hpp"

namespace verisq::report {
namespace {

using std::numbers::pi;
using tessellation::PlacedPrimitive;
using tessellation::SurfaceParameters;

constexpr int steps_a_quarter = 12;
/// In quarter turns: what is nearer than this to its neighbour adds triangles and nothing to see.
constexpr double closest = 0.1 / steps_a_quarter;
/// Of the triangles where cuts pass: 2^4 times finer than the grid.
constexpr int deepest_split = 4;

enum class Face { none, outward, inward };  // inward: the primitive is cut away there

using ParameterTriangle = std::array<SurfaceParameters, 3>;

SurfaceParameters between(const SurfaceParameters& a, const SurfaceParameters& b) {
  return {(a.longitude + b.longitude) / 2.0, (a.latitude + b.latitude) / 2.0};
}

/// Directions from one axis to the next, in quarter turns: evenly spread ones for the flat parts, and those of the
/// curve's usual form (cos^e, sin^e), which crowd wherever the exponent makes it turn.
std::vector<double> quarter_grid(double exponent) {
  std::vector<double> grid;
  for (int k = 0; k <= steps_a_quarter; ++k) {
    const double even = static_cast<double>(k) / steps_a_quarter;
    const double angle = even * pi / 2.0;
    grid.push_back(even);
    grid.push_back(std::atan2(std::pow(std::sin(angle), exponent), std::pow(std::cos(angle), exponent)) / (pi / 2.0));
  }
  std::ranges::sort(grid);
  std::vector<double> thinned{0.0};
  for (const double t : grid) {
    if (t - thinned.back() > closest && 1.0 - t > closest) thinned.push_back(t);
  }
  return thinned;  // 1 is the first of the next quarter
}

/// From `first` to `last` quarter turns, both included.
std::vector<double> grid_of_quarters(int first, int last, double exponent) {
  const std::vector<double> quarter = quarter_grid(exponent);
  std::vector<double> grid;
  for (int q = first; q < last; ++q) {
    for (const double t : quarter) grid.push_back(q + t);
  }
  grid.push_back(last);
  return grid;
}

/// Of a tapered primitive also those that are evenly spread about the end which the taper stretches: the taper takes
/// the point (c, s) of the unit circle to the height where this direction leads.
std::vector<double> latitudes(const PlacedPrimitive& primitive) {
  std::vector<double> grid = grid_of_quarters(-1, 1, primitive.exponents()[0]);
  const double k = primitive.taper();
  if (k == 0.0) return grid;
  const double squeeze = std::sqrt((1.0 - k) * (1.0 + k));
  for (int step = 1 - steps_a_quarter; step < steps_a_quarter; ++step) {
    const double angle = step * pi / (2.0 * steps_a_quarter);
    const double latitude = std::atan2(std::sin(angle) + k, squeeze * std::cos(angle)) / (pi / 2.0);
    const auto next = std::ranges::lower_bound(grid, latitude);
    if (std::min(*next - latitude, latitude - *std::prev(next)) > squeeze * closest) grid.insert(next, latitude);
  }
  return grid;
}

class SurfaceBuilder {
 public:
  explicit SurfaceBuilder(const Model& model) : model_(model), solid_(model) {}

  Mesh build() && {
    for (std::size_t k = 0; k < primitives_.size(); ++k) add_primitive(k);
    return std::move(mesh_);
  }

 private:
  void add_primitive(std::size_t k) {
    const PlacedPrimitive& primitive = primitives_[k];
    const std::vector<double> longitudes = grid_of_quarters(0, 4, primitive.exponents()[1]);
    const std::vector<double> heights = latitudes(primitive);
    for (std::size_t i = 0; i + 1 < longitudes.size(); ++i) {
      for (std::size_t j = 0; j + 1 < heights.size(); ++j) {
        add_cell(k, {longitudes[i], heights[j]}, {longitudes[i + 1], heights[j + 1]});
      }
    }
  }

  /// Cells at the poles are triangles.
  void add_cell(std::size_t k, const SurfaceParameters& low, const SurfaceParameters& high) {
    const SurfaceParameters low_right{high.longitude, low.latitude};
    const SurfaceParameters high_left{low.longitude, high.latitude};
    if (low.latitude > -1.0) add(k, {low, low_right, high.latitude < 1.0 ? high : between(high, high_left)}, 0);
    if (high.latitude < 1.0) add(k, {low.latitude > -1.0 ? low : between(low, low_right), high, high_left}, 0);
  }

  void add(std::size_t k, const ParameterTriangle& triangle, int depth) {
    const PlacedPrimitive& primitive = primitives_[k];
    std::array<Eigen::Vector3d, 3> corners;
    std::ranges::transform(triangle, corners.begin(), [&](const auto& p) { return primitive.surface_point(p); });
    if (primitives_.size() == 1) return keep(corners, Face::outward);

    const SurfaceParameters middle{(triangle[0].longitude + triangle[1].longitude + triangle[2].longitude) / 3.0,
                                   (triangle[0].latitude + triangle[1].latitude + triangle[2].latitude) / 3.0};
    const Eigen::Vector3d normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).stableNormalized();
    const Eigen::Vector3d step = 1e-6 * primitive.radius() * normal;
    const std::array faces{face(k, corners[0], step), face(k, corners[1], step), face(k, corners[2], step),
                           face(k, primitive.surface_point(middle), step)};
    const bool same = std::ranges::all_of(faces, [&](Face f) { return f == faces[0]; });
    if (depth < (model_.csg ? deepest_split : 0) && (!same || may_miss_a_part(k, corners))) {
      return split(k, triangle, depth);
    }
    // A triangle that only touches the boundary is kept: better an edge too far than a gap.
    const auto* found = std::ranges::find_if(faces, [](Face f) { return f != Face::none; });
    if (found != faces.end()) keep(corners, *found);
  }

  void split(std::size_t k, const ParameterTriangle& t, int depth) {
    const SurfaceParameters a = between(t[1], t[2]);
    const SurfaceParameters b = between(t[2], t[0]);
    const SurfaceParameters c = between(t[0], t[1]);
    for (const ParameterTriangle& part : {ParameterTriangle{t[0], c, b}, {c, t[1], a}, {b, a, t[2]}, {a, b, c}}) {
      add(k, part, depth + 1);
    }
  }

  /// Whether another primitive is so near and so thin that it may pass between the corners.
  [[nodiscard]] bool may_miss_a_part(std::size_t k, const std::array<Eigen::Vector3d, 3>& corners) const {
    const Eigen::Vector3d middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    double size = 0.0;
    for (const Eigen::Vector3d& corner : corners) size = std::max(size, (corner - middle).norm());
    for (std::size_t other = 0; other < primitives_.size(); ++other) {
      const PlacedPrimitive& primitive = primitives_[other];
      if (other != k && size > primitive.smallest_semi_axis() &&
          (primitive.centre() - middle).norm() < primitive.radius() + size) {
        return true;
      }
    }
    return false;
  }

  /// What primitive k's surface is to the whole solid at a point: `step` leads out of the primitive.
  [[nodiscard]] Face face(std::size_t k, const Eigen::Vector3d& point, const Eigen::Vector3d& step) const {
    const bool within = solid_.contains(point - step, k, true);
    const bool beyond = solid_.contains(point + step, k, false);
    if (within == beyond) return Face::none;
    return within ? Face::outward : Face::inward;
  }

  void keep(const std::array<Eigen::Vector3d, 3>& corners, Face face) {
    std::array<std::uint32_t, 3> triangle{index_of(corners[0]), index_of(corners[1]), index_of(corners[2])};
    if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) return;
    if (face == Face::inward) std::swap(triangle[1], triangle[2]);
    mesh_.triangles.push_back(triangle);
  }

  std::uint32_t index_of(const Eigen::Vector3d& corner) {
    const Point point{corner[0], corner[1], corner[2]};
    const auto [place, added] = indices_.try_emplace(point, static_cast<std::uint32_t>(mesh_.vertices.size()));
    if (added) mesh_.vertices.push_back(point);
    return place->second;
  }

  const Model& model_;
  tessellation::Solid solid_;
  const std::vector<PlacedPrimitive>& primitives_ = solid_.primitives();
  Mesh mesh_;
  std::map<Point, std::uint32_t> indices_;
};

}  // namespace

Mesh model_surface(const Model& model) {
  return SurfaceBuilder(model).build();
}

}  // namespace verisq::report
