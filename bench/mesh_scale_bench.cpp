/// Does `verisq map` keep its pace and its memory from 40 thousand to 5 million vertices? Runs the program on a scanned
/// femur and on generated meshes; prints time a point and peak memory of each.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "bench/benchmark_rows.hpp"
#include "bench/child_process.hpp"
#include "bench/scratch_folder.hpp"

namespace verisq::bench {
namespace {

constexpr int repetitions = 5;
constexpr int smallest_size = 64;                                  // its time is the start's: nothing to compute
constexpr std::array generated_sizes{40'022, 500'000, 5'000'000};  // the first is that of the scanned femur
constexpr std::array<std::string_view, 2> formats{"csv", "vtp"};
constexpr double mebibyte = 1024.0 * 1024.0;
constexpr int some_wide = 3;  // the exit status of a finished map

struct Specimen {
  std::string name;
  std::string mesh;
};

Specimen generated(int vertices, const ScratchFolder& scratch) {
  const std::string mesh = scratch.file(fmt::format("{}.ply", vertices));
  if (run_child({VERISQ_GENERATE_MESH, std::to_string(vertices), mesh}).exit_status != 0)
    throw std::runtime_error("generate_mesh failed");
  return {fmt::format("generated_{}", vertices), mesh};
}

/// The smallest first, the largest last.
std::vector<Specimen> specimens(const ScratchFolder& scratch) {
  std::vector<Specimen> all{generated(smallest_size, scratch)};
  const char* const data = std::getenv("VERISQ_DATA");
  const auto femur = std::filesystem::path(data != nullptr ? data : "../shared/data") / "libhip" / "m3_lfemur_mm.stl";
  if (std::filesystem::exists(femur))
    all.push_back({"libhip_femur", femur.string()});
  else
    fmt::print(stderr, "{} is missing (VERISQ_DATA names its folder): generated meshes only\n", femur.string());
  for (const int vertices : generated_sizes) all.push_back(generated(vertices, scratch));
  return all;
}

/// One whole run of the program. "seconds" of its summary runs from the first point to the last row written; reading
/// the mesh and starting OpenCL come on top in process_seconds.
void map_row(benchmark::State& state, const std::string& mesh, const std::string& map) {
  for (auto _ : state) {
    const ChildReport child = run_child(
        {VERISQ_PROGRAM, "map", "--model", VERISQ_BENCH_MODEL, "--mesh", mesh, "--no-progress", "--json", "-o", map});
    if (child.exit_status != 0 && child.exit_status != some_wide) {
      state.SkipWithError(fmt::format("verisq map ended with status {}", child.exit_status).c_str());
      return;
    }
    const auto summary = nlohmann::json::parse(child.output);
    const auto points = summary.at("points").get<double>();
    const auto seconds = summary.at("seconds").get<double>();
    state.counters["points"] = points;
    state.counters["points_per_second"] = points / seconds;
    state.counters["map_seconds"] = seconds;
    state.counters["seconds_per_point"] = seconds / points;
    state.counters["process_seconds"] = child.seconds;
    state.counters["peak_resident_mib"] = child.peak_resident_bytes / mebibyte;
    state.counters["wide"] = summary.at("wide").get<double>();
    state.SetLabel(summary.at("device").get<std::string>());
  }
}

std::string row_name(std::string_view format, std::string_view specimen) {
  return fmt::format("verisq/map_to_{}/{}", format, specimen);
}

std::string table(const Rows& rows, const std::vector<Specimen>& all) {
  std::string text;
  for (const std::string_view format : formats) {
    text += fmt::format("\nverisq map to .{}: time a point without the start, its ratio to the largest mesh, memory\n",
                        format);
    text += fmt::format("{:<22}{:>12}{:>12}{:>12}{:>12}{:>12}{:>12}{:>12}\n", "", "vertices", "process s", "map s",
                        "ns a point", "ratio", "peak MiB", "wide");
    const auto figure = [&](const Specimen& specimen, const char* name) {
      return counter(rows, row_name(format, specimen.name), name);
    };
    const auto net_seconds_per_point = [&](const Specimen& specimen) {
      return (figure(specimen, "map_seconds") - figure(all.front(), "map_seconds")) / figure(specimen, "points");
    };
    for (const Specimen& specimen : all)
      text += fmt::format("{:<22}{:>12.0f}{:>12.3f}{:>12.3f}{:>12.0f}{:>12.2f}{:>12.0f}{:>12.0f}\n", specimen.name,
                          figure(specimen, "points"), figure(specimen, "process_seconds"),
                          figure(specimen, "map_seconds"), 1e9 * net_seconds_per_point(specimen),
                          net_seconds_per_point(specimen) / net_seconds_per_point(all.back()),
                          figure(specimen, "peak_resident_mib"), figure(specimen, "wide"));
  }
  return text;
}

void run(int argc, char** argv) {
  const ScratchFolder scratch("mesh_scale");
  const std::vector<Specimen> all = specimens(scratch);
  for (const std::string_view format : formats)
    for (const Specimen& specimen : all) {
      const std::string map = scratch.file(fmt::format("map.{}", format));
      benchmark::RegisterBenchmark(row_name(format, specimen.name).c_str(),
                                   [specimen, map](benchmark::State& state) { map_row(state, specimen.mesh, map); })
          ->UseRealTime()
          ->Iterations(1)
          ->Unit(benchmark::kMillisecond);
    }
  const Rows rows = run_benchmarks(argc, argv, repetitions);
  fmt::print("{}", table(rows, all));
}

}  // namespace
}  // namespace verisq::bench

int main(int argc, char** argv) {
  return verisq::bench::run_program("mesh_scale_bench", verisq::bench::run, argc, argv);
}
