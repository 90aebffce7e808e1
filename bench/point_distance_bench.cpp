/// Distance of points to the objects of Table 5: verisq on each device, on the host, and FCL's libccd GJK, in one
/// process on the same points. Prints the paper's Table 6 beside ours.
#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <functional>
#include <vector>

#include "bench/benchmark_rows.hpp"
#include "bench/operation_count.hpp"
#include "bench/paper_tables.hpp"
#include "bench/peak_rate.hpp"
#include "bench/peer_fcl_libccd.hpp"
#include "bench/point_distance_kernel.hpp"
#include "bench/point_distance_table.hpp"
#include "bench/points.hpp"
#include "bench/row_counters.hpp"
#include "bench/tools.hpp"

namespace verisq::bench {
namespace {

constexpr std::size_t outside_count = 1'000'000;
constexpr std::size_t inside_count = 100'000;
constexpr std::size_t host_count = 1'000;  // the host's own proofs take their time
// Of the largest semi-axis. Outside, tolerance 0 would ask the host to improve on every enclosure that is not exact;
// nearly all points are within this.
constexpr double outside_tolerance = 1e-12;
constexpr double inside_tolerance = 1e-6;
constexpr int repetitions = 5;

struct Task {
  explicit Task(const BenchmarkObject& of)
      : object(of),
        model{"", {{std::string(of.name), of.solid, {}}}},
        outside(points_outside(of.solid, outside_count)),
        inside(points_inside(of.solid, inside_count)),
        tapered{of.solid.semi_axes, of.solid.exponents, 2.0} {
    // The tapered solid lies in 1 + k = 4/3 times the other one about its focus, k/a3 = 1/3 below the centre.
    for (const Point& p : outside) {
      const double focus = -tapered.semi_axes[2] / 3.0;
      outside_tapered.push_back({1.34 * p[0], 1.34 * p[1], focus + 1.34 * p[2]});
    }
  }

  BenchmarkObject object;
  Model model;
  std::vector<Point> outside;
  std::vector<Point> inside;
  Superquadric tapered;  ///< its upper end twice as wide as the lower
  std::vector<Point> outside_tapered;
};

/// Against the rate of FMAs measured right after the row, so that both saw the machine in the same mood.
void set_peak_fraction(benchmark::State& state, double operations, const DeviceReport& device) {
  const double peak_rate = measured_peak_rate(device.name);
  state.counters["fp64_fma_rate"] = peak_rate;
  state.counters["peak_fraction"] = per_second(operations / peak_rate);
}

double thread_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// The public interface, points and rows in memory: everything that a user of the library waits for once the device is
/// ready. What this costs the caller's own thread is the host's work.
void columns_row(benchmark::State& state, const Task& task, std::span<const Point> points, const MapOptions& options) {
  PointMapper mapper(task.model, options);
  std::vector<double> lo(points.size());
  std::vector<double> hi(points.size());
  std::vector<Status> status(points.size());
  const ResultColumns rows(lo, hi, status);
  mapper.map(points, rows);  // OpenCL puts off work to the first launch
  double host = 0.0;
  for (auto _ : state) {
    const double start = thread_seconds();
    mapper.map(points, rows);
    host += thread_seconds() - start;
  }
  set_rate(state, "points_per_second", points.size());
  state.counters["host_ns_a_point"] =
      1e9 * host / static_cast<double>(points.size()) / static_cast<double>(state.iterations());
  std::vector<Enclosure> enclosures;
  for (std::size_t i = 0; i < points.size(); ++i) enclosures.push_back({lo[i], hi[i]});
  set_widths(state, enclosures, options.tolerance);
}

/// Likewise from a source to a sink.
void map_row(benchmark::State& state, const Task& task, std::span<const Point> points, const MapOptions& options) {
  PointMapper mapper(task.model, options);
  std::vector<Enclosure> enclosures;
  map_all(mapper, points, enclosures);  // OpenCL puts off work to the first launch
  for (auto _ : state) map_all(mapper, points, enclosures);
  set_rate(state, "points_per_second", points.size());
  set_widths(state, enclosures, options.tolerance);
}

void kernel_row(benchmark::State& state, const Task& task, const DeviceReport& device, KernelVariant variant,
                double operations_a_point) {
  PointDistanceKernel kernel(device, variant, task.object.solid, task.outside);
  for (auto _ : state) kernel.run();
  set_rate(state, "points_per_second", kernel.points());
  set_peak_fraction(state, operations_a_point * static_cast<double>(kernel.points()), device);
}

/// Compared with the enclosures of `options.device`: all points on a device, a few on the host.
void peer_row(benchmark::State& state, const Task& task, const MapOptions& options) {
  const LibccdPointDistance distance(task.object.solid);
  std::vector<double> answers(task.outside.size());
  for (auto _ : state) std::ranges::transform(task.outside, answers.begin(), std::cref(distance));
  set_rate(state, "points_per_second", answers.size());
  const std::size_t compared = options.device == "host" ? host_count : task.outside.size();
  PointMapper mapper(task.model, options);
  std::vector<Enclosure> enclosures;
  map_all(mapper, std::span(task.outside).first(compared), enclosures);
  set_errors(state, answers, enclosures);
}

void add_device_rows(const Task& task, const DeviceReport& device) {
  const std::string tool = tool_name(device);
  const std::string index = std::to_string(device.index);
  const std::string_view name = task.object.name;
  const double verified = verified_operations(name);
  const double solver = solver_operations(name);
  const double size = size_of(task.object.solid);
  add_row(tool, "point_outside_stream", name, [=, &task](benchmark::State& state) {
    map_row(state, task, task.outside, {outside_tolerance * size, index});
  });
  add_row(tool, "point_outside", name, [=, &task](benchmark::State& state) {
    columns_row(state, task, task.outside, {outside_tolerance * size, index});
    set_peak_fraction(state, verified * static_cast<double>(task.outside.size()), device);
  });
  add_row(tool, "point_outside_kernel", name,
          [=, &task](benchmark::State& state) { kernel_row(state, task, device, KernelVariant::verified, verified); });
  add_row(tool, "point_outside_tapered_kernel", name, [=, &task](benchmark::State& state) {
    PointDistanceKernel kernel(device, KernelVariant::verified, task.tapered, task.outside_tapered);
    for (auto _ : state) kernel.run();
    set_rate(state, "points_per_second", kernel.points());
  });
  add_row(tool, "point_outside_solver_only", name,
          [=, &task](benchmark::State& state) { kernel_row(state, task, device, KernelVariant::solver_only, solver); });
  // The work of an inside point varies with its cells: no operation count, no peak fraction.
  add_row(tool, "point_inside", name, [=, &task](benchmark::State& state) {
    map_row(state, task, task.inside, {inside_tolerance * size, index});
  });
}

void add_host_rows(const Task& task, const MapOptions& judge) {
  const std::string_view name = task.object.name;
  add_row("fcl_libccd", "point_outside", name,
          [&task, judge](benchmark::State& state) { peer_row(state, task, judge); });
  add_row("verisq_host", "point_outside", name, [&task](benchmark::State& state) {
    map_row(state, task, std::span(task.outside).first(host_count), {0.0, "host"});
  });
}

void run(int argc, char** argv) {
  const std::vector<DeviceReport> devices = usable_devices();
  if (devices.empty())
    fmt::print(stderr, "no OpenCL device passed its self-test: rows of the host and the peer only\n");
  std::vector<std::string> tools;
  for (const DeviceReport& device : devices) {
    tools.push_back(tool_name(device));
    benchmark::AddCustomContext(tools.back() + "_device", device.name);
  }
  const std::string judge = devices.empty() ? "host" : std::to_string(devices.front().index);
  const std::vector<Task> tasks(table5_objects.begin(), table5_objects.end());
  for (const Task& task : tasks) {
    for (const DeviceReport& device : devices) add_device_rows(task, device);
    add_host_rows(task, {outside_tolerance * size_of(task.object.solid), judge});
  }
  const Rows rows = run_benchmarks(argc, argv, repetitions);
  fmt::print("{}", point_distance_tables(rows, tools));
}

}  // namespace
}  // namespace verisq::bench

int main(int argc, char** argv) {
  return verisq::bench::run_program("point_distance_bench", verisq::bench::run, argc, argv);
}
