/// How many cubes of an octree a device colours a second: of one superquadric, and of a tree of ten with and without
/// Duff's simplification.
#include <fmt/format.h>

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "bench/benchmark_rows.hpp"
#include "bench/row_counters.hpp"
#include "bench/tools.hpp"
#include "host/maps/octree.hpp"
#include "verify/search/octree_cube.hpp"

namespace verisq::bench {
namespace {

constexpr int repetitions = 5;

struct Task {
  std::string_view object;
  Model model;
  std::string_view what;
  std::string compiler_options;
  int depth;
};

Model capsule(double angle) {
  Model model{"", {{"capsule", {{0.75, 0.75, 1.0}, {1.0, 0.8}}, {}}}};
  model.primitives.front().pose.quaternion = {1.0, angle, 0.5 * angle, 0.25 * angle};
  return model;
}

/// A block with turned studs, bored through: unions, an intersection and a difference of ten primitives.
Model bored_block() {
  const auto leaf = [](std::uint32_t n) { return SetExpression{{}, SetOperation::unite, n}; };
  Model model;
  model.primitives.push_back({"block", {{2.0, 1.5, 1.0}, {0.2, 0.2}}, {}});
  model.primitives.push_back({"ball", {{1.9, 1.9, 1.9}, {1.0, 1.0}}, {}});
  SetExpression body{{leaf(0), leaf(1)}, SetOperation::intersect};
  SetExpression studded{{body}, SetOperation::unite};
  SetExpression bored{{}, SetOperation::subtract};
  for (std::uint32_t i = 0; i < 4; ++i) {
    const double x = -1.2 + 0.8 * i;
    model.primitives.push_back({"stud", {{0.2, 0.3, 0.5}, {0.5, 1.0}}, {{x, 0.7, 0.8}, {1.0, 0.1 * i, 0.2, 0.0}}});
    studded.operands.push_back(leaf(2 + i));
  }
  bored.operands.push_back(studded);
  for (std::uint32_t i = 0; i < 4; ++i) {
    const double x = -1.2 + 0.8 * i;
    model.primitives.push_back({"bore", {{0.2, 0.2, 2.0}, {0.3, 1.0}}, {{x, -0.5, 0.0}, {1.0, 0.05 * i, 0.1, 0.0}}});
    bored.operands.push_back(leaf(6 + i));
  }
  model.csg = bored;
  return model;
}

/// All levels, counted but not delivered.
struct Growth {
  std::uint64_t coloured = 0;
  std::uint64_t undecided = 0;
};

Growth grow(OctreeFront& front, int depth) {
  OctreeOptions options;
  options.budget = std::size_t{1} << 23U;
  Growth growth;
  front.restart();
  for (int level = 0; level < depth && front.undecided() > 0; ++level) {
    growth.coloured += 8 * front.undecided();
    front.split(level, options, {});
  }
  growth.undecided = front.undecided();
  return growth;
}

void add_device_row(const Task& task, const DeviceReport& report) {
  add_row(tool_name(report), task.what, task.object, [&task, report](benchmark::State& state) {
    const auto selection = device::select_device(std::to_string(report.index));
    const auto front =
        device::octree_front(*selection.device, task.model, verify::octree_root(task.model), task.compiler_options);
    Growth growth = grow(*front, task.depth);  // OpenCL puts off work to the first launch
    double kernel_seconds = 0.0;
    for (auto _ : state) {
      growth = grow(*front, task.depth);
      kernel_seconds += front->device_seconds();
    }
    const auto coloured = static_cast<double>(growth.coloured);
    state.counters["cubes_per_second"] = per_second(coloured);
    state.counters["kernel_cubes_per_second"] = static_cast<double>(state.iterations()) * coloured / kernel_seconds;
    state.counters["coloured"] = coloured;
    state.counters["undecided"] = static_cast<double>(growth.undecided);
  });
}

void run(int argc, char** argv) {
  const std::vector<DeviceReport> devices = usable_devices();
  if (devices.empty()) fmt::print(stderr, "no OpenCL device passed its self-test: no rows\n");
  const std::vector<Task> tasks{{"capsule", capsule(0.0), "siblings", "", 10},
                                {"capsule", capsule(0.0), "cube_by_cube", "-DNO_SIBLINGS", 9},
                                {"turned_capsule", capsule(0.3), "cube_by_cube", "", 9},
                                {"ten_primitives", bored_block(), "simplified", "", 8},
                                {"ten_primitives", bored_block(), "whole_tree", "-DNO_SIMPLIFICATION", 8}};
  for (const DeviceReport& device : devices)
    for (const Task& task : tasks) add_device_row(task, device);
  const Rows rows = run_benchmarks(argc, argv, repetitions);
  fmt::print("\nMillions of cubes a second\n");
  for (const DeviceReport& device : devices)
    for (const Task& task : tasks) {
      const std::string row = row_name(tool_name(device), task.what, task.object);
      fmt::print("{:<48}to level {:>2}{:>10.3g}, kernels{:>10.3g}\n", row, task.depth,
                 1e-6 * counter(rows, row, "cubes_per_second"), 1e-6 * counter(rows, row, "kernel_cubes_per_second"));
    }
}

}  // namespace
}  // namespace verisq::bench

int main(int argc, char** argv) {
  return verisq::bench::run_program("octree_bench", verisq::bench::run, argc, argv);
}
