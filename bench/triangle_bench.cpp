/// How many triangles a second around the objects of Table 5: verisq on each device and on the host, and FCL's libccd
/// GJK, in one process on the same triangles.
#include <fmt/format.h>

#include <deque>
#include <memory>
#include <string>
#include <vector>
#include <verisq/distance.hpp>

#include "bench/benchmark_rows.hpp"
#include "bench/paper_tables.hpp"
#include "bench/peer_fcl_libccd.hpp"
#include "bench/query_rows.hpp"
#include "bench/tools.hpp"
#include "bench/triangles.hpp"

namespace verisq::bench {
namespace {

constexpr std::size_t count = 1'000'000;
constexpr std::size_t host_count = 1'000;  // the host's own proofs take their time
constexpr double tolerance = 1e-12;        // of the size
constexpr int repetitions = 5;

struct Task {
  explicit Task(const BenchmarkObject& object)
      : solid(object.solid),
        model{"", {{std::string(object.name), solid, {}}}},
        queries{"triangle",
                object.name,
                tolerance * size_of(solid),
                random_triangles(solid, count),
                count,
                [this](std::span<const Triangle> triangles) { return mapped(triangles, "auto"); }} {}
  Task(const Task&) = delete;
  Task& operator=(const Task&) = delete;

  [[nodiscard]] std::vector<Enclosure> mapped(std::span<const Triangle> triangles, const std::string& device) const {
    TriangleMapper mapper(model, {queries.tolerance, device});
    std::vector<Enclosure> enclosures;
    map_all(mapper, triangles, enclosures);
    return enclosures;
  }

  Superquadric solid;
  Model model;
  Queries<Triangle> queries;
};

/// The whole map and, as the mapper's summary counts it, the time of the kernels alone.
void add_device_row(const Task& task, const DeviceReport& device) {
  add_row(tool_name(device), "triangle_verified", task.queries.object, [&task, device](benchmark::State& state) {
    TriangleMapper mapper(task.model, {task.queries.tolerance, std::to_string(device.index)});
    std::vector<Enclosure> enclosures;
    map_all(mapper, task.queries.all, enclosures);  // OpenCL puts off work to the first launch
    double kernel_seconds = 0.0;
    double host_verified = 0.0;
    for (auto _ : state) {
      const MapSummary summary = map_all(mapper, task.queries.all, enclosures);
      kernel_seconds += summary.device_seconds;
      host_verified = static_cast<double>(summary.host_verified);
    }
    rows::set_counts(state, task.queries.all.size(), 0);
    set_widths(state, enclosures, task.queries.tolerance);
    const double triangles = static_cast<double>(state.iterations()) * static_cast<double>(task.queries.all.size());
    state.counters["kernel_triangles_per_second"] = triangles / kernel_seconds;
    state.counters["host_verified"] = host_verified;
  });
}

void add_rows(const Task& task, std::span<const DeviceReport> devices) {
  for (const DeviceReport& device : devices) add_device_row(task, device);
  add_verified_row("verisq_host", task.queries, host_count, [&task] {
    return one_by_one<Triangle>([host = TriangleDistance(task.model)](const Triangle& t) { return host(t); });
  });
  // GJK says -1 where it finds an intersection: the distance is then 0.
  add_unverified_row("fcl_libccd", task.queries, count, [&task] {
    return [fcl = LibccdTriangleDistance(task.solid)](const Triangle& t) { return std::max(0.0, fcl(t)); };
  });
}

std::string table(const Rows& rows, std::span<const std::string> devices) {
  std::string text = fmt::format("\nMillions of triangles a second, and what they are worth\n{:<44}", "");
  for (const BenchmarkObject& object : table5_objects) text += fmt::format("{:>12}", object.name);
  text += '\n';
  const auto line = [&](const std::string& label, auto figure) {
    text += fmt::format("{:<44}", label);
    for (const BenchmarkObject& object : table5_objects) text += fmt::format("{:>12.3g}", figure(object.name));
    text += '\n';
  };
  const auto of = [&rows](std::string_view tool, std::string_view kind, const char* name, double factor) {
    return [&rows, tool, kind, name, factor](std::string_view object) {
      return factor * counter(rows, row_name(tool, kind, object), name);
    };
  };
  for (const std::string& device : devices) {
    line(device + ", verified, map", of(device, "triangle_verified", "queries_per_second", 1e-6));
    line(device + ", verified, kernels", of(device, "triangle_verified", "kernel_triangles_per_second", 1e-6));
    line(device + ", median width", of(device, "triangle_verified", "width_median", 1.0));
    line(device + ", mean width", of(device, "triangle_verified", "width_mean", 1.0));
    line(device + ", at most 1e-12 of the size wide, %", of(device, "triangle_verified", "verified_fraction", 100.0));
    line(device + ", left to the host", of(device, "triangle_verified", "host_verified", 1.0));
  }
  line("verisq_host, verified, one core", of("verisq_host", "triangle_verified", "queries_per_second", 1e-6));
  line("fcl_libccd, unverified, one core", of("fcl_libccd", "triangle", "queries_per_second", 1e-6));
  line("fcl_libccd, answers above hi, %", of("fcl_libccd", "triangle", "errs_upwards", 100.0));
  line("fcl_libccd, answers below lo, %", of("fcl_libccd", "triangle", "errs_downwards", 100.0));
  line("fcl_libccd, largest error upwards", of("fcl_libccd", "triangle", "largest_error_upwards", 1.0));
  line("fcl_libccd, largest error downwards", of("fcl_libccd", "triangle", "largest_error_downwards", 1.0));
  return text;
}

void run(int argc, char** argv) {
  const std::vector<DeviceReport> devices = usable_devices();
  if (devices.empty())
    fmt::print(stderr, "no OpenCL device passed its self-test: rows of the host and the peer only\n");
  std::vector<std::string> names;
  for (const DeviceReport& device : devices) {
    names.push_back(tool_name(device));
    benchmark::AddCustomContext(names.back() + "_device", device.name);
  }
  std::deque<Task> tasks;  // rows refer to their tasks, which must not move
  for (const BenchmarkObject& object : table5_objects) add_rows(tasks.emplace_back(object), devices);
  const Rows rows = run_benchmarks(argc, argv, repetitions);
  fmt::print("{}", table(rows, names));
}

}  // namespace
}  // namespace verisq::bench

int main(int argc, char** argv) {
  return verisq::bench::run_program("triangle_bench", verisq::bench::run, argc, argv);
}
