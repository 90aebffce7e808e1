/// The paper's Table 6, reproduced and extended: its method as published, our certificates on the host and on devices,
/// FCL/libccd and IPOPT, in one process on the same points and poses.
#include <fmt/format.h>

#include <deque>
#include <string>
#include <vector>

#include "bench/benchmark_rows.hpp"
#include "bench/table6_pairs.hpp"
#include "bench/table6_points.hpp"
#include "bench/table6_table.hpp"
#include "bench/tools.hpp"

namespace verisq::bench {
namespace {

constexpr int repetitions = 3;

void run(int argc, char** argv) {
  const std::vector<DeviceReport> devices = usable_devices();
  if (devices.empty())
    fmt::print(stderr, "no OpenCL device passed its self-test: rows of the host and the peers only\n");
  std::vector<std::string> names;
  for (const DeviceReport& device : devices) {
    names.push_back(tool_name(device));
    benchmark::AddCustomContext(names.back() + "_device", device.name);
  }
  std::deque<Table6Points> points;  // rows refer to their queries, which must not move
  for (const BenchmarkObject& object : table5_objects) points.emplace_back(object).add_rows(devices);
  std::deque<Table6Pairs> pairs;
  for (const BenchmarkPair& pair : table6_pairs) pairs.emplace_back(pair).add_rows(devices);
  const Rows rows = run_benchmarks(argc, argv, repetitions);
  fmt::print("\n{}", table6(rows, names));
}

}  // namespace
}  // namespace verisq::bench

int main(int argc, char** argv) {
  return verisq::bench::run_program("table6_bench", verisq::bench::run, argc, argv);
}
