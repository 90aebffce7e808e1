/// Maps the vertices, then hands mesh and model to the searches of `verify/deviation`, with maps as their source of
/// distances.
#include "verisq/deviation.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <span>
#include <utility>

#include "host/deviation/allowed_width.hpp"
#include "host/deviation/deviation_check.hpp"
#include "host/deviation/mapped_distances.hpp"
#include "host/errors/refusal.hpp"
#include "host/threads/parallel.hpp"
#include "verify/deviation/farthest_patch.hpp"
#include "verify/deviation/mesh_distances.hpp"
#include "verify/deviation/model_distances.hpp"
#include "verify/deviation/proven_triangle.hpp"
#include "verify/deviation/triangle_piece.hpp"
#include "verify/deviation/triangle_tree.hpp"
#include "verify/deviation/weighted_cells.hpp"
#include "verisq/error.hpp"
#include "verisq/signed_distance.hpp"

namespace verisq {
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

  /// Where each distance is searched for, a coarse map says first how close it need be.
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
    // What an interrupted map leaves is not specified.
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

  /// Convex solids are told tightly at once; others are searched, and no closer than what is asked for needs.
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
    if (options_.from_model) {
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
  }

  void measure_model(const verify::TriangleTree& triangles, verify::DeviationSearch search) {
    search.progress = [this](double done) { options_.progress("model to mesh", done); };
    const verify::FarthestOfModel farthest = verify::farthest_of_model(model_, triangles, search);
    found_.from_model = {farthest.distance, farthest.where, {}, {}};
    found_.samples += farthest.samples;
    found_.patches = farthest.patches;
    ended_early_ = ended_early_ || farthest.ended;
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
  std::vector<Enclosure> rows_;  // of the vertices
  bool ended_early_ = false;
  Deviation found_{};
};

}  // namespace

bool to_tolerance(const Enclosure& distance, const DeviationOptions& options, double bounding_radius) {
  return distance.hi < infinity && distance.hi - distance.lo <= allowed_width(distance.hi, options, bounding_radius);
}

Deviation deviation(const Model& model, const Mesh& mesh, const DeviationOptions& options) {
  check_mesh(mesh);
  check_options(options);
  check_regions(mesh, options.region_of, options.regions);
  return DeviationRun(model, mesh, options)();
}

}  // namespace verisq
