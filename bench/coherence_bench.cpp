/// How much faster are distances along a path, where what was proven in one pose serves the next?
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string_view>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/files.hpp>
#include <verisq/insertion.hpp>
#include <verisq/map.hpp>

#include "bench/approximate_motion.hpp"
#include "bench/benchmark_rows.hpp"
#include "bench/row_counters.hpp"
#include "tests/fixtures/offset_cavity.hpp"

namespace verisq::bench {
namespace {

constexpr int repetitions = 3;
constexpr std::size_t pose_count = 10000;
constexpr std::size_t points_a_primitive = 400;
constexpr double gap = 0.5;         // mm: of the cavity's points
constexpr double way_length = 100;  // mm
constexpr double tolerance = 0.1;   // mm

/// Around A on a circle that rises and shrinks, while B turns about its own axis.
std::vector<Pose> circling() {
  std::vector<Pose> poses(pose_count);
  for (std::size_t k = 0; k < pose_count; ++k) {
    const double time = static_cast<double>(k) / static_cast<double>(pose_count - 1);
    const double angle = 6.0 * time;
    const double radius = 60.0 - 30.0 * time;
    poses[k] = {{radius * std::cos(angle), radius * std::sin(angle), 80.0 * time - 40.0},
                {std::cos(angle), 0.0, 0.2 * std::sin(angle), std::sin(angle)}};
  }
  return poses;
}

std::vector<Pose> shuffled(std::vector<Pose> poses) {
  std::shuffle(poses.begin(), poses.end(), std::mt19937_64(5));
  return poses;
}

struct Scene {
  Model a = read_model(VERISQ_STEM);
  Model b = read_model(VERISQ_TAPERED_STEM);
  PairDistance distance{a, b};
  std::vector<Pose> path = circling();
  std::vector<Pose> out_of_order = shuffled(path);
  std::vector<Point> bone = testing::offset_cavity(a, gap, points_a_primitive).points;
  std::vector<Pose> way = straight_path({{}, {1.0, 0.0, 0.0, 0.0}}, {0.0, 0.0, -1.0}, way_length, pose_count);
};

std::vector<Enclosure> independent(const Scene& scene, const std::vector<Pose>& poses) {
  std::vector<Enclosure> answers;
  for (const Pose& pose : poses) answers.push_back(scene.distance(pose).distance);
  return answers;
}

std::vector<Enclosure> remembered(const Scene& scene, const std::vector<Pose>& poses) {
  std::vector<Enclosure> answers;
  PairDistance::Memory memory;
  for (const Pose& pose : poses) answers.push_back(scene.distance(pose, memory).distance);
  return answers;
}

void add_pairs_row(const Scene& scene, std::string_view what, std::string_view order, const std::vector<Pose>& poses,
                   std::vector<Enclosure> (*solve)(const Scene&, const std::vector<Pose>&)) {
  add_row("verisq_host", what, order, [&scene, &poses, solve](benchmark::State& state) {
    std::vector<Enclosure> answers;
    for (auto _ : state) answers = solve(scene, poses);
    set_rate(state, "poses_per_second", poses.size());
    if (answers != independent(scene, poses)) state.SkipWithError("not the independent poses' answers");
  });
}

std::vector<Point> seen_from(const Pose& pose, const std::vector<Point>& points) {
  const ApproximateMotion motion(pose);
  std::vector<Point> moved(points.size());
  std::ranges::transform(points, moved.begin(), [&](const Point& x) {
    return point(motion.rotation.transpose() * (vector(x) - motion.translation));
  });
  return moved;
}

void every_pose(benchmark::State& state, const Scene& scene) {
  for (auto _ : state) {
    PointMapper mapper(scene.a, {.tolerance = tolerance});
    std::vector<double> smallest(scene.bone.size(), 1e300);
    std::vector<MapResult> rows(scene.bone.size());
    for (const Pose& pose : scene.way) {
      (void)mapper.map(seen_from(pose, scene.bone), rows);
      for (std::size_t i = 0; i < rows.size(); ++i) smallest[i] = std::min(smallest[i], rows[i].distance.lo);
    }
    benchmark::DoNotOptimize(smallest.data());
  }
  set_rate(state, "poses_per_second", scene.way.size());
}

void whole_way(benchmark::State& state, const Scene& scene) {
  for (auto _ : state) {
    const Insertion found = smallest_distance_along(scene.way, scene.a, scene.bone, {.tolerance = tolerance});
    benchmark::DoNotOptimize(found.rows.data());
  }
  set_rate(state, "poses_per_second", scene.way.size());
}

std::string table(const Rows& rows) {
  const auto rate = [&](std::string_view what, std::string_view object) {
    return counter(rows, row_name("verisq_host", what, object), "poses_per_second");
  };
  std::string text = fmt::format("\n{} poses, poses/s\n", pose_count);
  for (const std::string_view order : {"path", "shuffled"}) {
    text += fmt::format("two stems, {:<10} independent {:>10.0f}   with memory {:>10.0f}   ratio {:.2f}\n", order,
                        rate("independent", order), rate("memory", order),
                        rate("memory", order) / rate("independent", order));
  }
  const auto of_points = [&](std::string_view what) {
    return counter(rows, row_name("verisq", what, "points"), "poses_per_second");
  };
  text +=
      fmt::format("points,    {:<10} independent {:>10.0f}   whole way   {:>10.0f}   ratio {:.2f}\n", "way in",
                  of_points("every_pose"), of_points("whole_way"), of_points("whole_way") / of_points("every_pose"));
  return text;
}

void run(int argc, char** argv) {
  const Scene scene;
  add_pairs_row(scene, "independent", "path", scene.path, independent);
  add_pairs_row(scene, "memory", "path", scene.path, remembered);
  add_pairs_row(scene, "independent", "shuffled", scene.out_of_order, independent);
  add_pairs_row(scene, "memory", "shuffled", scene.out_of_order, remembered);
  add_row("verisq", "every_pose", "points", [&scene](benchmark::State& state) { every_pose(state, scene); });
  add_row("verisq", "whole_way", "points", [&scene](benchmark::State& state) { whole_way(state, scene); });
  fmt::print("{}", table(run_benchmarks(argc, argv, repetitions)));
}

}  // namespace
}  // namespace verisq::bench

int main(int argc, char** argv) {
  return verisq::bench::run_program("coherence_bench", verisq::bench::run, argc, argv);
}
