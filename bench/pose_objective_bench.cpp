/// How many signed distances with gradients a second, and how many poses of a whole implant, a device evaluates for a
/// fit.
#include <Eigen/Geometry>
#include <cmath>
#include <ctime>
#include <deque>
#include <numbers>
#include <string>
#include <vector>
#include <verisq/files.hpp>

#include "bench/approximate_motion.hpp"
#include "bench/benchmark_rows.hpp"
#include "bench/paper_tables.hpp"
#include "bench/points.hpp"
#include "bench/row_counters.hpp"
#include "bench/tools.hpp"
#include "host/plan/pose_search.hpp"

namespace verisq::bench {
namespace {

using fit_search::Candidate;

constexpr int repetitions = 5;
constexpr Fitness fitness{1.0, 0.5, {0.0, 2.0}};
constexpr std::size_t points_of_primitive = 4096;
constexpr std::size_t candidates_of_primitive = 200;
constexpr std::size_t points_of_cavity = 1702;  // of the femur's mesh that the stem is fitted into
constexpr std::size_t poses = 500;

struct Task {
  std::string what;
  std::string object;
  std::vector<Point> points;
  std::vector<Candidate> candidates;
};

/// One primitive in one pose: nothing is passed over, and the points stay on their side.
Task single(std::string_view name, const Superquadric& solid, Side side) {
  const bool outside = side == Side::outside;
  const Candidate candidate{{{std::string(name), solid, {}}}, {0.0, 0.0, 0.0}};
  return {outside ? "distances_outside" : "distances_inside", std::string(name),
          outside ? points_outside(solid, points_of_primitive) : points_inside(solid, points_of_primitive),
          std::vector<Candidate>(candidates_of_primitive, candidate)};
}

std::vector<Point> points_about(const Model& model, std::size_t count) {
  UniformNumbers uniform(20'110'503);
  std::vector<Point> points;
  for (std::size_t n = 0; n < count; ++n) {
    const Primitive& primitive = model.primitives[n % model.primitives.size()];
    Point local{};
    for (std::size_t i = 0; i < 3; ++i) local[i] = uniform.within(2.0 * primitive.superquadric.semi_axes[i]);
    points.push_back(point(ApproximateMotion(primitive.pose)(vector(local))));
  }
  return points;
}

/// The implant at poses up to `shift` along and `degrees` about each axis from its own.
Task implant(const Model& model, std::string_view name, double shift, double degrees) {
  UniformNumbers uniform(20'110'504);
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Primitive& p : model.primitives) centre += vector(p.pose.translation);
  centre /= static_cast<double>(model.primitives.size());
  std::vector<Candidate> candidates;
  for (std::size_t n = 0; n < poses; ++n) {
    const auto components = [&uniform](double limit) {
      const double x = uniform.within(limit);
      const double y = uniform.within(limit);
      return Eigen::Vector3d(x, y, uniform.within(limit));
    };
    const Eigen::Vector3d moved = centre + components(shift);
    const Eigen::Vector3d turned = components(degrees * std::numbers::pi / 180.0);
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(turned.norm(), turned.normalized()));
    Candidate candidate{model.primitives, point(moved)};
    for (Primitive& p : candidate.primitives) {
      auto& q = p.pose.quaternion;
      const Eigen::Quaterniond both = turn * Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
      p.pose = {point(turn * (vector(p.pose.translation) - centre) + moved), {both.w(), both.x(), both.y(), both.z()}};
    }
    candidates.push_back(std::move(candidate));
  }
  return {"poses", std::string(name), points_about(model, points_of_cavity), std::move(candidates)};
}

void evaluate(benchmark::State& state, const Task& task, const DeviceReport& report) {
  const auto device = device::select_device(std::to_string(report.index)).device.value();
  const std::vector<double> weights(task.points.size(), 1.0);
  const auto evaluator = device::device_candidate_evaluator(device, task.points, weights);
  std::vector<fit_search::Evaluation> evaluations;
  evaluator->evaluate(task.candidates, fitness, {}, 1, evaluations);  // OpenCL puts off work to the first launch
  const std::clock_t before = std::clock();
  for (auto _ : state) evaluator->evaluate(task.candidates, fitness, {}, 1, evaluations);
  const double processor_seconds = static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;  // of all threads
  const std::size_t count = task.candidates.size() * task.points.size() * task.candidates.front().primitives.size();
  set_rate(state, "poses_per_second", task.candidates.size());
  set_rate(state, "evaluations_per_second", count);
  state.counters["evaluations_per_processor_second"] =
      static_cast<double>(state.iterations()) * static_cast<double>(count) / processor_seconds;
}

void run(int argc, char** argv) {
  std::deque<Task> tasks;
  std::vector<BenchmarkObject> objects(table5_objects.begin(), table5_objects.end());
  objects.push_back({"stem", {{5.5, 5.0, 25.0}, {0.9, 0.8}}, {}, {}});
  for (const BenchmarkObject& object : objects)
    for (const Side side : {Side::outside, Side::inside}) tasks.push_back(single(object.name, object.solid, side));
  const Model stem = read_model(VERISQ_STEM);
  tasks.push_back(implant(stem, "stem_of_five_start", 20.0, 30.0));
  tasks.push_back(implant(stem, "stem_of_five_refinement", 1.0, 2.0));
  for (const DeviceReport& device : usable_devices()) {
    for (const Task& task : tasks) {
      add_row(tool_name(device), task.what, task.object,
              [&task, device](benchmark::State& state) { evaluate(state, task, device); });
    }
  }
  static_cast<void>(run_benchmarks(argc, argv, repetitions));
}

}  // namespace
}  // namespace verisq::bench

int main(int argc, char** argv) {
  return verisq::bench::run_program("pose_objective_bench", verisq::bench::run, argc, argv);
}
