/// How many points and triangles a second around models with bends and set operations: verisq on each device and on the
/// host.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <string>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/files.hpp>

#include "bench/benchmark_rows.hpp"
#include "bench/query_rows.hpp"
#include "bench/tools.hpp"
#include "bench/uniform_numbers.hpp"

namespace verisq::bench {
namespace {

constexpr std::size_t count = 100'000;
constexpr std::size_t triangle_count = 20'000;
constexpr std::size_t host_count = 200;
constexpr double tolerance = 1e-6;  // of the radius of the model
constexpr double nearness = 0.05;   // of the radius: what counts as beside the surface
constexpr int repetitions = 5;

Primitive sphere(const char* name, double radius, const Point& centre) {
  return {name, {{radius, radius, radius}, {1.0, 1.0}}, {centre}};
}

SetExpression leaf(std::uint32_t primitive) {
  return {{}, SetOperation::unite, primitive};
}

/// A sphere with a bite out of it: many points are nearest to the sharp rim.
Model bitten_sphere() {
  return {"",
          {sphere("whole", 1.0, {0.0, 0.0, 0.0}), sphere("bite", 0.8, {0.7, 0.0, 0.0})},
          SetExpression{{leaf(0), leaf(1)}, SetOperation::subtract}};
}

Model bent_stem(double taper = 1.0) {
  return {"", {{"stem", {{6.0, 9.0, 60.0}, {0.4, 0.9}, taper}, {}, Bend{0.004, 70.0}}}};
}

struct Task {
  std::string name;
  Model model;
  double tolerance_of_model;
  std::vector<Point> points;
};

struct TriangleTask {
  std::string name;
  Model model;
  double tolerance_of_model;
  std::vector<Triangle> triangles;
};

std::vector<Point> points_about(const Model& model, std::size_t wanted) {
  UniformNumbers uniform(20'110'507);
  const double radius = bounding_radius(model);
  std::vector<Point> points(wanted);
  for (Point& point : points)
    for (double& coordinate : point) coordinate = uniform.within(1.2 * radius);
  return points;
}

/// A corner in that box, the others within `size` of it on each axis. Some meet the solid.
std::vector<Triangle> triangles_about(const Model& model, double size) {
  UniformNumbers uniform(20'110'508);
  const double radius = bounding_radius(model);
  std::vector<Triangle> triangles(triangle_count);
  for (Triangle& triangle : triangles) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      triangle[0][axis] = uniform.within(1.2 * radius);
      for (std::size_t corner = 1; corner < 3; ++corner)
        triangle[corner][axis] = triangle[0][axis] + uniform.within(size * radius);
    }
  }
  return triangles;
}

/// Those of many points that lie beside the surface, on either side.
std::vector<Point> points_beside(const Model& model) {
  const double radius = bounding_radius(model);
  std::vector<Point> candidates = points_about(model, 10 * count);
  PointMapper mapper(model, {nearness * radius});
  std::vector<Enclosure> enclosures;
  map_all(mapper, candidates, enclosures);
  std::vector<Point> points;
  for (std::size_t i = 0; i < candidates.size() && points.size() < count; ++i)
    if (std::abs(0.5 * enclosures[i].lo + 0.5 * enclosures[i].hi) < nearness * radius) points.push_back(candidates[i]);
  return points;
}

void add_device_row(const Task& task, const DeviceReport& device) {
  add_row(tool_name(device), "point_verified", task.name, [&task, device](benchmark::State& state) {
    PointMapper mapper(task.model, {task.tolerance_of_model, std::to_string(device.index)});
    std::vector<Enclosure> enclosures;
    map_all(mapper, task.points, enclosures);  // OpenCL puts off work to the first launch
    MapSummary summary;
    for (auto _ : state) summary = map_all(mapper, task.points, enclosures);
    rows::set_counts(state, task.points.size(), 0);
    set_widths(state, enclosures, task.tolerance_of_model);
    state.counters["host_verified"] = static_cast<double>(summary.host_verified);
    state.counters["wide"] = static_cast<double>(summary.wide);
  });
}

void add_device_row(const TriangleTask& task, const DeviceReport& device) {
  add_row(tool_name(device), "triangle_verified", task.name, [&task, device](benchmark::State& state) {
    TriangleMapper mapper(task.model, {task.tolerance_of_model, std::to_string(device.index)});
    std::vector<Enclosure> enclosures;
    map_all(mapper, task.triangles, enclosures);  // OpenCL puts off work to the first launch
    MapSummary summary;
    for (auto _ : state) summary = map_all(mapper, task.triangles, enclosures);
    rows::set_counts(state, task.triangles.size(), 0);
    set_widths(state, enclosures, task.tolerance_of_model);
    state.counters["host_verified"] = static_cast<double>(summary.host_verified);
    state.counters["wide"] = static_cast<double>(summary.wide);
  });
}

void add_host_row(const Task& task) {
  add_row("verisq_host", "point_verified", task.name, [&task](benchmark::State& state) {
    const SignedDistance distance(task.model);
    std::vector<Enclosure> enclosures;
    for (auto _ : state) {
      enclosures.clear();
      for (std::size_t i = 0; i < std::min(host_count, task.points.size()); ++i)
        enclosures.push_back(distance(task.points[i], task.tolerance_of_model));
    }
    rows::set_counts(state, enclosures.size(), 0);
    set_widths(state, enclosures, task.tolerance_of_model);
  });
}

std::deque<Task> tasks() {
  std::deque<Task> all;
  const auto add = [&all](const std::string& name, const Model& model) {
    const double width = tolerance * bounding_radius(model);
    all.push_back({name + ", space", model, width, points_about(model, count)});
    all.push_back({name + ", beside", model, width, points_beside(model)});
  };
  add("bitten sphere", bitten_sphere());
  add("bent stem", bent_stem());
  add("bent stem, bored head", read_model(VERISQ_BENT_STEM));
  add("tapered bent stem", bent_stem(2.0));
  add("tapered bent shaft, body, head", read_model(VERISQ_BENT_TAPERED_STEM));
  return all;
}

std::deque<TriangleTask> triangle_tasks() {
  std::deque<TriangleTask> all;
  const auto add = [&all](const std::string& name, const Model& model) {
    const double width = tolerance * bounding_radius(model);
    all.push_back({name + ", 1/100", model, width, triangles_about(model, 0.01)});
    all.push_back({name + ", 1/10", model, width, triangles_about(model, 0.1)});
  };
  add("bitten sphere", bitten_sphere());
  add("bent stem", bent_stem());
  add("bent stem, bored head", read_model(VERISQ_BENT_STEM));
  add("tapered bent stem", bent_stem(2.0));
  add("tapered bent shaft, body, head", read_model(VERISQ_BENT_TAPERED_STEM));
  return all;
}

std::string table(const Rows& rows, const std::deque<TriangleTask>& all, const std::vector<std::string>& devices) {
  std::string text = fmt::format("\nThousands of triangles a second, likewise; sizes in radii\n{:<32}", "");
  for (const char* column : {"device", "left to host", "wide", "median width"}) text += fmt::format("{:>14}", column);
  text += '\n';
  for (const std::string& device : devices) {
    for (const TriangleTask& task : all) {
      const std::string row = row_name(device, "triangle_verified", task.name);
      text += fmt::format("{:<32}{:>14.3g}{:>14.6g}{:>14.6g}{:>14.2g}\n", task.name,
                          1e-3 * counter(rows, row, "queries_per_second"), counter(rows, row, "host_verified"),
                          counter(rows, row, "wide"), counter(rows, row, "width_median"));
    }
  }
  return text;
}

std::string table(const Rows& rows, const std::deque<Task>& all, const std::vector<std::string>& devices) {
  std::string text = fmt::format("\nThousands of points a second, to 1e-6 of the model's radius\n{:<32}", "");
  for (const char* column : {"device", "host, 1 core", "left to host", "wide", "median width"})
    text += fmt::format("{:>14}", column);
  text += '\n';
  for (const std::string& device : devices) {
    for (const Task& task : all) {
      const std::string row = row_name(device, "point_verified", task.name);
      text += fmt::format(
          "{:<32}{:>14.3g}{:>14.3g}{:>14.6g}{:>14.6g}{:>14.2g}\n", task.name,
          1e-3 * counter(rows, row, "queries_per_second"),
          1e-3 * counter(rows, row_name("verisq_host", "point_verified", task.name), "queries_per_second"),
          counter(rows, row, "host_verified"), counter(rows, row, "wide"), counter(rows, row, "width_median"));
    }
  }
  return text;
}

void run(int argc, char** argv) {
  const std::vector<DeviceReport> devices = usable_devices();
  if (devices.empty()) fmt::print(stderr, "no OpenCL device passed its self-test: rows of the host only\n");
  const std::deque<Task> all = tasks();
  const std::deque<TriangleTask> triangles = triangle_tasks();
  std::vector<std::string> names;
  for (const DeviceReport& device : devices) {
    names.push_back(tool_name(device));
    benchmark::AddCustomContext(names.back() + "_device", device.name);
    for (const Task& task : all) add_device_row(task, device);
    for (const TriangleTask& task : triangles) add_device_row(task, device);
  }
  for (const Task& task : all) add_host_row(task);
  const Rows rows = run_benchmarks(argc, argv, repetitions);
  fmt::print("{}{}", table(rows, all, names), table(rows, triangles, names));
}

}  // namespace
}  // namespace verisq::bench

int main(int argc, char** argv) {
  return verisq::bench::run_program("solid_distance_bench", verisq::bench::run, argc, argv);
}
