/// Points through the pipe, in memory of any stride, shared or copied: the enclosures that the batch of points finds,
/// bit for bit.
#include "host/device/point_pipe.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>
#include <verisq/distance.hpp>

#include "host/device/query_batches.hpp"
#include "host/maps/certified_rows.hpp"

namespace verisq::device {
namespace {

struct Scene {
  const char* name;
  Model model;
  double unit;
};

/// Sizes of all powers that a device takes.
std::vector<Scene> scenes() {
  const auto scaled = [](double unit, std::size_t primitives) {
    Model model{"", {}};
    for (std::size_t i = 0; i < primitives; ++i) {
      const double x = 0.8 * static_cast<double>(i);
      model.primitives.push_back({"", {{unit, 1.5 * unit, 0.6 * unit}, {1.0, 1.2}}, {{x * unit, 0.0, 0.0}}});
    }
    return model;
  };
  return {{"one", scaled(1.0, 1), 1.0},
          {"three", scaled(0.7, 3), 0.7},
          {"tiny", scaled(1e-290, 1), 1e-290},
          {"huge", scaled(1e280, 3), 1e280}};
}

std::vector<Point> points_about(double unit, std::size_t count) {
  std::mt19937_64 generator(count);
  std::uniform_real_distribution<double> within(-3.0, 3.0);
  std::vector<Point> points(count);
  for (Point& point : points)
    for (double& x : point) x = within(generator) * unit * (generator() % 50 == 0 ? 1e-3 : 1.0);
  return points;
}

class PointPipeTest : public ::testing::TestWithParam<MemoryAccess> {
 protected:
  void SetUp() override {
    if (!selection_.device) GTEST_SKIP() << "no OpenCL device: " << selection_.notice;
  }

  [[nodiscard]] std::unique_ptr<PointPipe> pipe(const Scene& scene, double tolerance) const {
    const double radius = bounding_radius(scene.model);
    return point_pipe(*selection_.device, scene.model, {tolerance, tightest_inside * radius, tightest_outside, radius},
                      GetParam());
  }

  const Selection selection_ = select_device("auto");
};

/// Memory where coordinates and rows lie about: every value in a struct of its own.
struct Scattered {
  double z, lo;
  Status status;
  double y, other, hi, x;
};

void expect_same(const Enclosure& a, const Enclosure& b, const std::string& where) {
  const auto same = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
  EXPECT_TRUE(same(a.lo, b.lo) && same(a.hi, b.hi))
      << fmt::format("{}: [{}, {}], not [{}, {}]", where, a.lo, a.hi, b.lo, b.hi);
}

/// Those of `points` that lie farther from the scene's solids than these are large.
std::vector<Point> far_from(double unit, std::vector<Point> points) {
  for (Point& point : points) point[1] += 10.0 * unit;
  return points;
}

/// Depths are searched from the first chunk on that has points inside, also of chunks that were under way before.
TEST_P(PointPipeTest, FindsDepthsWhereverTheyBegin) {
  constexpr std::size_t size = 2000;
  for (const Scene& scene : scenes()) {
    const double tolerance = 1e-6 * scene.unit;
    const std::vector<Point> about = points_about(scene.unit, size);
    const std::vector<Point> far = far_from(scene.unit, about);
    const auto batch = point_batch(*selection_.device, scene.model, tolerance, false);
    const auto through = pipe(scene, tolerance);
    const std::vector<const std::vector<Point>*> chunks{&far, &about, &about, &far, &about};
    std::vector<std::vector<MapResult>> rows(chunks.size(), std::vector<MapResult>(size));
    through->submit(*chunks.front(), rows.front());
    for (std::size_t i = 0; i < chunks.size(); ++i) {
      if (i + 1 < chunks.size()) through->submit(*chunks[i + 1], rows[i + 1]);
      EXPECT_FALSE(through->collect().refused);
    }
    for (std::size_t i = 0; i < chunks.size(); ++i) {
      batch->submit(*chunks[i]);
      std::vector<Enclosure> expected;
      std::vector<Certificate> none;
      batch->collect(expected, none);
      for (std::size_t n = 0; n < size; ++n)
        expect_same(rows[i][n].distance, expected[n], fmt::format("{}, {} of chunk {}", scene.name, n, i));
    }
  }
}

TEST_P(PointPipeTest, FindsWhatTheBatchFinds) {
  for (const Scene& scene : scenes()) {
    const double tolerance = 1e-6 * scene.unit;
    const auto batch = point_batch(*selection_.device, scene.model, tolerance, false);
    const auto through = pipe(scene, tolerance);
    for (const std::size_t size : {1U, 7U, 8U, 15U, 16U, 17U, 33U, 1023U, 1024U, 1025U, 3000U}) {
      const std::vector<Point> points = points_about(scene.unit, size);
      batch->submit(points);
      std::vector<Enclosure> expected;
      std::vector<Certificate> none;
      batch->collect(expected, none);

      std::vector<MapResult> rows(size);
      std::vector<Scattered> scattered(size);
      for (std::size_t i = 0; i < size; ++i)
        scattered[i] = {points[i][2], 0.0, Status::wide, points[i][1], 5.0, 0.0, points[i][0]};
      constexpr std::ptrdiff_t step = sizeof(Scattered) / sizeof(double);
      Scattered& first = scattered.front();
      through->submit(points, rows);
      through->submit({size, {&first.x, step}, {&first.y, step}, {&first.z, step}},
                      {size, {&first.lo, step}, {&first.hi, step}, {&first.status, sizeof(Scattered)}});
      EXPECT_FALSE(through->collect().refused);
      const ChunkOutcome outcome = through->collect();
      EXPECT_FALSE(outcome.refused);
      std::size_t rows_of_blocks = 0;
      for (const RowBlock& block : outcome.blocks) {
        EXPECT_EQ(block.first, rows_of_blocks);
        rows_of_blocks += block.count;
      }
      EXPECT_EQ(rows_of_blocks, size);
      for (std::size_t i = 0; i < size; ++i) {
        const std::string where = fmt::format("{}, {} of {}", scene.name, i, size);
        expect_same(rows[i].distance, expected[i], where);
        EXPECT_EQ(rows[i].status == Status::device_verified, verified(expected[i], tolerance)) << where;
        expect_same({scattered[i].lo, scattered[i].hi}, expected[i], where);
        EXPECT_EQ(scattered[i].status, rows[i].status) << where;
        EXPECT_EQ(scattered[i].other, 5.0) << where;
        EXPECT_EQ((Point{scattered[i].x, scattered[i].y, scattered[i].z}), points[i]) << where;
      }
    }
  }
}

TEST_P(PointPipeTest, RefusesWhatIsNotFiniteAndGoesOn) {
  const Scene scene = scenes().front();
  const auto through = pipe(scene, 1e-6);
  std::vector<Point> points = points_about(1.0, 100);
  std::vector<MapResult> rows(points.size());
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), infinity, -infinity}) {
    for (std::size_t i = 0; i < 3; ++i) {
      const double good = std::exchange(points[97][i], bad);
      through->submit(points, rows);
      EXPECT_TRUE(through->collect().refused) << bad;
      points[97][i] = good;
      through->submit(points, rows);
      EXPECT_FALSE(through->collect().refused) << bad;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Memory, PointPipeTest, ::testing::Values(MemoryAccess::of_device, MemoryAccess::by_copies),
                         [](const auto& test) {
                           return test.param == MemoryAccess::of_device ? "OfDevice" : "ByCopies";
                         });

}  // namespace
}  // namespace verisq::device
