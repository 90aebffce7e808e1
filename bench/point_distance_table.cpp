/// Formats the medians of the point distance benchmark.
#include "bench/point_distance_table.hpp"

#include <fmt/format.h>

#include "bench/paper_tables.hpp"
#include "bench/row_counters.hpp"

namespace verisq::bench {
namespace {

double rate(const Rows& rows, std::string_view tool, std::string_view what, std::string_view object) {
  return counter(rows, row_name(tool, what, object), "points_per_second");
}

std::string table6(const Rows& rows, std::string_view tool) {
  std::string text = fmt::format(
      "Table 6, point to superquadric, outside: the paper (GJK, 1.6 GHz Core 2 Duo) and {} (all cores)\n"
      "seconds a point; enclosures: width, and width / midpoint; ours are medians and means over all points\n"
      "{:<20}{:>12}{:>12}{:>12}{:>12}{:>12}{:>12}\n",
      tool, "", "unverified", "verified", "width", "mean", "relative", "mean");
  for (const BenchmarkObject& object : table5_objects) {
    const std::string mapped = row_name(tool, "point_outside", object.name);
    text += fmt::format("{:<20}{:>12.3g}{:>12.3g}{:>12}{:>12.3g}{:>12}{:>12.3g}\n",
                        fmt::format("{} paper", object.name), object.paper.seconds, object.paper.verified_seconds, "",
                        object.paper.absolute_error, "", object.paper.relative_error);
    text += fmt::format("{:<20}{:>12.3g}{:>12.3g}{:>12.3g}{:>12.3g}{:>12.3g}{:>12.3g}\n",
                        fmt::format("{} ours", object.name),
                        1.0 / rate(rows, tool, "point_outside_solver_only", object.name),
                        1.0 / rate(rows, tool, "point_outside", object.name), counter(rows, mapped, "width_median"),
                        counter(rows, mapped, "width_mean"), counter(rows, mapped, "relative_width_median"),
                        counter(rows, mapped, "relative_width_mean"));
  }
  return text;
}

std::string costs(const Rows& rows, std::string_view tool) {
  std::string text = fmt::format("{}: millions of points a second, and what they are worth\n{:<44}", tool, "");
  for (const BenchmarkObject& object : table5_objects) text += fmt::format("{:>12}", object.name);
  text += '\n';
  const auto line = [&](std::string_view label, auto figure) {
    text += fmt::format("{:<44}", label);
    for (const BenchmarkObject& object : table5_objects) text += fmt::format("{:>12.3g}", figure(object.name));
    text += '\n';
  };
  const auto of = [&](std::string_view what) {
    return [&rows, tool, what](std::string_view object) { return rate(rows, tool, what, object); };
  };
  const auto peer = [&](std::string_view object) { return rate(rows, "fcl_libccd", "point_outside", object); };
  line("outside, verified, map (M points/s)", [&](auto object) { return 1e-6 * of("point_outside")(object); });
  line("outside, verified, map of a stream (M points/s)",
       [&](auto object) { return 1e-6 * of("point_outside_stream")(object); });
  line("outside, verified, kernel (M points/s)",
       [&](auto object) { return 1e-6 * of("point_outside_kernel")(object); });
  line("outside, solver only, kernel (M points/s)",
       [&](auto object) { return 1e-6 * of("point_outside_solver_only")(object); });
  line("inside, 1e-6 of the size, map (M points/s)", [&](auto object) { return 1e-6 * of("point_inside")(object); });
  line("fcl_libccd, unverified, one core (M points/s)", [&](auto object) { return 1e-6 * peer(object); });
  line("ratio to fcl_libccd, map", [&](auto object) { return of("point_outside")(object) / peer(object); });
  line("ratio to fcl_libccd, kernel", [&](auto object) { return of("point_outside_kernel")(object) / peer(object); });
  line("verification costs, % over the solver", [&](auto object) {
    return 100.0 * (of("point_outside_solver_only")(object) / of("point_outside_kernel")(object) - 1.0);
  });
  line("tapered / untapered kernel",
       [&](auto object) { return of("point_outside_tapered_kernel")(object) / of("point_outside_kernel")(object); });
  line("map / kernel", [&](auto object) { return of("point_outside")(object) / of("point_outside_kernel")(object); });
  line("the host's own time in the map (ns/point)",
       [&](auto object) { return counter(rows, row_name(tool, "point_outside", object), "host_ns_a_point"); });
  line("peak fraction, kernel",
       [&](auto object) { return counter(rows, row_name(tool, "point_outside_kernel", object), "peak_fraction"); });
  return text;
}

std::string peer_errors(const Rows& rows) {
  std::string text =
      fmt::format("fcl_libccd against our enclosures, outside, GJK tolerance 1e-6\n{:<20}{:>16}{:>16}{:>16}{:>16}\n",
                  "", "above hi, %", "below lo, %", "largest above", "largest below");
  for (const BenchmarkObject& object : table5_objects) {
    const auto figure = [&](const char* name) {
      return counter(rows, row_name("fcl_libccd", "point_outside", object.name), name);
    };
    text += fmt::format("{:<20}{:>16.4g}{:>16.4g}{:>16.3g}{:>16.3g}\n", object.name, 100.0 * figure("errs_upwards"),
                        100.0 * figure("errs_downwards"), figure("largest_error_upwards"),
                        figure("largest_error_downwards"));
  }
  return text;
}

}  // namespace

std::string point_distance_tables(const Rows& rows, std::span<const std::string> tools) {
  std::string text;
  for (const std::string& tool : tools) text += fmt::format("\n{}\n{}", table6(rows, tool), costs(rows, tool));
  return text + "\n" + peer_errors(rows);
}

}  // namespace verisq::bench
