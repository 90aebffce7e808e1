/// This file implements deviation.hpp.
#include "verisq/deviation.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <iterator>
#include <limits>
#include <memory>
#include <numeric>
#include <span>
#include <utility>

#include "host/errors/refusal.hpp"
#include "host/plan/deviation.hpp"
#include "host/threads/parallel.hpp"
#include "verify/numbers/points.hpp"
#include "verify/proof/triangle_piece.hpp"
#include "verify/proof/triangle_tree.hpp"
#include "verify/search/closed_mesh.hpp"
#include "verify/search/mesh_distances.hpp"
#include "verify/search/model_distances.hpp"
#include "verify/search/solid_pair_distance.hpp"
#include "verify/solids/model.hpp"
#include "verisq/distance.hpp"
#include "verisq/error.hpp"

namespace verisq {

void check_mesh(const Mesh& mesh) {
  if (mesh.vertices.empty()) refuse("the mesh has no vertices");
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const auto& [x, y, z] = mesh.vertices[i];
    if (std::isfinite(x) && std::isfinite(y) && std::isfinite(z)) continue;
    refuse(fmt::format("vertex {} of the mesh, ({}, {}, {}), is not finite", i, x, y, z));
  }
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
    for (const std::uint32_t corner : mesh.triangles[n]) {
      if (corner < mesh.vertices.size()) continue;
      refuse(fmt::format("triangle {} of the mesh names vertex {}, of {}", n, corner, mesh.vertices.size()));
    }
  }
}

void check_regions(const Mesh& mesh, std::span<const std::uint32_t> region_of, std::uint32_t regions) {
  if (regions == 0) return;
  if (region_of.size() != mesh.triangles.size())
    refuse(fmt::format("{} regions for {} triangles", region_of.size(), mesh.triangles.size()));
  for (const std::uint32_t region : region_of) {
    if (region >= regions) refuse(fmt::format("there is no region {} of {}", region, regions));
  }
}

namespace {

/// More than the roundings.
constexpr double share_of_roundings = 1e-9;

/// The required accuracy of a vertex's distance for all of its triangles.
struct NeededDistance {
  double farther = 0.0;      ///< it is enough to prove that the distance is more than this
  double nearer = infinity;  ///< or less than this
  double shortest_side = infinity;
  bool exactly = false;  ///< neither is enough
};

double length_between(const Point& a, const Point& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/// By the bounds of `verify::distances_on` for a piece, by its corners alone.
NeededDistance need_of(const Triangle& corners, const std::array<Enclosure, 3>& distances, double distance) {
  const verify::PieceShape shape = verify::shape_of(corners, verify::displacement(corners));
  NeededDistance need{.farther = std::hypot(distance, shape.radius) * (1.0 + share_of_roundings),
                      .nearer = (distance - shape.longest / std::sqrt(3.0)) * (1.0 - share_of_roundings)};
  const bool far = std::ranges::all_of(distances, [&](const Enclosure& d) { return d.lo > need.farther; });
  const bool near = std::ranges::all_of(distances, [&](const Enclosure& d) { return d.hi < need.nearer; });
  need.exactly = !far && !near;
  for (std::size_t i = 0; i < 3; ++i)
    need.shortest_side = std::min(need.shortest_side, length_between(corners[i], corners[(i + 1) % 3]));
  return need;
}

std::vector<NeededDistance> needs_of(const Mesh& mesh, std::span<const Enclosure> distances, double distance) {
  std::vector<NeededDistance> needs(mesh.vertices.size());
  for (const auto& triangle : mesh.triangles) {
    const auto& [a, b, c] = triangle;
    const NeededDistance need = need_of({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]},
                                        {distances[a], distances[b], distances[c]}, distance);
    for (const std::uint32_t corner : triangle) {
      NeededDistance& of = needs[corner];
      of = {std::max(of.farther, need.farther), std::min(of.nearer, need.nearer),
            std::min(of.shortest_side, need.shortest_side), of.exactly || need.exactly};
    }
  }
  return needs;
}

/// The largest distance to another vertex that this one's distance can bound.
double reach_of_teller(const Enclosure& known, double distance) {
  return std::max(known.lo - distance, distance - known.hi);
}

}  // namespace

std::vector<std::uint32_t> tellers(const Mesh& mesh, std::span<const Enclosure> rows, double distance,
                                   double tolerance) {
  std::vector<Enclosure> distances;
  distances.reserve(rows.size());
  for (const Enclosure& row : rows) distances.push_back(verify::widened(verify::magnitude(row), 2.0 * tolerance));
  const std::vector<NeededDistance> needs = needs_of(mesh, distances, distance);
  std::vector<std::uint32_t> teller(rows.size());
  std::iota(teller.begin(), teller.end(), 0U);
  std::vector<std::uint32_t> order = teller;
  std::ranges::stable_sort(order, std::greater<>(),
                           [&](std::uint32_t v) { return reach_of_teller(distances[v], distance); });
  std::vector<std::uint32_t> open;  // who may be told, and is not yet
  std::ranges::copy_if(order, std::back_inserter(open), [&](std::uint32_t v) { return !needs[v].exactly; });
  for (const std::uint32_t from : order) {
    const Enclosure& known = distances[from];
    if (teller[from] != from || !(reach_of_teller(known, distance) > needs[from].shortest_side)) continue;
    std::erase_if(open, [&](std::uint32_t v) {
      if (v == from) return true;
      const double way = length_between(mesh.vertices[from], mesh.vertices[v]) * (1.0 + share_of_roundings);
      if (!(known.lo - way > needs[v].farther) && !(known.hi + way < needs[v].nearer)) return false;
      teller[v] = from;
      return true;
    });
  }
  return teller;
}

namespace {

constexpr double coarse_share = 1e-2;  // of the bounding radius

void check_options(const DeviationOptions& options) {
  const auto positive = [](double x) { return x > 0.0 && std::isfinite(x); };
  if (!positive(options.relative_tolerance)) {
    refuse(fmt::format("the relative tolerance {} is not above 0", options.relative_tolerance));
  }
  if (options.tolerance && !positive(*options.tolerance)) {
    refuse(fmt::format("the tolerance {} is not above 0", *options.tolerance));
  }
  for (const double percent : options.percentiles) {
    if (!(percent > 0.0 && percent <= 100.0)) refuse(fmt::format("there is no percentile {}", percent));
  }
}

Enclosure larger(const Enclosure& a, const Enclosure& b) {
  return {std::max(a.lo, b.lo), std::max(a.hi, b.hi)};
}

/// How far the surface of a model that is one mesh lies from another mesh. It is searched in its own frame, so that
/// areas are those of its own triangles: the other mesh is moved there, and rounded.
class SurfaceOfMesh {
 public:
  SurfaceOfMesh(const Primitive& primitive, const Mesh& others, verify::DeviationSearch search)
      : motion_(primitive.pose),
        surface_(*primitive.mesh),
        seen_(others, primitive.pose),
        search_(std::move(search)),
        at_vertices_(surface_.vertices.size()) {
    search_.to_model = [this](std::span<const Point> points, std::span<Enclosure> rows) {
      in_parallel(points.size(), [&](std::size_t i) { rows[i] = seen_.distance(points[i]); });
      return true;
    };
    search_.to_model(surface_.vertices, at_vertices_);
    of_mesh_.emplace(surface_, at_vertices_, search_);
    of_mesh_->search_largest();
  }

  void search_statistics(std::span<const double> percentiles) { of_mesh_->search_statistics(percentiles); }

  [[nodiscard]] verify::MeshDistances found() const {
    verify::MeshDistances distances = of_mesh_->found();
    const verify::PreciseVector in_model = motion_(verify::precise(distances.where));
    for (std::size_t i = 0; i < 3; ++i) distances.where[i] = in_model[i].lower().to_double(verify::Direction::down);
    return distances;
  }

 private:
  verify::RigidMotion motion_;
  const Mesh& surface_;
  verify::SeenTriangles seen_;
  verify::DeviationSearch search_;
  std::vector<Enclosure> at_vertices_;
  std::optional<verify::MeshSearch> of_mesh_;
};

class DeviationRun {
 public:
  DeviationRun(const Model& model, const Mesh& mesh, const DeviationOptions& options)
      : model_(model), mesh_(mesh), options_(options), radius_(bounding_radius(model)) {}

  Deviation operator()() {
    options_.progress("vertices", 0.0);
    const MappedDistances to_model(model_, map_options(tolerance_of_vertices()));
    map_vertices(to_model);
    const verify::DeviationSearch search = search_by(to_model);
    measure(search);
    found_.interrupted = found_.interrupted || options_.interrupted();
    summarise();
    return std::move(found_);
  }

 private:
  [[nodiscard]] double finest() const {
    const double finest = finest_share * radius_;
    return std::isfinite(finest) ? finest : std::numeric_limits<double>::max();
  }

  [[nodiscard]] MapOptions map_options(double tolerance) const {
    return {.tolerance = tolerance,
            .device = options_.device,
            .interrupted = options_.interrupted,
            .out_of_time = options_.out_of_time};
  }

  [[nodiscard]] bool ended() const {
    return options_.interrupted() || (options_.out_of_time && options_.out_of_time());
  }

  /// If each distance is searched for, a coarse map first determines the required accuracy.
  [[nodiscard]] double tolerance_of_vertices() const {
    if (is_union_of_convex(model_)) return finest();
    const double coarse = std::min(coarse_share * radius_, std::numeric_limits<double>::max());
    std::vector<Enclosure> rows(mesh_.vertices.size(), {0.0, 0.0});
    const MapSummary summary = MappedDistances(model_, map_options(coarse)).map(mesh_.vertices, rows);
    double largest = 0.0;
    for (std::size_t i = 0; i < summary.points; ++i) largest = std::max(largest, verify::magnitude(rows[i]).lo);
    return std::clamp(share_of_samples * allowed_width(largest, options_, radius_), finest(), coarse);
  }

  void map_vertices(const MappedDistances& to_model) {
    rows_.assign(mesh_.vertices.size(), {-infinity, infinity});
    std::vector<Status> status(rows_.size(), Status::wide);
    found_.map = to_model.map(mesh_.vertices, rows_, status);
    // The rows that an interrupted map leaves are unspecified.
    for (std::size_t i = found_.map.points; i < rows_.size(); ++i) rows_[i] = {-infinity, infinity};
    std::vector<verify::WeightedCell> cells;
    DistanceStatistics& statistics = found_.of_vertices;
    statistics.largest = {0.0, 0.0};
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      found_.vertices.push_back({rows_[i], status[i]});
      const Enclosure distance = verify::magnitude(rows_[i]);
      if (distance.lo > statistics.largest.lo || i == 0) statistics.farthest = mesh_.vertices[i];
      statistics.largest = larger(statistics.largest, distance);
      cells.push_back({{1.0, 1.0}, distance, distance});
    }
    statistics.mean = verify::mean_of(cells);
    const verify::Distribution distribution(cells);
    for (const double percent : options_.percentiles) {
      statistics.percentiles.push_back(distribution.percentile(percent));
    }
  }

  /// Convex solids give tight distances at once; for others distances are searched, no closer than the request needs.
  [[nodiscard]] verify::DeviationSearch search_by(const MappedDistances& to_model) const {
    verify::DeviationSearch search{.to_model = to_model,
                                   .convex = verify::is_one_convex_primitive(model_),
                                   .allowed = [this](double size) { return allowed_width(size, options_, radius_); },
                                   .in_parallel = in_parallel<std::function<void(std::size_t)>>,
                                   .ended = [this] { return ended(); },
                                   .progress = {},
                                   .most_samples = options_.most_samples};
    const double tolerance =
        std::max(finest(), share_of_samples * allowed_width(found_.of_vertices.largest.lo, options_, radius_));
    if (!search.convex && tolerance > finest()) search.to_model = MappedDistances(model_, map_options(tolerance));
    if (model_.primitives.size() == 1 && !model_.csg) return search;
    for (const Primitive& primitive : model_.primitives) {
      search.to_each_primitive.emplace_back(
          MappedDistances({model_.units, {primitive}, {}}, map_options(is_bent(primitive) ? tolerance : finest())));
    }
    if (is_union_of_convex(model_)) search.to_primitives = search.to_each_primitive;
    return search;
  }

  /// The largest distances first: a limit may come before the rest.
  void measure(const verify::DeviationSearch& search) {
    verify::DeviationSearch to_model = search;
    to_model.progress = [this](double done) { options_.progress("mesh to model", done); };
    std::optional<verify::MeshSearch> of_mesh;
    if (!mesh_.triangles.empty()) {
      of_mesh.emplace(mesh_, rows_, to_model, verify::MeshRegions{options_.region_of, options_.regions});
      of_mesh->search_largest();
    }
    std::optional<verify::TriangleTree> triangles;
    if (options_.from_model && has_mesh(model_)) {
      measure_surface(search);
    } else if (options_.from_model) {
      triangles.emplace(verify::triangles_of(mesh_));
      measure_model(*triangles, search);
    }
    if (of_mesh) {
      if (options_.statistics_of_surface) of_mesh->search_statistics(options_.percentiles);
      const verify::MeshDistances distances = of_mesh->found();
      found_.from_mesh = {distances.largest, distances.where, distances.mean, distances.percentiles};
      if (options_.regions > 0) {
        for (const verify::MeshDistances& region : of_mesh->found_by_region())
          found_.by_region.push_back({region.largest, region.where, region.mean, {}});
      }
      found_.samples += distances.samples;
      ended_early_ = ended_early_ || distances.ended;
    }
    if (triangles && options_.statistics_of_model) measure_statistics_of_model(*triangles, search);
    if (surface_ && options_.statistics_of_model) surface_->search_statistics(options_.percentiles);
    if (surface_) take_surface();
  }

  void measure_model(const verify::TriangleTree& triangles, verify::DeviationSearch search) {
    search.progress = [this](double done) { options_.progress("model to mesh", done); };
    const verify::FarthestOfModel farthest = verify::farthest_of_model(model_, triangles, search);
    found_.from_model = {farthest.distance, farthest.where, {}, {}};
    found_.samples += farthest.samples;
    found_.patches = farthest.patches;
    ended_early_ = ended_early_ || farthest.ended;
  }

  void measure_surface(verify::DeviationSearch search) {
    search.progress = [this](double done) { options_.progress("model to mesh", done); };
    surface_ = std::make_unique<SurfaceOfMesh>(model_.primitives.front(), mesh_, std::move(search));
  }

  void take_surface() {
    const verify::MeshDistances distances = surface_->found();
    found_.from_model = {distances.largest, distances.where, distances.mean, distances.percentiles};
    found_.samples += distances.samples;
    ended_early_ = ended_early_ || distances.ended;
  }

  void measure_statistics_of_model(const verify::TriangleTree& triangles, verify::DeviationSearch search) {
    search.progress = [this](double done) { options_.progress("model to mesh, mean", done); };
    const verify::ModelDistances distances =
        verify::distances_of_model(model_, triangles, options_.percentiles, found_.from_model->largest.hi, search);
    found_.from_model->mean = distances.mean;
    found_.from_model->percentiles = distances.percentiles;
    found_.samples += distances.samples;
    found_.patches += distances.patches;
    ended_early_ = ended_early_ || distances.ended;
  }

  [[nodiscard]] bool narrow(const DistanceStatistics& statistics) const {
    const auto narrow_one = [&](const Enclosure& e) { return to_tolerance(e, options_, radius_); };
    return narrow_one(statistics.largest) && (!statistics.mean || narrow_one(*statistics.mean)) &&
           std::ranges::all_of(statistics.percentiles, narrow_one);
  }

  void summarise() {
    const Enclosure& from_mesh = found_.from_mesh ? found_.from_mesh->largest : found_.of_vertices.largest;
    if (found_.from_model) found_.hausdorff = larger(from_mesh, found_.from_model->largest);
    found_.to_tolerance = std::ranges::all_of(found_.by_region, [&](const DistanceStatistics& region) {
      return to_tolerance(region.largest, options_, radius_);
    });
    found_.to_tolerance = found_.to_tolerance && narrow(found_.of_vertices) &&
                          (!found_.from_mesh || narrow(*found_.from_mesh)) &&
                          (!found_.from_model || narrow(*found_.from_model));
    found_.out_of_time = !found_.interrupted && !found_.to_tolerance && (ended_early_ || found_.map.out_of_time);
  }

  const Model& model_;
  const Mesh& mesh_;
  const DeviationOptions& options_;
  double radius_;
  std::vector<Enclosure> rows_;             // of the vertices
  std::unique_ptr<SurfaceOfMesh> surface_;  ///< where the model is a mesh
  bool ended_early_ = false;
  Deviation found_{};
};

/// Superquadrics of any kind, or one mesh.
void check_model(const Model& model) {
  verify::require_valid_with_meshes(model);
  if (has_mesh(model) && (model.primitives.size() > 1 || model.csg))
    refuse("a mesh among several primitives: so far the deviation is enclosed from superquadrics, or from one mesh");
}

/// Nothing if scaling is not exact.
std::optional<Mesh> in_units(const Mesh& mesh, double unit) {
  Mesh scaled{{}, mesh.triangles};
  for (const Point& vertex : mesh.vertices) {
    const std::optional<Point> in_unit = verify::in_units(vertex, unit);
    if (!in_unit) return std::nullopt;
    scaled.vertices.push_back(*in_unit);
  }
  return scaled;
}

DistanceStatistics in_lengths(DistanceStatistics found, double unit) {
  found.largest = verify::in_lengths(found.largest, unit);
  for (double& coordinate : found.farthest) coordinate *= unit;
  if (found.mean) found.mean = verify::in_lengths(*found.mean, unit);
  for (Enclosure& percentile : found.percentiles) percentile = verify::in_lengths(percentile, unit);
  return found;
}

Deviation in_lengths(Deviation found, double unit) {
  for (MapResult& row : found.vertices) row.distance = verify::in_lengths(row.distance, unit);
  const Enclosure smallest = verify::in_lengths({found.map.minimum_lo, found.map.minimum_hi}, unit);
  found.map.minimum_lo = smallest.lo;
  found.map.minimum_hi = smallest.hi;
  found.map.largest_width = verify::in_lengths({0.0, found.map.largest_width}, unit).hi;
  found.of_vertices = in_lengths(std::move(found.of_vertices), unit);
  if (found.from_mesh) found.from_mesh = in_lengths(*std::move(found.from_mesh), unit);
  if (found.from_model) found.from_model = in_lengths(*std::move(found.from_model), unit);
  for (DistanceStatistics& region : found.by_region) region = in_lengths(std::move(region), unit);
  if (found.hausdorff) found.hausdorff = verify::in_lengths(*found.hausdorff, unit);
  return found;
}

}  // namespace

bool to_tolerance(const Enclosure& distance, const DeviationOptions& options, double bounding_radius) {
  return distance.hi < infinity && distance.hi - distance.lo <= allowed_width(distance.hi, options, bounding_radius);
}

Deviation deviation(const Model& model, const Mesh& mesh, const DeviationOptions& options) {
  check_model(model);
  check_mesh(mesh);
  check_options(options);
  check_regions(mesh, options.region_of, options.regions);
  const double unit = verify::unit_of(model, model, verify::largest_coordinate(mesh.vertices));
  const std::optional<Mesh> scaled = unit == 1.0 ? std::nullopt : in_units(mesh, unit);
  if (!scaled) return DeviationRun(model, mesh, options)();
  DeviationOptions scaled_options = options;
  if (options.tolerance) scaled_options.tolerance = verify::tolerance_in_units(*options.tolerance, unit);
  return in_lengths(DeviationRun(verify::in_units(model, unit), *scaled, scaled_options)(), unit);
}

namespace {

void check_options(const Model& model, const ContactAreaOptions& options) {
  if (!(options.distance >= 0.0 && std::isfinite(options.distance)))
    refuse(fmt::format("the distance {} is not 0 or more", options.distance));
  if (!(options.share_width > 0.0)) refuse(fmt::format("the width {} is not above 0", options.share_width));
  if (!options.counted.empty() && options.counted.size() != model.primitives.size())
    refuse(fmt::format("{} primitives count or do not, of {}", options.counted.size(), model.primitives.size()));
  if (options.of_model && has_mesh(model))
    refuse("`of_model`: is known of superquadrics alone, and the model has a mesh");
}

verify::DeviationSearch search_of(const Model& model, const MappedDistances& to_model,
                                  const ContactAreaOptions& options) {
  verify::DeviationSearch search{.to_model = to_model,
                                 .convex = model.primitives.size() == 1 && is_union_of_convex(model),
                                 .allowed = [](double) { return 0.0; },  // shares have a width of their own
                                 .in_parallel = in_parallel<std::function<void(std::size_t)>>,
                                 .ended = options.interrupted,
                                 .progress = [](double) {},
                                 .most_samples = options.most_samples};
  if (model.primitives.size() == 1 && !model.csg) return search;
  const MapOptions of_primitives{
      .tolerance = contact_tolerance(model), .device = options.device, .interrupted = options.interrupted};
  for (const Primitive& primitive : model.primitives)
    search.to_each_primitive.emplace_back(MappedDistances({model.units, {primitive}, {}}, of_primitives));
  if (is_union_of_convex(model)) search.to_primitives = search.to_each_primitive;
  return search;
}

}  // namespace

ContactAreas contact_areas(const Model& model, const Mesh& mesh, const ContactAreaOptions& options) {
  verify::require_valid_with_meshes(model);
  check_mesh(mesh);
  if (mesh.triangles.empty()) refuse("the mesh has no triangles");
  check_regions(mesh, options.region_of, options.regions);
  check_options(model, options);
  const MappedDistances to_model(
      model, {.tolerance = contact_tolerance(model), .device = options.device, .interrupted = options.interrupted});
  std::vector<Enclosure> at_vertices(mesh.vertices.size(), {-infinity, infinity});
  // The rows that an interrupted map leaves are unspecified.
  if (!to_model(mesh.vertices, at_vertices)) at_vertices.assign(mesh.vertices.size(), {-infinity, infinity});
  const verify::DeviationSearch search = search_of(model, to_model, options);
  verify::MeshSearch of_mesh(mesh, at_vertices, search, {options.region_of, options.regions});
  of_mesh.search_within(options.distance, options.share_width);
  ContactAreas found{.of_mesh = of_mesh.within(options.distance), .by_region = {}, .of_model = {}};
  found.samples = mesh.vertices.size() + of_mesh.found().samples;
  if (options.regions > 0) found.by_region = of_mesh.within_by_region(options.distance);
  if (options.of_model) {
    const verify::ModelWithin of_model =
        verify::model_within(model, verify::TriangleTree(verify::triangles_of(mesh)), options.counted, options.distance,
                             options.share_width, search);
    found.of_model = of_model.within;
    found.samples += of_model.samples;
  }
  found.interrupted = options.interrupted();
  return found;
}

}  // namespace verisq
