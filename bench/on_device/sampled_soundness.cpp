/// This file implements the samples: the same at every run.
#include "bench/on_device/sampled_soundness.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <verisq/files.hpp>
#include <verisq/map.hpp>
#include <verisq/octree.hpp>

#include "bench/paper_tables.hpp"
#include "bench/posed_pairs.hpp"
#include "bench/query_stream.hpp"
#include "bench/triangles.hpp"
#include "tests/oracle/containment.hpp"
#include "tests/oracle/random_cases.hpp"

namespace verisq::bench {
namespace {

constexpr std::uint64_t random_solids = 40;
constexpr std::size_t points_of_solid = 100;
constexpr std::size_t queries_of_object = 100;
constexpr std::size_t points_of_bent_stem = 400;
constexpr double solid_tolerance = 1e-4;  // of the coordinates of the bent stem
constexpr int octree_depth = 6;

bool disjoint(const Enclosure& a, const Enclosure& b) {
  return a.lo > b.hi || b.lo > a.hi;
}

std::size_t by_device(std::span<const MapResult> rows) {
  return static_cast<std::size_t>(std::ranges::count(rows, Status::device_verified, &MapResult::status));
}

SoundnessSample sampled_points(const std::string& device) {
  SoundnessSample sample{"points", "MPFR at 200 bits", 0, 0, {}};
  for (std::uint64_t index = 0; index < random_solids; ++index) {
    oracle::RandomCases random(index);
    const Primitive primitive = random.solid();
    std::vector<Point> points(points_of_solid);
    for (Point& point : points) point = random.point(primitive).point;
    PointMapper mapper(Model{"", {primitive}}, {.tolerance = 0.0, .device = device});
    const std::vector<MapResult> rows = rows_of(mapper, points);
    const oracle::PosedSolid solid(primitive.superquadric, primitive.pose);
    sample.cases += rows.size();
    sample.by_device += by_device(rows);
    for (std::size_t n = 0; n < rows.size(); ++n)
      if (auto line = oracle::escape(rows[n].distance, primitive, points[n], solid.signed_distance(points[n])))
        sample.wrong.push_back(std::move(*line));
  }
  return sample;
}

// Both contain the exact distance, or one is wrong.
template <class Query, class MakeMapper>
void compare_with_host(SoundnessSample& sample, std::span<const Query> queries, const std::string& device,
                       const MakeMapper& mapper_on) {
  auto own = mapper_on(device);
  auto hosts = mapper_on(std::string("host"));
  const std::vector<MapResult> rows = rows_of(own, queries);
  const std::vector<MapResult> expected = rows_of(hosts, queries);
  sample.cases += rows.size();
  sample.by_device += by_device(rows);
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const Enclosure& e = rows[n].distance;
    const Enclosure& host = expected[n].distance;
    if (disjoint(e, host))
      sample.wrong.push_back(
          fmt::format("{} {}: [{}, {}], of the host [{}, {}]", sample.queries, n, e.lo, e.hi, host.lo, host.hi));
  }
}

SoundnessSample sampled_triangles(const std::string& device) {
  SoundnessSample sample{"triangles", "host", 0, 0, {}};
  for (const BenchmarkObject& object : table5_objects) {
    const std::vector<Triangle> triangles = random_triangles(object.solid, queries_of_object);
    const Model model{"", {{"", object.solid, {}}}};
    compare_with_host(sample, std::span(triangles), device, [&](const std::string& name) {
      return TriangleMapper(model, {.tolerance = 0.0, .device = name});
    });
  }
  return sample;
}

SoundnessSample sampled_pairs(const std::string& device) {
  SoundnessSample sample{"pairs", "host", 0, 0, {}};
  for (const BenchmarkPair& pair : table6_pairs) {
    const std::vector<Pose> poses = separated_poses(pair.a, pair.b, queries_of_object);
    const Model a{"", {{"", pair.a, {}}}};
    const Model b{"", {{"", pair.b, {}}}};
    compare_with_host(sample, std::span(poses), device,
                      [&](const std::string& name) { return PoseMapper(a, b, {.tolerance = 0.0, .device = name}); });
  }
  return sample;
}

SoundnessSample sampled_solids(const std::string& device, const Model& model) {
  SoundnessSample sample{"solids", "host", 0, 0, {}};
  const std::vector<Point> points = points_about(model, points_of_bent_stem);
  compare_with_host(sample, std::span(points), device, [&](const std::string& name) {
    return PointMapper(model, {.tolerance = solid_tolerance, .device = name});
  });
  return sample;
}

SoundnessSample sampled_octree(const std::string& device, const Model& model) {
  SoundnessSample sample{"octree", "host", 0, 0, {}};
  const auto volume = [&](const std::string& name) {
    const OctreeSummary summary = OctreeBuilder(model, {.depth = octree_depth, .device = name}).build();
    sample.cases = summary.coloured;
    return summary.volume;
  };
  const Enclosure host = volume("host");
  const Enclosure own = volume(device);
  sample.by_device = sample.cases;
  if (disjoint(own, host))
    sample.wrong.push_back(fmt::format("volume [{}, {}], of the host [{}, {}]", own.lo, own.hi, host.lo, host.hi));
  return sample;
}

}  // namespace

std::vector<SoundnessSample> sampled_soundness(const std::string& device, const std::string& bent_stem) {
  const Model solid = read_model(bent_stem);
  return {sampled_points(device), sampled_triangles(device), sampled_pairs(device), sampled_solids(device, solid),
          sampled_octree(device, solid)};
}

}  // namespace verisq::bench
