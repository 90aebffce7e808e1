/// How fast is a map's text read and written, without any map between?
///
/// Points as files have them: of six decimals, and with as many digits as their binary64 needs.
#include <benchmark/benchmark.h>
#include <fmt/compile.h>
#include <fmt/os.h>

#include <span>
#include <string>
#include <vector>
#include <verisq/files.hpp>
#include <verisq/map_file.hpp>

#include "bench/benchmark_rows.hpp"
#include "bench/scratch_folder.hpp"
#include "bench/uniform_numbers.hpp"

namespace verisq::bench {
namespace {

constexpr int repetitions = 5;
constexpr std::size_t count = 1'000'000;
constexpr std::size_t chunk = std::size_t{1} << 16U;  // points that a map works on at a time

std::vector<Point> points_of_unit_cube() {
  UniformNumbers uniform(20'110'503);
  std::vector<Point> points(count);
  for (Point& point : points) point = {uniform.within(1.0), uniform.within(1.0), uniform.within(1.0)};
  return points;
}

std::vector<MapResult> enclosures_of(std::span<const Point> points) {
  std::vector<MapResult> rows;
  for (const auto& [x, y, z] : points) rows.push_back({{x, x + 1e-15}, Status::device_verified});
  return rows;
}

struct Files {
  explicit Files(std::span<const Point> points) {
    fmt::ostream decimals = fmt::output_file(six_decimals);
    fmt::ostream digits = fmt::output_file(all_digits);
    for (const auto& [x, y, z] : points) {
      decimals.print("{:.6f},{:.6f},{:.6f}\n", x, y, z);
      digits.print("{},{},{}\n", x, y, z);
    }
  }

  ScratchFolder folder{"text_bench"};
  std::string six_decimals = folder.file("six_decimals.csv");
  std::string all_digits = folder.file("all_digits.csv");
  std::string map = folder.file("map.csv");
};

void set_rate(benchmark::State& state) {
  state.counters["points_per_second"] =
      benchmark::Counter(static_cast<double>(count), benchmark::Counter::kIsIterationInvariantRate);
}

void read_row(benchmark::State& state, const std::string& file) {
  std::vector<Point> points(chunk);
  for (auto _ : state) {
    PointFile stream(file);
    while (stream.read(points) == points.size()) benchmark::ClobberMemory();
  }
  set_rate(state);
}

void write_row(benchmark::State& state, const std::string& file, std::span<const Point> points,
               std::span<const MapResult> rows, const MapForm& form) {
  for (auto _ : state) {
    MapWriter writer(file, nullptr, form);
    for (std::size_t first = 0; first < count; first += chunk) {
      const std::size_t size = std::min(chunk, count - first);
      writer.append(points.subspan(first, size), rows.subspan(first, size));
    }
  }  // without `finish`: the file is gone again
  set_rate(state);
}

template <class Row>
void add_row(const std::string& name, const Row& row) {
  benchmark::RegisterBenchmark(name.c_str(), row)->Unit(benchmark::kMillisecond)->UseRealTime();
}

void run(int argc, char** argv) {
  const std::vector<Point> points = points_of_unit_cube();
  const std::vector<MapResult> rows = enclosures_of(points);
  const Files files(points);
  const MapForm with_points{.columns = {MapColumn::x, MapColumn::y, MapColumn::z, MapColumn::lo, MapColumn::hi}};
  add_row("verisq_read/csv/six_decimals", [&](benchmark::State& state) { read_row(state, files.six_decimals); });
  add_row("verisq_read/csv/all_digits", [&](benchmark::State& state) { read_row(state, files.all_digits); });
  add_row("verisq_write/csv/default_columns",
          [&](benchmark::State& state) { write_row(state, files.map, points, rows, {}); });
  add_row("verisq_write/csv/coordinates_too",
          [&](benchmark::State& state) { write_row(state, files.map, points, rows, with_points); });
  (void)run_benchmarks(argc, argv, repetitions);
}

}  // namespace
}  // namespace verisq::bench

int main(int argc, char** argv) {
  return verisq::bench::run_program("text_bench", verisq::bench::run, argc, argv);
}
