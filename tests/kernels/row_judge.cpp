/// This file implements the launches of both kernels, and the comparison with exact products of powers of two.
#include "tests/kernels/row_judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <span>
#include <vector>
#include <verisq/map.hpp>

#include "host/device/chunk_queue.hpp"
#include "host/device/device.hpp"
#include "host/device/point_pipe.hpp"
#include "host/maps/certified_rows.hpp"
#include "kernels/embedded_sources.hpp"
#include "tests/kernels/kernel_launch.hpp"

namespace verisq::device {
namespace {

using Exact = long double;  // holds every product of a binary64 number and a power of two here

constexpr double tiniest = std::numeric_limits<double>::denorm_min();
constexpr double largest = std::numeric_limits<double>::max();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::array exponents{-1000, -300, -3, 0, 1, 3, 52, 300, 301, 1000};
constexpr std::array<std::size_t, 6> sizes{1, 3, 4, 5, 67, 150};

bool same(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

class Numbers {
 public:
  /// Of moderate size.
  double usual() { return std::ldexp(1.0 + unit_(generator_), static_cast<int>(generator_() % 40) - 20) * sign(); }

  /// Such as leave the range of numbers, normal or all, when they are multiplied by 2^-exponent; NaN and infinities.
  double extreme(int exponent) {
    switch (generator_() % 10) {
      case 0: return std::bit_cast<double>(std::uint64_t{generator_()});
      case 1: return sign() * tiniest * static_cast<double>(generator_() % 100);
      case 2: return sign() * largest / static_cast<double>(1 + generator_() % 3);
      case 3: return sign() * infinity;
      case 4: return nan;
      case 5: return sign() * 0.0;
      // One bit below a power of two: to nearest, products of them become 2^-1022, 2^-1073 or the like.
      case 6: return sign() * near(exponent - 1022, std::nextafter(1.0, 0.0));
      case 7: return sign() * near(exponent - 1074 + static_cast<int>(generator_() % 54), std::nextafter(1.0, 0.0));
      case 8: return sign() * near(exponent - 1074 + static_cast<int>(generator_() % 54), 1.0 + unit_(generator_));
      default: return sign() * near(exponent + 1023 - static_cast<int>(generator_() % 2), 1.0 + unit_(generator_));
    }
  }

  /// Positive; its product with 2^-exponent is not a number where that is below 1.
  double below_all(int exponent) { return near(exponent - 1076, 1.0 + unit_(generator_)); }

  double unit() { return unit_(generator_); }
  bool one_in(std::uint64_t count) { return generator_() % count == 0; }

 private:
  static double near(int exponent, double x) { return std::ldexp(x, std::clamp(exponent, -1074, 1023)); }
  double sign() { return generator_() % 2 == 0 ? 1.0 : -1.0; }

  std::mt19937_64 generator_{1};
  std::uniform_real_distribution<double> unit_{0.0, 1.0};
};

// ---- columns

constexpr double far_away = 0x1p20;  // FAR_AWAY in kernels/row_verdict.clh

bool is_finite(const std::array<std::vector<double>, 3>& memories, const std::array<Layout, 3>& layouts,
               std::size_t n) {
  bool finite = true;
  for (std::size_t i = 0; i < 3; ++i) finite = finite && std::isfinite(memories[i][place(layouts[i], n)]);
  return finite;
}

std::string judged_columns(const Device& device, const cl::Program& program, int exponent, std::size_t size,
                           const std::array<Layout, 3>& layouts, bool finite, Numbers& numbers) {
  const auto width = static_cast<std::size_t>(device.vector_width);
  const std::size_t padded = (size + width - 1) / width * width;
  const Scale scale(exponent);
  std::size_t length = 0;
  for (const Layout& layout : layouts) length = std::max(length, extent(layout, size));
  std::array<std::vector<double>, 3> memories;
  for (std::vector<double>& memory : memories) {
    memory.resize(length);
    for (double& x : memory) x = numbers.usual();
  }
  if (!finite) memories[size % 3][place(layouts[size % 3], size / 2)] = size % 2 == 0 ? infinity : nan;

  const Launcher launcher(device);
  NamedKernel kernel(program, kernels::embedded_point_sources(), "point_columns");
  std::array<cl::Buffer, 3> inputs;
  for (std::size_t i = 0; i < 3; ++i) inputs[i] = launcher.uploaded(memories[i]);
  std::array<cl::Buffer, 3> outputs;
  for (cl::Buffer& output : outputs) output = launcher.uploaded(std::vector<double>(padded + 1, -7.0));
  std::vector<cl_uint> refused{0};
  const cl::Buffer flag = launcher.uploaded(refused);
  const std::size_t vectors = 2;
  kernel.set("size", size);
  kernel.set("vectors", vectors);
  kernel.set("factor", scale.factor());
  constexpr std::array axes{"x", "y", "z"};
  for (std::size_t i = 0; i < 3; ++i) set(kernel, axes[i], inputs[i], layouts[i]);
  kernel.set(coordinate_arguments, outputs);
  kernel.set("refused", flag);
  launcher.launch(kernel, (padded / width + vectors - 1) / vectors + 1, 1);

  launcher.download(flag, refused);
  if ((refused[0] == 0) != finite) return fmt::format("{} points: refused {}", size, refused[0]);
  std::array<std::vector<double>, 3> columns;
  for (std::size_t i = 0; i < 3; ++i) {
    columns[i].resize(padded + 1);
    launcher.download(outputs[i], columns[i]);
    if (columns[i][padded] != -7.0) return fmt::format("{} points: a number beyond column {}", size, i);
  }
  for (std::size_t n = 0; n < padded; ++n) {
    const std::size_t known = std::min(n, size - 1);
    const bool known_finite = is_finite(memories, layouts, known);
    for (std::size_t i = 0; i < 3; ++i) {
      const double expected = known_finite ? scale.to_device(memories[i][place(layouts[i], known)]) : far_away;
      if (columns[i][n] != expected)
        return fmt::format("{} points, scale {}: coordinate {} of {} is {:.17g}, not {:.17g}", size, exponent, i, n,
                           columns[i][n], expected);
    }
  }
  return {};
}

// ---- rows

struct RowScene {
  int exponent;
  std::size_t size;
  RowCriterion criterion;
  std::array<Layout, 2> ends;
  Layout status;
  std::size_t local;  // work-items a work-group
};

std::string described(const RowScene& scene, std::size_t n, const Enclosure& scaled, const MapResult& row) {
  return fmt::format("scale {}, tolerance {}, row {} of {}: [{}, {}] became [{}, {}], status {}", scene.exponent,
                     scene.criterion.tolerance, n, scene.size, scaled.lo, scaled.hi, row.distance.lo, row.distance.hi,
                     static_cast<int>(row.status));
}

// By exact arithmetic: an enclosure of the exact one, and no tighter one is.
bool is_outermost(const RowScene& scene, const Enclosure& scaled, const Enclosure& row) {
  const auto below = [&](double x, double bound) {
    if (std::isnan(x)) return std::isnan(bound);
    const Exact exact = std::ldexp(static_cast<Exact>(x), -scene.exponent);
    if (static_cast<Exact>(bound) > exact) return false;
    return bound == infinity || static_cast<Exact>(std::nextafter(bound, infinity)) > exact;
  };
  return below(scaled.lo, row.lo) && below(-scaled.hi, -row.hi);
}

// Of the host: as tight as the methods get. Never where the coordinate has left the device's numbers.
bool is_tightest(const RowScene& scene, const Point& point, const Enclosure& row) {
  const double inside = scene.criterion.inside;
  if (row.hi < 0.0) return verified(row, inside);
  const bool held = std::isfinite(Scale(scene.exponent).to_device(verisq::verify::largest_coordinate(point)));
  return held && verified(row, tightest_width(point, row, scene.criterion.radius));
}

enum class Ends { usual, extreme, one_inexact };

/// In the device's numbers, where the radius is about 1.
Enclosure ends_of_row(Ends kind, int exponent, Numbers& numbers) {
  // As narrow as can be: only one of the ends is not exact in model units.
  if (kind == Ends::one_inexact) {
    const double tiny = numbers.below_all(exponent);
    return exponent % 2 == 0 ? Enclosure{-tiny, 0.0} : Enclosure{0.0, tiny};
  }
  constexpr std::array widths{0.0, 1e-15, 5e-13, 1e-11, 1.5e-9, 3e-9, 1e-6, 1e-3, -1e-10};
  const double width = widths[static_cast<std::size_t>(numbers.unit() * widths.size())];
  double lo = numbers.one_in(3) ? -numbers.unit() : 3.0 * numbers.unit();
  if (numbers.one_in(8)) lo = -0.5 * width;  // neither inside nor outside
  double hi = lo + width;
  if (kind == Ends::extreme && numbers.one_in(2)) lo = numbers.extreme(exponent);
  if (kind == Ends::extreme && numbers.one_in(2)) hi = numbers.one_in(2) ? lo : numbers.extreme(exponent);
  return {lo, hi};
}

std::string judged_rows(const Device& device, const cl::Program& program, const RowScene& scene, Ends kind,
                        Numbers& numbers) {
  const auto width = static_cast<std::size_t>(device.vector_width);
  const std::size_t padded = (scene.size + width - 1) / width * width;
  const Scale scale(scene.exponent);
  std::vector<Point> points(padded);
  std::array<std::vector<double>, 3> coordinates;
  std::vector<double> los;
  std::vector<double> his;
  for (Point& point : points) {
    const double unit = scene.criterion.radius * (numbers.one_in(5) ? 100.0 : 1.0);
    for (std::size_t i = 0; i < 3; ++i) {
      point[i] = (2.0 * numbers.unit() - 1.0) * unit;
      coordinates[i].push_back(scale.to_device(point[i]));
    }
    const Enclosure ends = ends_of_row(kind, scene.exponent, numbers);
    los.push_back(ends.lo);
    his.push_back(ends.hi);
  }

  const Launcher launcher(device);
  NamedKernel kernel(program, kernels::embedded_point_sources(), "point_rows");
  constexpr std::size_t vectors = 2;
  const std::size_t rows_of_group = vectors * width * scene.local;
  const std::size_t groups = (scene.size + rows_of_group - 1) / rows_of_group;
  constexpr double untouched = -7.0;
  std::vector<double> memory(std::max(extent(scene.ends[0], scene.size), extent(scene.ends[1], scene.size)) + 1,
                             untouched);
  std::vector<std::uint8_t> bytes(extent(scene.status, scene.size) + 1, 77);
  std::vector<RowSums> sums(groups);
  const cl::Buffer ends = launcher.uploaded(memory);
  const cl::Buffer status = launcher.uploaded(bytes);
  const cl::Buffer totals = launcher.uploaded(sums);
  const std::array<cl::Buffer, 3> columns{launcher.uploaded(coordinates[0]), launcher.uploaded(coordinates[1]),
                                          launcher.uploaded(coordinates[2])};
  const std::array<cl::Buffer, 2> scaled_ends{launcher.uploaded(los), launcher.uploaded(his)};
  kernel.set("size", scene.size);
  kernel.set("vectors", vectors);
  kernel.set("factor", scale.factor());
  kernel.set("inverse", scale.inverse());
  kernel.set("tolerance", scene.criterion.tolerance);
  kernel.set("inside", scene.criterion.inside);
  kernel.set("outside", scene.criterion.outside);
  kernel.set("radius", scene.criterion.radius);
  kernel.set(coordinate_arguments, columns);
  kernel.set(union_arguments, scaled_ends);
  set(kernel, "lo", ends, scene.ends[0]);
  set(kernel, "hi", ends, scene.ends[1]);
  set(kernel, "status", status, scene.status);
  kernel.set("sums", totals);
  kernel.set("of_items", cl::Local(scene.local * sizeof(RowSums)));
  launcher.launch(kernel, groups, scene.local);
  launcher.download(ends, memory);
  launcher.download(status, bytes);
  launcher.download(totals, sums);

  std::vector<MapSummary> expected(groups, empty_summary());
  std::vector<std::size_t> open(groups, 0);
  std::vector<std::size_t> open_inside(groups, 0);
  for (std::size_t n = 0; n < scene.size; ++n) {
    double& lo = memory[place(scene.ends[0], n)];
    double& hi = memory[place(scene.ends[1], n)];
    std::uint8_t& byte = bytes[place(scene.status, n)];
    const MapResult row{{lo, hi}, static_cast<Status>(byte)};
    const Enclosure scaled{los[n], his[n]};
    const Enclosure by_host = scale.to_model(scaled);
    const bool tightest = is_tightest(scene, points[n], by_host);
    const bool good = verified(by_host, scene.criterion.tolerance) || (scene.criterion.tolerance == 0.0 && tightest);
    const Status right = good ? Status::device_verified : Status::wide;
    if (!same(lo, by_host.lo) || !same(hi, by_host.hi) || !is_outermost(scene, scaled, row.distance) ||
        byte != static_cast<std::uint8_t>(right))
      return described(scene, n, scaled, row);
    const std::size_t group = n / rows_of_group;
    if (good || tightest) {
      count(expected[group], {by_host, right});
    } else {
      ++open[group];
      if (!(by_host.lo > 0.0)) ++open_inside[group];
    }
    lo = hi = untouched;
    byte = 77;
  }
  for (std::size_t group = 0; group < groups; ++group) {
    const RowSums& is = sums[group];
    const MapSummary& right = expected[group];
    if (is.minimum_lo != right.minimum_lo || is.minimum_hi != right.minimum_hi ||
        is.largest_width != right.largest_width || is.verified != right.device_verified || is.wide != right.wide ||
        is.wide_inside != right.wide_inside || is.open != open[group] || is.open_inside != open_inside[group])
      return fmt::format("scale {}, tolerance {}, {} rows: the sums of group {} are wrong", scene.exponent,
                         scene.criterion.tolerance, scene.size, group);
  }
  const bool kept = std::ranges::all_of(memory, [](double x) { return x == untouched; }) &&
                    std::ranges::all_of(bytes, [](std::uint8_t x) { return x == 77; });
  return kept ? std::string() : fmt::format("{} rows: memory between the rows is written to", scene.size);
}

}  // namespace

std::string false_columns(const Device& device, const cl::Program& program) {
  Numbers numbers;
  for (const std::size_t size : sizes) {
    const std::size_t last = size - 1;
    const std::array<std::array<Layout, 3>, 4> all{{{{{0, 3}, {1, 3}, {2, 3}}},
                                                    {{{0, 1}, {size, 1}, {2 * size, 1}}},
                                                    {{{5 * last, -5}, {1 + 5 * last, -5}, {2, 7}}},
                                                    {{{0, 0}, {1, 2}, {2 + last, -1}}}}};
    for (const std::array<Layout, 3>& layouts : all) {
      for (const int exponent : {-300, 0, 2}) {
        for (const bool finite : {true, false}) {
          std::string found = judged_columns(device, program, exponent, size, layouts, finite, numbers);
          if (!found.empty()) return found;
        }
      }
    }
  }
  return {};
}

std::string false_rows(const Device& device, const cl::Program& program) {
  constexpr std::array<std::size_t, 5> work_items{1, 4, 4, 4, 4};  // a work-group
  Numbers numbers;
  std::size_t turn = 0;
  for (const int exponent : exponents) {
    const double radius = std::ldexp(1.3, -exponent);
    for (const std::size_t size : sizes) {
      const std::size_t last = size - 1;
      const std::array<std::array<Layout, 3>, 3> all{
          {{{{0, 1}, {size, 1}, {0, 1}}}, {{{0, 3}, {1, 3}, {16, 24}}}, {{{2 * last, -2}, {1, 2}, {3 * last, -3}}}}};
      for (const double tolerance : {0.0, 1e-12 * radius, 1e-5 * radius}) {
        for (const Ends kind : {Ends::usual, Ends::extreme, Ends::one_inexact}) {
          const auto& [lo, hi, status] = all[turn % all.size()];
          const double inside = tolerance > 0.0 && turn % 2 == 0 ? -1.0 : tightest_inside * radius;
          const RowScene scene{exponent, size,   {tolerance, inside, tightest_outside, radius},
                               {lo, hi}, status, work_items[turn % work_items.size()]};
          std::string found = judged_rows(device, program, scene, kind, numbers);
          if (!found.empty()) return found;
          ++turn;
        }
      }
    }
  }
  return {};
}

}  // namespace verisq::device
