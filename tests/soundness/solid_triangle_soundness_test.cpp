/// Soundness for triangles about bent and combined models: no enclosure, of the host or of a device, misses the exact
/// distance.
///
/// The random models of tests/oracle/random_solids.hpp, and triangles of all sizes about their points, degenerate ones
/// among them, against points that MPFR proves to lie in the solid (from above) and an octree about a triangle's centre
/// (from below; tests/oracle/solid_reference.hpp). VERISQ_SOLID_TRIANGLES sets the number of triangles for the device,
/// the host takes a tenth of them:
///   VERISQ_SOLID_TRIANGLES=20000 build/release/tests/soundness_test --gtest_filter='SolidTriangleSoundness*'
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <span>
#include <string>
#include <vector>
#include <verisq/device.hpp>
#include <verisq/distance.hpp>
#include <verisq/map.hpp>

#include "tests/fixtures/requested_count.hpp"
#include "tests/oracle/in_parallel.hpp"
#include "tests/oracle/random_solids.hpp"
#include "tests/oracle/solid_escape.hpp"

namespace verisq::oracle {
namespace {

constexpr double relative_tolerance = 1e-6;
constexpr std::size_t cubes = 1000;
constexpr std::size_t triangles_a_model = 40;

[[nodiscard]] std::size_t requested_triangles() {
  return requested_count("VERISQ_SOLID_TRIANGLES", 36);
}

[[nodiscard]] Point along(const Point& a, const Point& b, double way) {
  return {a[0] + way * (b[0] - a[0]), a[1] + way * (b[1] - a[1]), a[2] + way * (b[2] - a[2])};
}

[[nodiscard]] double apart(const Point& a, const Point& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/// Of the segment, in floating point.
[[nodiscard]] Point closest_of_segment(const Point& x, const Point& a, const Point& b) {
  double squared = 0.0;
  double product = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    squared += (b[i] - a[i]) * (b[i] - a[i]);
    product += (x[i] - a[i]) * (b[i] - a[i]);
  }
  return squared > 0.0 ? along(a, b, std::clamp(product / squared, 0.0, 1.0)) : a;
}

/// Of the triangle, about: alternately along the two edges from its first corner and between them.
[[nodiscard]] Point closest_of_triangle(const Point& x, const Triangle& t) {
  Point best = closest_of_segment(x, t[0], t[1]);
  const auto offer = [&](const Point& p) {
    if (apart(x, p) < apart(x, best)) best = p;
  };
  offer(closest_of_segment(x, t[1], t[2]));
  offer(closest_of_segment(x, t[2], t[0]));
  // The distance to x is convex over the triangle: golden sections of a fan of segments.
  const auto of_fan = [&](double way) { return closest_of_segment(x, t[0], along(t[1], t[2], way)); };
  constexpr double golden = 0.6180339887498949;
  double low = 0.0;
  double high = 1.0;
  for (int i = 0; i < 60; ++i) {
    const double first = high - golden * (high - low);
    const double second = low + golden * (high - low);
    if (apart(x, of_fan(first)) < apart(x, of_fan(second))) {
      high = second;
    } else {
      low = first;
    }
  }
  offer(of_fan(0.5 * (low + high)));
  return best;
}

/// A corner at a hard point, the others near or far; some are segments, points or needles.
[[nodiscard]] Triangle random_triangle(RandomSolids& solids, RandomCases& random, const PlacedModel& placed,
                                       std::size_t i) {
  const Point at = solids.point(placed, solid_point_families[i % solid_point_families.size()]);
  const double size = placed.bounding_ball().radius * random.log_uniform(1e-6, 4.0);
  const auto moved = [&](const Point& from, double length) {
    const Point way = random.direction();
    return Point{from[0] + length * way[0], from[1] + length * way[1], from[2] + length * way[2]};
  };
  Triangle triangle{at, moved(at, size), moved(at, size * random.uniform(0.1, 1.0))};
  switch (random.choice(8)) {
    case 0: triangle[2] = triangle[1]; break;
    case 1: triangle[1] = triangle[2] = triangle[0]; break;
    case 2: triangle[2] = moved(along(triangle[0], triangle[1], random.uniform(-1.0, 1.0)), 1e-9 * size); break;
    default: break;
  }
  std::ranges::rotate(triangle, triangle.begin() + static_cast<std::ptrdiff_t>(random.choice(3)));
  return triangle;
}

struct Group {
  Model model;
  std::vector<Triangle> triangles;

  Group(std::uint64_t index, std::size_t count) {
    RandomSolids solids(5000 + index);
    RandomCases random(index);
    do {
      model = solids.model(model_families[index % model_families.size()]);
    } while (SolidReference(model).points_of_solid().empty());
    const PlacedModel placed(model);
    for (std::size_t i = 0; i < count; ++i) triangles.push_back(random_triangle(solids, random, placed, i));
  }

  [[nodiscard]] double size() const { return PlacedModel(model).bounding_ball().radius; }
  [[nodiscard]] double tolerance() const { return relative_tolerance * size(); }
};

/// At least the distance of the triangle: from points of it, in turn with points of the solid that MPFR proves.
[[nodiscard]] double distance_found(const SolidReference& reference, const Triangle& t) {
  double least = std::numeric_limits<double>::infinity();
  std::array<Point, 5> starts{t[0], t[1], t[2], along(t[0], along(t[1], t[2], 0.5), 2.0 / 3.0), Point{}};
  starts[4] = closest_of_triangle(reference.placed().bounding_ball().centre, t);
  for (Point x : starts) {
    for (int step = 0; step < 3; ++step) {
      const Point near = reference.nearest(x, Membership::inside);
      least = std::min(least, apart(x, near));
      if (!std::isfinite(near[0]) || least == 0.0) break;
      x = closest_of_triangle(near, t);
      least = std::min(least, apart(x, near));
    }
  }
  return least;
}

/// At most the distance of the triangle: what an octree finds free about its middle, less the way to the corners.
[[nodiscard]] double distance_free(const SolidReference& reference, const Triangle& t) {
  const Point middle = along(t[0], along(t[1], t[2], 0.5), 2.0 / 3.0);
  const double way = std::max({apart(middle, t[0]), apart(middle, t[1]), apart(middle, t[2])});
  return reference.facts(middle, cubes).lower.convert_to<double>() - way;
}

struct Tally {
  std::mutex mutex;
  std::size_t cases = 0;
  std::size_t wide = 0;
  std::size_t met = 0;
  std::size_t sharp = 0;  ///< a lower end 1e-5 of the size higher would have been found out

  void add(const Group& group, std::size_t i, const Enclosure& proven, double free, double found) {
    const std::lock_guard lock(mutex);
    // Roundings of the reference's own points and ways.
    double coordinates = 0.0;
    for (const Point& corner : group.triangles[i])
      for (const double c : corner) coordinates = std::max(coordinates, std::fabs(c));
    const double rounding = 1e-13 * (group.size() + coordinates);
    const std::string what = fmt::format("{}\n{:.17g}", model_json(group.model), fmt::join(group.triangles[i][0], ","));
    EXPECT_LE(proven.lo, found + rounding) << what;
    EXPECT_GE(proven.hi, free - rounding) << what;
    EXPECT_GE(proven.lo, 0.0) << what;
    ++cases;
    wide += verified(proven, group.tolerance()) ? 0 : 1;
    met += proven.hi == 0.0 ? 1 : 0;
    sharp += found - proven.lo < 1e-5 * group.size() ? 1 : 0;
  }

  void expect_sharp(const std::string& prover) const {
    fmt::print("{:<40}{:>8} triangles{:>8} wide{:>8} meet the solid{:>8} sharp\n", prover, cases, wide, met, sharp);
    EXPECT_GT(2 * sharp, cases) << "the reference would hardly notice an escape";
    EXPECT_GT(met, 0U);
  }
};

template <class Prove>
void expect_sound(const std::string& prover, std::size_t triangles, const Prove& prove) {
  Tally tally;
  const std::size_t models = std::max(model_families.size(), triangles / triangles_a_model);
  const std::size_t count = std::max<std::size_t>(1, triangles / models);
  in_parallel(models, [&](std::size_t index) {
    const Group group(index, count);
    const SolidReference reference(group.model);
    const std::vector<Enclosure> proven = prove(group);
    for (std::size_t i = 0; i < count; ++i) {
      tally.add(group, i, proven.at(i), distance_free(reference, group.triangles[i]),
                distance_found(reference, group.triangles[i]));
    }
  });
  tally.expect_sharp(prover);
}

TEST(SolidTriangleSoundnessTest, HostContainsTheReference) {
  expect_sound("host", requested_triangles(), [](const Group& group) {
    const TriangleSearch search(group.model);
    std::vector<Enclosure> proven;
    // Some take thousands of points, each a search: what is proven by then has to be valid, too.
    for (const Triangle& triangle : group.triangles) {
      std::size_t polled = 0;
      proven.push_back(search(triangle, group.tolerance(), [&] { return ++polled > 2000; }));
    }
    return proven;
  });
}

TEST(SolidTriangleSoundnessTest, DeviceContainsTheReference) {
  const std::vector<DeviceReport> devices = test_devices();
  if (devices.empty()) GTEST_SKIP() << "NO OPENCL DEVICE: the soundness of the kernels was NOT tested";
  const auto passed = std::find_if(devices.begin(), devices.end(), [](const DeviceReport& d) { return d.passed; });
  ASSERT_NE(passed, devices.end()) << "no device passed its self-test: " << devices.front().failure;
  std::mutex one_at_a_time;
  const auto prove = [&](const Group& group) {
    const std::lock_guard lock(one_at_a_time);
    MapOptions options{.tolerance = group.tolerance(), .device = std::to_string(passed->index)};
    std::vector<double> los(group.triangles.size());
    std::vector<double> his(group.triangles.size());
    std::vector<Status> statuses(group.triangles.size());
    std::size_t polled = 0;
    std::mutex polling;
    // What the device leaves to the host may take seconds each: the map goes on without.
    options.out_of_time = [&] {
      const std::lock_guard count(polling);
      return ++polled > 4'000;
    };
    TriangleMapper(group.model, options).map(std::span<const Triangle>(group.triangles), {los, his, statuses});
    std::vector<Enclosure> proven;
    for (std::size_t i = 0; i < los.size(); ++i) proven.push_back({los[i], his[i]});
    return proven;
  };
  expect_sound(passed->name, requested_triangles(), prove);
}

}  // namespace
}  // namespace verisq::oracle
