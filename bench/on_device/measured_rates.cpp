/// This file implements the measurements, each repeated with more queries until it takes long enough.
#include "bench/on_device/measured_rates.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <span>
#include <verisq/files.hpp>
#include <verisq/map.hpp>
#include <verisq/octree.hpp>

#include "bench/paper_tables.hpp"
#include "bench/points.hpp"
#include "bench/posed_pairs.hpp"
#include "bench/query_stream.hpp"
#include "bench/triangles.hpp"
#include "host/device/device.hpp"
#include "host/plan/pose_search.hpp"

namespace verisq::bench {
namespace {

constexpr double long_enough = 0.5;  // seconds
constexpr std::size_t different_queries = std::size_t{1} << 16U;
constexpr std::size_t most_queries = std::size_t{1} << 28U;
constexpr std::size_t queries_in_memory = std::size_t{1} << 25U;

// As the benches of these kinds ask for, in units of the object's size.
constexpr double tolerance_outside = 1e-12;
constexpr double tolerance_inside = 1e-6;
constexpr double tolerance_of_solids = 1e-4;  // of files in mm

constexpr std::size_t points_of_fit = 4096;
constexpr std::size_t candidates_of_fit = 64;
constexpr int first_octree_depth = 6;
constexpr int deepest_octree = 10;

template <class Work>
double seconds_of(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// `map(count)` maps so many queries. A first run, which does not count, has the device compile what they ask for.
template <class Map>
MeasuredRate rate_of_runs(std::string what, std::string object, std::size_t first_count, const Map& map) {
  MeasuredRate rate{std::move(what), std::move(object), 0.0, 0.0, 0.0, 0.0, 0.0};
  (void)map(first_count);
  double seconds = 0.0;
  for (std::size_t count = first_count; seconds < long_enough && count <= most_queries; count *= 2) {
    MapSummary summary;
    seconds = seconds_of([&] { summary = map(count); });
    const auto answered = static_cast<double>(summary.points);
    rate.queries = answered;
    rate.per_second = answered / seconds;
    rate.per_device_second = answered / summary.device_seconds;
    rate.verified_fraction = static_cast<double>(summary.device_verified) / answered;
    rate.largest_width = summary.largest_width;
  }
  return rate;
}

template <class Query>
MeasuredRate rate_of_map(std::string what, std::string object, Mapper<Query> mapper, std::span<const Query> queries) {
  const auto drop = [](std::span<const Query>, std::span<const MapResult>, std::span<const Certificate>) {};
  return rate_of_runs(std::move(what), std::move(object), queries.size() / 8,
                      [&](std::size_t count) { return mapper.map(repeated(queries, count), drop); });
}

// Points and rows in the caller's memory, column by column, as those of NumPy or of a file: nothing is read, converted
// or written on the way. Memory is touched before.
MeasuredRate rate_of_columns(std::string object, const Model& model, const std::string& device, double tolerance,
                             const std::vector<Point>& points) {
  std::array<std::vector<double>, 3> coordinates;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    coordinates[axis].resize(queries_in_memory);
    for (std::size_t n = 0; n < queries_in_memory; ++n) coordinates[axis][n] = points[n % points.size()][axis];
  }
  std::vector<double> los(queries_in_memory);
  std::vector<double> his(queries_in_memory);
  std::vector<Status> statuses(queries_in_memory);
  PointMapper mapper(model, {.tolerance = tolerance, .device = device});
  const auto first_of = [](auto& column, std::size_t count) { return std::span(column).first(count); };
  return rate_of_runs("points_in_memory", std::move(object), points.size(), [&](std::size_t count) {
    count = std::min(count, queries_in_memory);
    return mapper.map(
        PointColumns(first_of(coordinates[0], count), first_of(coordinates[1], count), first_of(coordinates[2], count)),
        ResultColumns(first_of(los, count), first_of(his, count), first_of(statuses, count)));
  });
}

MeasuredRate rate_of_points(std::string what, std::string object, const Model& model, const std::string& device,
                            double tolerance, const std::vector<Point>& points) {
  return rate_of_map(std::move(what), std::move(object), PointMapper(model, {.tolerance = tolerance, .device = device}),
                     std::span(points));
}

void add_objects(std::vector<MeasuredRate>& rates, const std::string& device) {
  for (const BenchmarkObject& object : table5_objects) {
    const Superquadric& solid = object.solid;
    const double size = size_of(solid);
    const std::string name(object.name);
    const Model model{"", {{"", solid, {}}}};
    rates.push_back(rate_of_points("points_outside", name, model, device, tolerance_outside * size,
                                   points_outside(solid, different_queries)));
    rates.push_back(
        rate_of_columns(name, model, device, tolerance_outside * size, points_outside(solid, different_queries)));
    rates.push_back(rate_of_points("points_inside", name, model, device, tolerance_inside * size,
                                   points_inside(solid, different_queries)));
    const std::vector<Triangle> triangles = random_triangles(solid, different_queries);
    rates.push_back(rate_of_map("triangles", name,
                                TriangleMapper(model, {.tolerance = tolerance_outside * size, .device = device}),
                                std::span(triangles)));
  }
}

void add_pairs(std::vector<MeasuredRate>& rates, const std::string& device) {
  for (const BenchmarkPair& pair : table6_pairs) {
    const std::vector<Pose> poses = separated_poses(pair.a, pair.b, different_queries);
    const double tolerance = tolerance_inside * std::max(size_of(pair.a), size_of(pair.b));
    rates.push_back(rate_of_map("pairs", std::string(pair.name),
                                PoseMapper(Model{"", {{"", pair.a, {}}}}, Model{"", {{"", pair.b, {}}}},
                                           {.tolerance = tolerance, .device = device}),
                                std::span(poses)));
  }
}

void add_examples(std::vector<MeasuredRate>& rates, const std::string& device, const std::string& examples) {
  for (const auto& [what, file] : {std::pair{"points_of_union", "stem.json"}, {"points_of_solid", "bent_stem.json"}}) {
    const Model model = read_model(examples + "/" + file);
    rates.push_back(
        rate_of_points(what, file, model, device, tolerance_of_solids, points_about(model, different_queries / 4)));
  }
}

// Of a plain superquadric, whose siblings share powers, and of a tree.
MeasuredRate rate_of_octree(std::string object, const Model& model, const std::string& device) {
  MeasuredRate rate{"octree_cubes", std::move(object), 0.0, 0.0, 0.0, 1.0, 0.0};
  for (int depth = first_octree_depth; depth <= deepest_octree; ++depth) {
    OctreeBuilder builder(model, {.depth = depth, .device = device});
    const OctreeSummary summary = builder.build();
    rate.queries = static_cast<double>(summary.coloured);
    rate.per_second = rate.queries / summary.seconds;
    rate.per_device_second = rate.queries / summary.device_seconds;
    if (summary.seconds > long_enough) break;
  }
  return rate;
}

// Signed distances with gradients of a fit, which prove nothing. The first run compiles.
MeasuredRate rate_of_fit(const Model& implant, const std::string& device) {
  MeasuredRate rate{"fit_distances", "stem.json", 0.0, 0.0, 0.0, 1.0, 0.0};
  const std::vector<Point> points = points_about(implant, points_of_fit);
  const auto evaluator = device::device_candidate_evaluator(device::select_device(device).device.value(), points,
                                                            std::vector<double>(points.size(), 1.0));
  const fit_search::Candidate candidate{implant.primitives, {}};
  std::vector<fit_search::Evaluation> evaluations;
  const auto evaluate = [&](std::size_t count) {
    const std::vector<fit_search::Candidate> candidates(count, candidate);
    evaluator->evaluate(candidates, {1.0, 0.5, {0.0, 2.0}}, {}, 1, evaluations);
  };
  evaluate(1);
  double seconds = 0.0;
  for (std::size_t count = candidates_of_fit; seconds < long_enough && count < most_queries / points_of_fit;
       count *= 2) {
    seconds = seconds_of([&] { evaluate(count); });
    rate.queries = static_cast<double>(count * points.size());
    rate.per_second = rate.per_device_second = rate.queries / seconds;
  }
  return rate;
}

}  // namespace

std::vector<MeasuredRate> measured_rates(const std::string& device, const std::string& examples) {
  std::vector<MeasuredRate> rates;
  add_objects(rates, device);
  add_pairs(rates, device);
  add_examples(rates, device, examples);
  rates.push_back(rate_of_octree("capsule", Model{"", {{"", table5_objects[0].solid, {}}}}, device));
  rates.push_back(rate_of_octree("bent_stem.json", read_model(examples + "/bent_stem.json"), device));
  rates.push_back(rate_of_fit(read_model(examples + "/stem.json"), device));
  return rates;
}

}  // namespace verisq::bench
