/// Tightness, the second promise: how narrow the enclosures of the paper's Table 5 objects are, through PointMapper.
///
/// 100,000 points a test: outside uniform in the box of three times the semi-axes, inside in the box of the semi-axes;
/// those on the wrong side are drawn again.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/fixtures/map_in_memory.hpp"
#include "tests/oracle/mixed_norm.hpp"
#include "tests/oracle/random_cases.hpp"

namespace verisq::oracle {
namespace {

constexpr std::size_t point_count = 100'000;

struct TableObject {
  std::string name;
  Superquadric superquadric;

  [[nodiscard]] double size() const {
    return *std::max_element(superquadric.semi_axes.begin(), superquadric.semi_axes.end());
  }
  [[nodiscard]] Model model() const { return {"", {{name, superquadric, {}}}}; }
};

class TightnessTest : public testing::TestWithParam<TableObject> {
 protected:
  /// Uniform in the box of `reach` times the semi-axes, on the wanted side of the boundary.
  static std::vector<Point> points(const TableObject& object, double reach, bool outside) {
    RandomCases random(6);
    const MixedNorm<double> norm(object.superquadric);
    std::vector<Point> points;
    while (points.size() < point_count) {
      Point q;
      for (std::size_t i = 0; i < 3; ++i) q[i] = reach * object.superquadric.semi_axes[i] * random.uniform(-1, 1);
      if ((norm.gauge(q) > 1) == outside) points.push_back(q);
    }
    return points;
  }
};

[[nodiscard]] double quantile(const std::vector<double>& sorted, double share) {
  return sorted[static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size()))) - 1];
}

TEST_P(TightnessTest, OutsideAtToleranceZero) {
  const TableObject& object = GetParam();
  const std::vector<Point> queries = points(object, 3, true);
  const FinishedMap map = map_in_memory(object.model(), queries, {.tolerance = 0.0});
  ASSERT_EQ(map.rows.size(), queries.size());
  std::vector<double> widths;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    widths.push_back(map.rows[i].distance.width() / std::max(length(queries[i]), object.size()));
  }
  std::sort(widths.begin(), widths.end());
  fmt::print("{}, outside, {}: relative width, median {:.3g}, 99 % {:.3g}, 99.9 % {:.3g}, all {:.3g}\n", object.name,
             map.summary.device, quantile(widths, 0.5), quantile(widths, 0.99), quantile(widths, 0.999), widths.back());
  EXPECT_LE(quantile(widths, 0.5), 1e-14);
  EXPECT_LE(quantile(widths, 0.999), 1e-12);
  EXPECT_LE(widths.back(), 1e-9);
}

TEST_P(TightnessTest, InsideAtOneMillionthOfTheSize) {
  const TableObject& object = GetParam();
  const std::vector<Point> queries = points(object, 1, false);
  const double tolerance = 1e-6 * object.size();
  const FinishedMap map = map_in_memory(object.model(), queries, {.tolerance = tolerance});
  ASSERT_EQ(map.rows.size(), queries.size());
  const auto is_verified = [&](const MapResult& row) { return verified(row.distance, tolerance); };
  const auto count = static_cast<double>(std::count_if(map.rows.begin(), map.rows.end(), is_verified));
  const double share = count / static_cast<double>(queries.size());
  fmt::print("{}, inside, {}: verified {:.5f}; by the device {}, by the host {}, wide {}\n", object.name,
             map.summary.device, share, map.summary.device_verified, map.summary.host_verified, map.summary.wide);
  EXPECT_GE(share, 0.999);
}

INSTANTIATE_TEST_SUITE_P(TableFive, TightnessTest,
                         testing::Values(TableObject{"capsule", {{0.75, 0.75, 1.0}, {1.0, 0.8}}},
                                         TableObject{"gem", {{0.43, 0.6, 1.9}, {1.5, 0.4}}},
                                         TableObject{"soap", {{3.4, 4.3, 1.7}, {0.1, 0.1}}}),
                         [](const auto& object) { return object.param.name; });

}  // namespace
}  // namespace verisq::oracle
