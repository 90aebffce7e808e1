/// Does `verisq map` keep its pace and its memory from 40 thousand to 5 million vertices? Runs the program on a scanned
/// femur and on generated meshes; prints time a point and peak memory of each. Then the meshes themselves are the
/// model, of 10^3 to 10^7 triangles, and points in their box are asked about.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>
#include <stdexcept>

#include "bench/benchmark_rows.hpp"
#include "bench/child_process.hpp"
#include "bench/scratch_folder.hpp"
#include "bench/uniform_numbers.hpp"

namespace verisq::bench {
namespace {

constexpr int repetitions = 5;
constexpr int smallest_size = 64;                                  // its time is the start's: nothing to compute
constexpr std::array generated_sizes{40'022, 500'000, 5'000'000};  // the first is that of the scanned femur
constexpr std::array solid_sizes{500, 5'000, 50'000, 500'000, 5'000'000};  // of twice as many triangles
constexpr int points_about_solids = 100'000;
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
void map_row(benchmark::State& state, const std::string& model, const std::string& option, const std::string& asked,
             const std::string& map) {
  for (auto _ : state) {
    const ChildReport child =
        run_child({VERISQ_PROGRAM, "map", "--model", model, option, asked, "--no-progress", "--json", "-o", map});
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

/// The points that a map of a mesh as a solid is asked for.
enum class Asked { one_point, near, box };
constexpr std::array all_asked{Asked::one_point, Asked::near, Asked::box};

std::string name_of(Asked asked) {
  return asked == Asked::one_point ? "one_point" : asked == Asked::near ? "near" : "box";
}

/// Within about 2 mm of the surface of a generated mesh, or uniform in its box.
std::string points_file(Asked asked, const ScratchFolder& scratch) {
  const std::string path = scratch.file(name_of(asked) + ".csv");
  std::ofstream file(path);
  UniformNumbers random(1);
  const auto uniform = [&](double low, double high) { return low + (high - low) * random.fraction(); };
  for (int n = 0; n < (asked == Asked::one_point ? 1 : points_about_solids); ++n) {
    std::array point{uniform(95.0, 160.0), uniform(-155.0, -60.0), uniform(-980.0, -800.0)};
    if (asked == Asked::near) {  // as generate_mesh places its vertices, but for their waves
      const double height = uniform(0.0, 1.0);
      const double angle = uniform(0.0, 2.0 * std::numbers::pi);
      const double radius = 14.0 + 10.0 / (1.0 + std::exp(-14.0 * (height - 0.65))) + random.within(2.0);
      point = {123.5 + 5.0 * height + radius * std::cos(angle), -124.5 + 32.0 * height + radius * std::sin(angle),
               -973.0 + 164.0 * height};
    }
    file << fmt::format("{},{},{}\n", point[0], point[1], point[2]);
  }
  return path;
}

std::string solid_row_name(int vertices, Asked asked) {
  return fmt::format("verisq/map_about/generated_{}/{}", vertices, name_of(asked));
}

/// One point takes what reading the mesh and building its tree take.
std::string table_of_solids(const Rows& rows) {
  std::string text = "\nverisq map --model MESH --points FILE\n";
  text += fmt::format("{:>12}{:>14}{:>16}{:>16}{:>12}\n", "vertices", "one point, s", "us a point near", "in the box",
                      "peak MiB");
  for (const int vertices : solid_sizes) {
    const auto figure = [&](Asked asked, const char* name) {
      return counter(rows, solid_row_name(vertices, asked), name);
    };
    const auto microseconds = [&](Asked asked) {
      return 1e6 * (figure(asked, "map_seconds") - figure(Asked::one_point, "map_seconds")) / points_about_solids;
    };
    text += fmt::format("{:>12}{:>14.2f}{:>16.2f}{:>16.2f}{:>12.0f}\n", vertices,
                        figure(Asked::one_point, "process_seconds"), microseconds(Asked::near),
                        microseconds(Asked::box), figure(Asked::box, "peak_resident_mib"));
  }
  return text;
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
                                   [specimen, map](benchmark::State& state) {
                                     map_row(state, VERISQ_BENCH_MODEL, "--mesh", specimen.mesh, map);
                                   })
          ->UseRealTime()
          ->Iterations(1)
          ->Unit(benchmark::kMillisecond);
    }
  for (const int vertices : solid_sizes) {
    const std::string mesh = generated(vertices, scratch).mesh;
    for (const Asked asked : all_asked) {
      const std::string points = points_file(asked, scratch);
      const std::string map = scratch.file("about.csv");
      benchmark::RegisterBenchmark(solid_row_name(vertices, asked).c_str(),
                                   [=](benchmark::State& state) { map_row(state, mesh, "--points", points, map); })
          ->UseRealTime()
          ->Iterations(1)
          ->Unit(benchmark::kMillisecond);
    }
  }
  const Rows rows = run_benchmarks(argc, argv, repetitions);
  fmt::print("{}{}", table(rows, all), table_of_solids(rows));
}

}  // namespace
}  // namespace verisq::bench

int main(int argc, char** argv) {
  return verisq::bench::run_program("mesh_scale_bench", verisq::bench::run, argc, argv);
}
