/// This file implements the measurements, each repeated with more queries until it takes long enough.
#include "bench/on_device/measured_rates.hpp"

#include <algorithm>
#include <chrono>
#include <span>
#include <verisq/map.hpp>
#include <verisq/model_file.hpp>
#include <verisq/octree.hpp>

#include "bench/paper_tables.hpp"
#include "bench/points.hpp"
#include "bench/posed_pairs.hpp"
#include "bench/query_stream.hpp"
#include "bench/triangles.hpp"
#include "host/device/device.hpp"
#include "host/fit/pose_objective.hpp"

namespace verisq::bench {
namespace {

constexpr double long_enough = 0.5;  // seconds
constexpr std::size_t different_queries = std::size_t{1} << 16U;
constexpr std::size_t most_queries = std::size_t{1} << 28U;

// As the benches of these kinds ask for, in units of the object's size.
constexpr double tolerance_outside = 1e-12;
constexpr double tolerance_inside = 1e-6;
constexpr double tolerance_of_solids = 1e-6;

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

// The first run, which is not long enough, warms up.
template <class Query>
MeasuredRate rate_of_map(std::string what, std::string object, Mapper<Query> mapper, std::span<const Query> queries) {
  MeasuredRate rate{std::move(what), std::move(object), 0.0, 0.0, 0.0, 0.0, 0.0};
  const auto drop = [](std::span<const Query>, std::span<const MapResult>, std::span<const Certificate>) {};
  double seconds = 0.0;
  for (std::size_t count = queries.size() / 8; seconds < long_enough && count <= most_queries; count *= 2) {
    MapSummary summary;
    seconds = seconds_of([&] { summary = mapper.map(repeated(queries, count), drop); });
    const auto answered = static_cast<double>(summary.points);
    rate.queries = answered;
    rate.per_second = answered / seconds;
    rate.per_device_second = answered / summary.device_seconds;
    rate.verified_fraction = static_cast<double>(summary.device_verified) / answered;
    rate.largest_width = summary.largest_width;
  }
  return rate;
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

// Signed distances with gradients of a fit, which prove nothing.
MeasuredRate rate_of_fit(const Model& implant, const std::string& device) {
  MeasuredRate rate{"fit_distances", "stem.json", 0.0, 0.0, 0.0, 1.0, 0.0};
  const std::vector<Point> points = points_about(implant, points_of_fit);
  const auto evaluator = device::device_candidate_evaluator(device::select_device(device).device.value(), points,
                                                            std::vector<double>(points.size(), 1.0));
  const fit_search::Candidate candidate{implant.primitives, {}};
  double seconds = 0.0;
  for (std::size_t count = candidates_of_fit; seconds < long_enough && count < most_queries / points_of_fit;
       count *= 2) {
    const std::vector<fit_search::Candidate> candidates(count, candidate);
    std::vector<fit_search::Evaluation> evaluations;
    seconds = seconds_of([&] { evaluator->evaluate(candidates, {1.0, 0.5, {0.0, 2.0}}, {}, 1, evaluations); });
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
