/// Soundness of tapered solids, the distances of triangles and of pairs: no enclosure misses the distance.
///
/// Random solids with ratios of the ends up to 19 and queries of known distance (tests/oracle/tapered_queries.hpp); one
/// in eight cuts the solid. The full run is
///   VERISQ_TAPERED_CASES=100000 build/release/tests/soundness_test --gtest_filter='TaperedQueries*'
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <random>
#include <string>
#include <vector>
#include <verisq/distance.hpp>

#include "tests/fixtures/requested_count.hpp"
#include "tests/oracle/in_parallel.hpp"
#include "tests/oracle/tapered_contact.hpp"
#include "tests/oracle/tapered_queries.hpp"

namespace verisq::oracle {
namespace {

constexpr double largest_ratio = 19.0;
constexpr std::size_t usual_cases = 1'000;

std::size_t cases() {
  return requested_count("VERISQ_TAPERED_CASES", usual_cases);
}

double largest_axis(const Primitive& primitive) {
  return std::ranges::max(primitive.superquadric.semi_axes);
}

/// In units of the solid; now and then inside.
double random_step(std::mt19937_64& random, std::size_t index) {
  const double apart = std::exp(std::uniform_real_distribution(std::log(1e-6), std::log(10.0))(random));
  return index % 8 == 7 ? -std::min(apart, 0.01) : apart;
}

std::string described(const Primitive& primitive) {
  const auto& [axes, exponents, taper] = primitive.superquadric;
  const auto& [t, q] = primitive.pose;
  return fmt::format("axes {} {} {}, exponents {} {}, taper {}, at {} {} {}, turned by {} {} {} {}", axes[0], axes[1],
                     axes[2], exponents[0], exponents[1], taper, t[0], t[1], t[2], q[0], q[1], q[2], q[3]);
}

double farthest(const Point& x) {
  return std::max({std::fabs(x[0]), std::fabs(x[1]), std::fabs(x[2])});
}

class Tally {
 public:
  /// `magnitude`: what rounding errors are in proportion to.
  void add(const Enclosure& found, const Real& lower, const Real& upper, double magnitude, const std::string& query) {
    const bool escapes = !(Real(found.lo) <= upper && Real(found.hi) >= lower);
    const std::lock_guard lock(mutex_);
    widths_.push_back({found.width() / magnitude, query});
    if (lower > 0) ++apart_;
    if (upper == 0 && found.hi == 0.0) ++meet_;
    if (!escapes) return;
    ++escapes_;
    ADD_FAILURE() << fmt::format("[{:.17g}, {:.17g}] for [{}, {}]: {}", found.lo, found.hi, text(lower), text(upper),
                                 query);
  }

  void print(const std::string& queries) {
    std::ranges::sort(widths_, {}, &Width::value);
    const auto quantile = [&](double share) {
      return widths_.at(static_cast<std::size_t>(share * static_cast<double>(widths_.size() - 1))).value;
    };
    fmt::print(
        "{}: {} cases, {} apart, {} found to meet, {} escapes; widths: half {:.2g}, 99 % {:.2g}, 99.9 % {:.2g}, "
        "largest {:.2g}: {}\n",
        queries, widths_.size(), apart_, meet_, escapes_, quantile(0.5), quantile(0.99), quantile(0.999), quantile(1.0),
        widths_.back().query);
  }

  [[nodiscard]] bool hopeless() const { return escapes_ > 10; }
  [[nodiscard]] double largest_width() const { return widths_.back().value; }

 private:
  struct Width {
    double value;
    std::string query;
  };

  std::mutex mutex_;
  std::vector<Width> widths_;
  std::size_t apart_ = 0;
  std::size_t meet_ = 0;
  std::size_t escapes_ = 0;
};

TEST(TaperedQueriesSoundnessTest, TrianglesContainTheKnownDistance) {
  Tally tally;
  in_parallel(cases(), [&](std::size_t index) {
    if (tally.hopeless()) return;
    std::mt19937_64 random(index);
    const Primitive solid = random_tapered(random, largest_ratio);
    const double size = largest_axis(solid);
    const KnownTriangle known = random_known_triangle(random, solid, size * random_step(random, index));
    const CertifiedEnclosure found = TriangleDistance({"", {solid}}).certified(known.triangle);
    double magnitude = std::max(size, farthest(solid.pose.translation));
    for (const Point& corner : known.triangle) magnitude = std::max(magnitude, farthest(corner));
    tally.add(found.distance, known.lower, known.upper, magnitude, fmt::format("case {}: {}", index, described(solid)));
  });
  tally.print("triangles");
  EXPECT_LE(tally.largest_width(), 1e-12);
}

/// Nearly straight along z, to within 1e-9 of it or less: most normals belong to points next to the widest section and
/// to the ends.
Primitive random_double_cone(std::mt19937_64& random) {
  Primitive solid = random_tapered(random, largest_ratio);
  const double below_two = std::exp(std::uniform_real_distribution(std::log(1e-9), std::log(0.1))(random));
  solid.superquadric.exponents[0] = 2.0 - below_two;
  return solid;
}

TEST(TaperedQueriesSoundnessTest, TrianglesAboutDoubleConesAreTightNearAndFar) {
  Tally near;
  Tally far;
  in_parallel(cases(), [&](std::size_t index) {
    if (near.hopeless() || far.hopeless()) return;
    std::mt19937_64 random(index);
    const Primitive solid = random_double_cone(random);
    const bool is_far = index % 4 == 0;
    const double size = largest_axis(solid);
    const double apart =
        is_far ? std::exp(std::uniform_real_distribution(3.0, 12.0)(random)) : random_step(random, index);
    const KnownTriangle known = random_known_triangle(random, solid, size * apart);
    const CertifiedEnclosure found = TriangleDistance({"", {solid}}).certified(known.triangle);
    double magnitude = std::max(size, farthest(solid.pose.translation));
    for (const Point& corner : known.triangle) magnitude = std::max(magnitude, farthest(corner));
    (is_far ? far : near)
        .add(found.distance, known.lower, known.upper, magnitude, fmt::format("case {}: {}", index, described(solid)));
  });
  near.print("triangles near double cones");
  far.print("triangles far from double cones");
  EXPECT_LE(near.largest_width(), 1e-12);
  EXPECT_LE(far.largest_width(), 1e-12);
}

TEST(TaperedQueriesSoundnessTest, PairsContainTheKnownDistance) {
  Tally tally;
  in_parallel(cases() / 4, [&](std::size_t index) {
    if (tally.hopeless()) return;
    std::mt19937_64 random(index);
    const KnownPair known = random_known_pair(random, largest_ratio, random_step(random, index));
    const Model a{"", {known.a}};
    const Model b{"", {known.b}};
    const ModelDistance found = PairDistance(a, b)();
    const double magnitude = std::max({largest_axis(known.a), largest_axis(known.b), found.distance.hi});
    const std::string query = fmt::format("case {}: {}; {}", index, described(known.a), described(known.b));
    tally.add(found.distance, known.lower, known.upper, magnitude, query);
    EXPECT_EQ(PairChecker(a, b).prove({}, found.certificate), found.distance) << query;
    EXPECT_FALSE(known.upper == 0 && found.proximity == Proximity::separated) << query;
    EXPECT_FALSE(known.lower > 0 && found.proximity == Proximity::overlapping) << query;
  });
  tally.print("pairs");
  // As of solids without a taper, where a facet (e = 2) is nearest to within 1e-6 of the size.
  EXPECT_LE(tally.largest_width(), 1e-11);
}

}  // namespace
}  // namespace verisq::oracle
