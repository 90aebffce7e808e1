/// How long do a fit and an insertion take as whole runs of the program, and how often is an implant found again?
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <verisq/files.hpp>
#include <verisq/fit.hpp>

#include "bench/approximate_motion.hpp"
#include "bench/benchmark_rows.hpp"
#include "bench/child_process.hpp"
#include "bench/random_starts.hpp"
#include "bench/row_counters.hpp"
#include "bench/scratch_folder.hpp"
#include "bench/tools.hpp"
#include "bench/uniform_numbers.hpp"
#include "tests/fixtures/offset_cavity.hpp"

namespace verisq::bench {
namespace {

constexpr int repetitions = 3;
constexpr int some_wide = 3;  // the exit status of a finished insertion

/// The femur's cortex that README's figures are about; nothing where the data are not there.
std::optional<std::string> cortex() {
  const char* const data = std::getenv("VERISQ_DATA");
  const auto mesh = std::filesystem::path(data != nullptr ? data : "../shared/data") / "gfxmorph" / "femur_cortex.stl";
  if (std::filesystem::exists(mesh)) return mesh.string();
  fmt::print(stderr, "{} is missing (VERISQ_DATA names its folder): no rows of fit and insert\n", mesh.string());
  return std::nullopt;
}

/// The summary of one run of `verisq`; nothing, and the row ends in an error, where it failed.
std::optional<nlohmann::json> summary_of_run(benchmark::State& state, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), VERISQ_PROGRAM);
  arguments.insert(arguments.end(), {"--no-progress", "--json"});
  const ChildReport child = run_child(arguments);
  if (child.exit_status != 0 && child.exit_status != some_wide) {
    state.SkipWithError(fmt::format("verisq {} ended with status {}", arguments[1], child.exit_status).c_str());
    return std::nullopt;
  }
  state.counters["process_seconds"] = child.seconds;
  return nlohmann::json::parse(child.output);
}

void fit_row(benchmark::State& state, const std::string& bone, const std::string& fitted, const std::string& map) {
  for (auto _ : state) {
    const auto summary = summary_of_run(
        state, {"fit", "--cavity", "--implant", VERISQ_STEM, "--mesh", bone, "-o", fitted, "--map", map});
    if (!summary) return;
    state.SetLabel(summary->at("search").at("device").get<std::string>());
  }
}

/// 100 mm against the z axis; the implant is the fitted one.
void insert_row(benchmark::State& state, const std::string& bone, const std::string& fitted, const std::string& map,
                const std::string& tolerance) {
  for (auto _ : state) {
    const auto summary = summary_of_run(state, {"insert", "--implant", fitted, "--mesh", bone, "--along", "0,0,-1",
                                                "--length", "100", "--tol", tolerance, "-o", map});
    if (!summary) return;
    state.counters["seconds"] = summary->at("seconds").get<double>();
  }
}

constexpr double gap = 0.5;  // mm between the implant and the cavity made of it
constexpr double reach = 20.0;
constexpr double reach_degrees = 30.0;
constexpr double degree = std::numbers::pi / 180.0;

/// To 0.1 mm at the implant's centre and 0.1 degrees.
bool is_found(const Eigen::Vector3d& centre, const Pose& pose) {
  const auto& [w, x, y, z] = pose.quaternion;
  const Eigen::Quaterniond turn = Eigen::Quaterniond(w, x, y, z).normalized();
  const double off = (turn * centre + vector(pose.translation) - centre).norm();
  const double degrees = 2.0 * std::asin(std::min(turn.vec().norm(), 1.0)) / degree;
  return off <= 0.1 && degrees <= 0.1;
}

/// One start an iteration: `found_again` is the share of the iterations.
void recovery_row(benchmark::State& state, const Model& implant, const Cavity& cavity, const DeviceReport& device) {
  const Eigen::Vector3d centre = centre_of(implant);
  const UncertainModel exact = implant;
  UniformNumbers uniform(20'110'505);
  std::size_t found = 0;
  std::uint64_t seed = 0;
  for (auto _ : state) {
    FitOptions options{.fitness = cemented(gap, gap / 2.0),
                       .penetration_limit = 0.0,
                       .range = {moved_off(centre, reach, reach_degrees, uniform), reach, reach_degrees}};
    options.seed = ++seed;
    options.samples = 512;
    options.device = std::to_string(device.index);
    const Fit best = fit({&exact, 1}, cavity, options);
    if (is_found(centre, best.pose) && best.within_limit) ++found;
  }
  state.counters["found_again"] = static_cast<double>(found) / static_cast<double>(seed);
}

void add_run(const std::string& name, const std::function<void(benchmark::State&)>& run) {
  benchmark::RegisterBenchmark(name.c_str(), run)->UseRealTime()->Iterations(1)->Unit(benchmark::kSecond);
}

void run(int argc, char** argv) {
  constexpr int starts = 100;
  const ScratchFolder scratch("planning");
  const std::string fitted = scratch.file("fitted.json");
  const std::string map = scratch.file("map.csv");
  if (const auto bone = cortex()) {
    add_run("verisq/fit/cortex", [=](benchmark::State& state) { fit_row(state, *bone, fitted, map); });
    // The order of rows is random: the insertions have an implant of their own.
    const std::string implant = scratch.file("implant.json");
    const auto fit =
        run_child({VERISQ_PROGRAM, "fit", "--cavity", "--implant", VERISQ_STEM, "--mesh", *bone, "-o", implant});
    if (fit.exit_status != 0) throw std::runtime_error("verisq fit failed");
    for (const char* tolerance : {"0.1", "0.001"}) {
      add_run(fmt::format("verisq/insert_to_{}/cortex", tolerance),
              [=](benchmark::State& state) { insert_row(state, *bone, implant, map, tolerance); });
    }
  }
  const Model stem = read_model(VERISQ_STEM);
  const Cavity cavity = testing::offset_cavity(stem, gap, 100);
  for (const DeviceReport& device : usable_devices()) {
    benchmark::RegisterBenchmark(
        row_name(tool_name(device), "found_again", "stem_of_five").c_str(),
        [&stem, &cavity, device](benchmark::State& state) { recovery_row(state, stem, cavity, device); })
        ->UseRealTime()
        ->Iterations(starts)
        ->Unit(benchmark::kSecond);
  }
  static_cast<void>(run_benchmarks(argc, argv, repetitions));
}

}  // namespace
}  // namespace verisq::bench

int main(int argc, char** argv) {
  return verisq::bench::run_program("planning_bench", verisq::bench::run, argc, argv);
}
