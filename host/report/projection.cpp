/// This file implements projection.hpp.
#include "host/report/projection.hpp"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "host/prepare/eigen_points.hpp"
#include "host/prepare/mesh_geometry.hpp"
#include "host/prepare/solid.hpp"
#include "verify/numbers/points.hpp"
#include "verify/search/closed_mesh.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::report {
namespace {

/// `v` or -v, so that its largest coordinate is positive: the same view whatever the sign that the solver gave.
Eigen::Vector3d with_positive_side(const Eigen::Vector3d& v) {
  Eigen::Index largest = 0;
  v.cwiseAbs().maxCoeff(&largest);
  return v[largest] < 0.0 ? Eigen::Vector3d(-v) : v;
}

std::vector<Eigen::Vector3d> seen(const View& view, const Mesh& mesh) {
  std::vector<Eigen::Vector3d> vertices(mesh.vertices.size());
  std::ranges::transform(mesh.vertices, vertices.begin(), view);
  return vertices;
}

/// Columns by rising eigenvalue.
Eigen::Matrix3d principal_axes(const Eigen::Matrix3d& covariance) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors();
}

View unturned(const Mesh& bone, const Mesh& implant) {
  std::vector<Point> all = bone.vertices;
  all.insert(all.end(), implant.vertices.begin(), implant.vertices.end());
  const Extent extent = extent_of(all);
  const double half_size = extent.half_size();
  return {Eigen::Matrix3d::Identity(), extent.centre(), half_size > 0.0 ? half_size : 1.0};
}

/// The centroid of the triangles' area; of the vertices, if there is none.
Eigen::Vector3d surface_centroid(const std::vector<Eigen::Vector3d>& vertices, const Mesh& mesh) {
  return surface_moments(vertices, mesh).mean();
}

}  // namespace

Eigen::Vector3d upright(const Mesh& bone, const Mesh& implant, const std::optional<Point>& asked) {
  if (asked) return vector_of(verify::near_one(*asked)).stableNormalized();
  const View view = unturned(bone, implant);
  const std::vector<Eigen::Vector3d> vertices = seen(view, bone);
  // Eigenvalues rise: the last axis is the longest.
  const Eigen::Vector3d up = with_positive_side(principal_axes(surface_moments(vertices, bone).covariance()).col(2));
  double lowest = 0.0;
  double highest = 0.0;
  for (const Eigen::Vector3d& vertex : vertices) {
    lowest = std::min(lowest, up.dot(vertex));
    highest = std::max(highest, up.dot(vertex));
  }
  const double implant_height = up.dot(surface_centroid(seen(view, implant), implant));
  return implant_height < lowest + (highest - lowest) / 3.0 ? Eigen::Vector3d(-up) : up;
}

View broad_view(const Mesh& bone, const Mesh& implant, const Eigen::Vector3d& up) {
  View view = unturned(bone, implant);
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - up * up.transpose();
  const Eigen::Matrix3d covariance = surface_moments(seen(view, bone), bone).covariance();
  // Upright itself has the eigenvalue 0 and comes first; across the second axis the bone is thinnest. If it is as thin
  // along all of them, the solver's axes may lean, hence the two cross products.
  const Eigen::Vector3d thinnest = with_positive_side(principal_axes(across * covariance * across).col(1));
  const Eigen::Vector3d right = up.cross(thinnest).norm() > 0.5 ? Eigen::Vector3d(up.cross(thinnest).normalized())
                                                                : Eigen::Vector3d(up.unitOrthogonal());
  view.axes << right.transpose(), up.transpose(), right.cross(up).transpose();
  return view;
}

namespace {

double cross(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double x, double y) {
  return (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
}

}  // namespace

void DepthBuffer::draw(const ProjectedSurface& surface, double nearest) {
  for (const auto& triangle : surface.triangles) draw(surface, triangle, nearest);
}

void DepthBuffer::draw(const ProjectedSurface& surface, const std::array<std::uint32_t, 3>& triangle, double nearest) {
  const auto [i, j, k] = triangle;
  const Eigen::Vector3d& a = surface.vertices[i];
  const Eigen::Vector3d& b = surface.vertices[j];
  const Eigen::Vector3d& c = surface.vertices[k];
  const double area = cross(a, b, c[0], c[1]);  // of either sign: both sides are seen
  if (!std::isnormal(area)) return;             // seen edge-on; or corners beyond the range of numbers
  const auto [lowest_y, highest_y] = std::minmax({a[1], b[1], c[1]});
  const int first_row = static_cast<int>(std::max<double>(top_, std::floor(lowest_y)));
  const int last_row = static_cast<int>(std::min<double>(top_ + height_ - 1, std::floor(highest_y)));
  if (first_row > last_row) return;
  const auto [lowest_x, highest_x] = std::minmax({a[0], b[0], c[0]});
  const int first_column = static_cast<int>(std::max(0.0, std::floor(lowest_x)));
  const int last_column = static_cast<int>(std::min<double>(width_ - 1, std::floor(highest_x)));

  const auto mean = [](const Eigen::Vector3d& weights, double at_a, double at_b, double at_c) {
    return static_cast<float>(weights[0] * at_a + weights[1] * at_b + weights[2] * at_c);
  };
  for (int row = first_row; row <= last_row; ++row) {
    for (int column = first_column; column <= last_column; ++column) {
      const double x = column + 0.5;
      const double y = row + 0.5;
      const Eigen::Vector3d weights(cross(b, c, x, y) / area, cross(c, a, x, y) / area, cross(a, b, x, y) / area);
      // Edges belong to both triangles: no gaps, and the depth decides.
      if (weights.minCoeff() < 0.0) continue;
      const float depth = mean(weights, a[2], b[2], c[2]);
      Sample& sample = samples_[index(column, row)];
      if (depth > nearest || depth <= sample.depth) continue;
      sample = {depth, mean(weights, surface.facing[i], surface.facing[j], surface.facing[k]),
                surface.values.empty() ? 0.0F : mean(weights, surface.values[i], surface.values[j], surface.values[k])};
    }
  }
}

namespace {

/// Cosines of the vertices' normals with the line of sight. A normal is the sum of the normals of the triangles around,
/// each as long as its area.
std::vector<float> facing(const std::vector<Eigen::Vector3d>& vertices,
                          const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  std::vector<Eigen::Vector3d> normals(vertices.size(), Eigen::Vector3d::Zero());
  for (const auto& [i, j, k] : triangles) {
    const Eigen::Vector3d normal = (vertices[j] - vertices[i]).cross(vertices[k] - vertices[i]);
    for (const std::uint32_t corner : {i, j, k}) normals[corner] += normal;
  }
  std::vector<float> cosines(normals.size());
  std::ranges::transform(normals, cosines.begin(), [](const Eigen::Vector3d& normal) {
    return static_cast<float>(normal.stableNormalized()[2]);
  });
  return cosines;
}

}  // namespace

RasterTransform fitted(const View& view, const Mesh& bone, const Mesh& implant, double width, double height,
                       double margin) {
  Eigen::Array2d lower(infinity, infinity);
  Eigen::Array2d upper(-infinity, -infinity);
  for (const Mesh* mesh : {&bone, &implant}) {
    for (const Point& vertex : mesh->vertices) {
      const Eigen::Array2d place = view(vertex).head<2>().array();
      lower = lower.min(place);
      upper = upper.max(place);
    }
  }
  if (!(lower <= upper).all()) lower = upper = Eigen::Array2d::Zero();  // nothing to see
  const Eigen::Array2d room = (Eigen::Array2d(width, height) - 2.0 * margin).max(1.0);
  const Eigen::Array2d size = (upper - lower).max(std::numeric_limits<double>::min());
  const double scale = std::min((room / size).minCoeff(), room.maxCoeff());  // a single point stays one
  const Eigen::Array2d middle = (lower + upper) / 2.0;
  return {scale, middle[0] - width / 2.0 / scale, middle[1] + height / 2.0 / scale};
}

ProjectedSurface projected(const Mesh& mesh, std::vector<float> values, const View& view,
                           const RasterTransform& raster) {
  std::vector<Eigen::Vector3d> vertices(mesh.vertices.size());
  std::ranges::transform(mesh.vertices, vertices.begin(), view);
  std::vector<float> cosines = facing(vertices, mesh.triangles);
  for (Eigen::Vector3d& v : vertices) {
    v = raster.scale * Eigen::Vector3d(v[0] - raster.left, raster.top - v[1], v[2]);
  }
  return {std::move(vertices), std::move(cosines), std::move(values), mesh.triangles};
}

namespace {

constexpr int band_height = 64;  // pixels: the memory for samples does not grow with the picture's height

const Colour white(1.0, 1.0, 1.0);
const Colour metal(0.78, 0.79, 0.81);
const Colour metal_outline(0.13, 0.14, 0.17);

Colour mixed(const Colour& a, const Colour& b, double part_of_b) {
  return (1.0 - part_of_b) * a + part_of_b * b;
}

/// Darker where the surface turns away, which draws its outline, too.
double lit(double facing) {
  return 0.42 + 0.58 * std::pow(std::abs(facing), 0.8);
}

Colour bone_colour(const Sample& bone, const ColourScale& scale) {
  return lit(bone.facing) * scale.colour(bone.value * scale.range());
}

Colour metal_colour(const Sample& implant) {
  const double facing = std::abs(implant.facing);
  const double gleam = 0.25 * std::pow(facing, 30.0);
  return mixed((0.25 + 0.75 * facing) * metal, white, gleam);
}

/// A dark outline and a hint of the implant's form: the values on the bone stay legible.
Colour through_bone(const Colour& bone, const Sample& implant) {
  const double grazing = 1.0 - std::abs(implant.facing);
  return mixed(bone, metal_outline, 0.12 + 0.55 * grazing * grazing);
}

Colour seen(const Sample& bone, const Sample& implant, const ColourScale& scale) {
  if (implant.covered() && implant.depth >= bone.depth) return metal_colour(implant);
  if (!bone.covered()) return white;
  const Colour colour = bone_colour(bone, scale);
  return implant.covered() ? through_bone(colour, implant) : colour;
}

/// The range from the farthest to the nearest point, in the coordinates of the scene.
struct Depths {
  double farthest = infinity;
  double nearest = -infinity;

  [[nodiscard]] double at(double share) const { return farthest + share * (nearest - farthest); }
};

Depths depths_of(const ProjectedSurface& surface) {
  Depths depths;
  for (const Eigen::Vector3d& vertex : surface.vertices) {
    depths.nearest = std::max(depths.nearest, vertex[2]);
    depths.farthest = std::min(depths.farthest, vertex[2]);
  }
  return depths;
}

/// Through the middle of the implant, or as near to it as there is bone on both sides: a cut that shows none tells
/// nothing.
double depth_of_cut(const Scene& scene) {
  const Depths bone = depths_of(scene.bone);
  return std::clamp(depths_of(scene.implant).at(0.5), bone.at(0.25), bone.at(0.75));
}

}  // namespace

void draw_panel(const Scene& scene, BoneShown shown, const ColourScale& scale, int width, int height,
                const RowSink& sink) {
  constexpr int side = samples_a_pixel_side;
  const bool cuts_open = shown == BoneShown::cut && !scene.implant.vertices.empty() && !scene.bone.vertices.empty();
  const double nearest = cuts_open ? depth_of_cut(scene) : infinity;
  std::vector<Colour> colours(static_cast<std::size_t>(width));
  for (int top = 0; top < height; top += band_height) {
    const int rows = std::min(band_height, height - top);
    DepthBuffer bone(side * width, side * top, side * rows);
    DepthBuffer implant(side * width, side * top, side * rows);
    bone.draw(scene.bone, nearest);
    implant.draw(scene.implant);
    for (int row = top; row < top + rows; ++row) {
      for (int column = 0; column < width; ++column) {
        Colour sum = Colour::Zero();
        for (int k = 0; k < side * side; ++k) {
          const int x = side * column + k % side;
          const int y = side * row + k / side;
          sum += seen(bone.at(x, y), implant.at(x, y), scale);
        }
        colours[static_cast<std::size_t>(column)] = sum / (side * side);
      }
      sink(row, colours);
    }
  }
}

namespace {

using std::numbers::pi;
using tessellation::PlacedPrimitive;
using tessellation::SurfaceParameters;

constexpr int steps_a_quarter = 12;
/// In quarter turns: a direction nearer than this to its neighbour adds triangles without a visible effect.
constexpr double closest = 0.1 / steps_a_quarter;
/// For the triangles where cuts pass: 2^4 times finer than the grid.
constexpr int deepest_split = 4;

enum class Face { none, outward, inward };  // inward: the primitive is cut away there

using ParameterTriangle = std::array<SurfaceParameters, 3>;

SurfaceParameters between(const SurfaceParameters& a, const SurfaceParameters& b) {
  return {(a.longitude + b.longitude) / 2.0, (a.latitude + b.latitude) / 2.0};
}

/// Directions from one axis to the next, in quarter turns. They are evenly spread for the flat parts; and those of the
/// curve's usual form (cos^e, sin^e) crowd wherever the exponent makes it turn.
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

/// The directions from `first` to `last` quarter turns, both included.
std::vector<double> grid_of_quarters(int first, int last, double exponent) {
  const std::vector<double> quarter = quarter_grid(exponent);
  std::vector<double> grid;
  for (int q = first; q < last; ++q) {
    for (const double t : quarter) grid.push_back(q + t);
  }
  grid.push_back(last);
  return grid;
}

/// For a tapered primitive also directions evenly spread about the end which the taper stretches: the taper takes the
/// point (c, s) of the unit circle to the height of this direction.
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

  /// Returns whether another primitive is so near and so thin that it may pass between the corners.
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

  /// The role of primitive k's surface in the whole solid at a point: `step` leads out of the primitive.
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

/// Meshes are drawn whole, whatever lies in other primitives.
Mesh model_surface(const Model& model) {
  if (!has_mesh(model)) return SurfaceBuilder(model).build();
  Model superquadrics{model.units, {}, {}};
  std::ranges::copy_if(model.primitives, std::back_inserter(superquadrics.primitives),
                       [](const Primitive& primitive) { return primitive.mesh == nullptr; });
  Mesh surface;
  if (!superquadrics.primitives.empty()) surface = SurfaceBuilder(superquadrics).build();
  for (const Primitive& primitive : model.primitives)
    if (primitive.mesh) append(surface, verify::placed(primitive).mesh);
  return surface;
}

}  // namespace verisq::report
