/// What is found along a way in is proved again from its certificates, and no forgery of them is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/error.hpp>

#include "tests/clearance/way_scenes.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "tests/oracle/random_cases.hpp"
#include "verify/solids/paths.hpp"
#include "verisq/enclosure.hpp"
#include "verisq/insertion.hpp"

namespace verisq::oracle {
namespace {

using verify::RigidPath;

std::vector<Point> bone_of(std::uint64_t seed, std::size_t count) {
  RandomCases random(seed);
  std::vector<Point> points(count);
  for (Point& p : points) p = {random.uniform(-4.0, 4.0), random.uniform(-4.0, 4.0), random.uniform(-9.0, 8.0)};
  return points;
}

constexpr double tolerance = 0.02;

struct Proven {
  std::vector<Point> bone;
  CertifiedInsertion insertion;
};

Proven proven(const WayScene& scene, std::uint64_t seed, std::size_t count) {
  const std::vector<Point> bone = bone_of(seed, count);
  const InsertionOptions options{.tolerance = tolerance, .device = "host"};
  const Insertion found = smallest_distance_along(scene.path, scene.implant, bone, options);
  return {bone, certified_insertion(scene.path, scene.implant, bone, found, options)};
}

TEST(InsertionCertificate, ProvesRowsThatAreAsTightAsAskedFor) {
  for (const WayScene& scene : way_scenes()) {
    const auto [bone, insertion] = proven(scene, 3, 80);
    const InsertionChecker check(scene.implant, scene.path);
    std::size_t cut = 0;
    std::size_t untouched = 0;
    for (std::size_t n = 0; n < bone.size(); ++n) {
      const Enclosure& row = insertion.rows[n].distance;
      EXPECT_EQ(check(bone[n], row, insertion.certificates[n]).verdict, Verdict::proved) << scene.name << ' ' << n;
      EXPECT_LE(row.width(), 1.5 * tolerance) << scene.name << ' ' << n;
      cut += row.hi < 0.0 ? 1 : 0;
      untouched += row.lo > 0.0 ? 1 : 0;
    }
    EXPECT_GT(cut, 4U) << scene.name;
    EXPECT_GT(untouched, 4U) << scene.name;
    EXPECT_EQ(insertion.summary.points, bone.size());
  }
}

TEST(InsertionCertificate, NeedsFewPartsOfStraightWays) {
  const auto [bone, insertion] = proven(way_scenes().front(), 4, 80);
  std::size_t parts = 0;
  for (const InsertionCertificate& certificate : insertion.certificates) parts += certificate.parts.size();
  EXPECT_LE(parts, 8 * bone.size());
  for (std::size_t n = 0; n < bone.size(); ++n) {
    const bool untouched = insertion.rows[n].distance.lo > 0.0;
    EXPECT_LE(insertion.certificates[n].parts.size(), untouched ? 1U : 64U) << n;
  }
}

/// The distances at many times are none below.
TEST(InsertionCertificate, ContainsWhatIsFoundAtManyTimes) {
  for (const WayScene& scene : way_scenes()) {
    const auto [bone, insertion] = proven(scene, 5, 30);
    const RigidPath path(scene.path);
    const SignedDistance distance(scene.implant);
    for (std::size_t n = 0; n < bone.size(); ++n) {
      double least = infinity;
      for (int step = 0; step <= 200; ++step) {
        const double time = path.last_time() * step / 200.0;
        const auto [centre, radius] = RigidPath::local_point(path.nearest_pose(time), bone[n]);
        least = std::min(least, distance(centre, 1e-6).hi + radius);
      }
      EXPECT_LE(insertion.rows[n].distance.lo, least) << scene.name << ' ' << n;
    }
  }
}

/// Claims that do not contain the smallest distance, with evidence that is changed, too, or not.
class Forger {
 public:
  Forger(const WayScene& scene, const Proven& proven)
      : check_(scene.implant, scene.path), last_(static_cast<double>(scene.path.size() - 1)), proven_(proven) {}

  std::size_t operator()(std::size_t n) {
    const Enclosure& row = proven_.insertion.rows[n].distance;
    const std::vector<Enclosure> claims{{row.hi + 1e-12, row.hi + 1.0},  {row.hi + 1e-12, infinity},
                                        {row.hi + 1e-6, row.hi + 1e-3},  {row.lo - 1.0, row.lo - 1e-12},
                                        {-infinity, row.lo - 1e-12},     {row.lo - 1e-3, row.lo - 1e-6},
                                        {row.hi + 1e-12, row.lo - 1e-12}};
    std::size_t tried = 0;
    for (const InsertionCertificate& evidence : evidence_of(n)) {
      for (const Enclosure& claim : claims) {
        EXPECT_NE(check_(proven_.bone[n], claim, evidence).verdict, Verdict::proved) << n;
        ++tried;
      }
    }
    return tried;
  }

 private:
  using Evidence = std::vector<InsertionCertificate>;

  static constexpr double nan = std::numeric_limits<double>::quiet_NaN();

  [[nodiscard]] Evidence evidence_of(std::size_t n) const {
    const Evidence& all = proven_.insertion.certificates;
    Evidence evidence{all[n], all[(n + 1) % all.size()], {}};
    add_times(all[n], evidence);
    add_parts(all[n], evidence);
    add_segments(all[n], evidence);
    add_normals(all[n], evidence);
    return evidence;
  }

  void add_times(const InsertionCertificate& own, Evidence& evidence) const {
    for (const double time : {0.0, 0.5 * last_, last_, -1.0, 2.0 * last_ + 1.0, nan, infinity}) {
      evidence.push_back(own);
      evidence.back().deepest = time;
    }
    for (const double time : {0.0, 0.25 * last_, last_, last_ + 1.0, -1.0, nan, infinity}) {
      evidence.push_back(own);
      evidence.back().parts.front().until = time;
    }
  }

  static void add_parts(const InsertionCertificate& own, Evidence& evidence) {
    evidence.push_back(own);
    evidence.back().parts.pop_back();
    evidence.push_back(own);
    evidence.back().parts.erase(evidence.back().parts.begin());
    evidence.push_back(own);
    std::ranges::reverse(evidence.back().parts);
    evidence.push_back(own);
    evidence.back().parts.push_back(own.parts.back());
  }

  static void add_segments(const InsertionCertificate& own, Evidence& evidence) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const double by : {1e-3, -1e-3, 1.0, 100.0, nan, infinity}) {
        evidence.push_back(own);
        for (WayPart& part : evidence.back().parts)
          for (Point& end : part.segment) end[axis] += by;
      }
    }
    evidence.push_back(own);
    for (WayPart& part : evidence.back().parts) part.segment[1] = part.segment[0];
  }

  static void add_normals(const InsertionCertificate& own, Evidence& evidence) {
    const auto each_normal = [&](const auto& change) {
      evidence.push_back(own);
      for (WayPart& part : evidence.back().parts) std::ranges::for_each(part.certificate.normals, change);
    };
    each_normal([](Normal& normal) {
      for (double& c : normal.vector) c = -c;
    });
    each_normal([](Normal& normal) { normal.primitive += 1; });
    evidence.push_back(own);
    std::swap(evidence.back().at_deepest, evidence.back().parts.front().certificate);
  }

  InsertionChecker check_;
  double last_;
  const Proven& proven_;
};

TEST(InsertionCertificate, NeverProvesAForgery) {
  const std::size_t points = requested_count("VERISQ_FORGED_INSERTIONS", 14);
  std::size_t tried = 0;
  for (const WayScene& scene : way_scenes()) {
    const Proven answer = proven(scene, 6, points);
    Forger forge(scene, answer);
    for (std::size_t n = 0; n < points; ++n) tried += forge(n);
  }
  std::cout << "forged: " << tried << "\n";
  EXPECT_GE(tried, 10'000U * points / 14U);
}

TEST(InsertionCertificate, IsOfNoOtherWayOrImplant) {
  const WayScene scene = way_scenes().front();
  const auto [bone, insertion] = proven(scene, 7, 40);
  WayScene moved = scene;
  for (Pose& pose : moved.path) pose.translation[0] += 1e-9 + tolerance;
  WayScene larger = scene;
  for (Primitive& primitive : larger.implant.primitives) primitive.superquadric.semi_axes[0] *= 1.05;
  for (const WayScene& other : {moved, larger}) {
    const InsertionChecker check(other.implant, other.path);
    const Insertion truth =
        smallest_distance_along(other.path, other.implant, bone, {.tolerance = 1e-4, .device = "host"});
    std::size_t apart = 0;
    for (std::size_t n = 0; n < bone.size(); ++n) {
      const Enclosure& row = insertion.rows[n].distance;
      const Enclosure& exact = truth.rows[n].distance;
      if (row.lo <= exact.hi && exact.lo <= row.hi) continue;
      ++apart;
      EXPECT_NE(check(bone[n], row, insertion.certificates[n]).verdict, Verdict::proved) << n;
    }
    EXPECT_GT(apart, 3U);
  }
}

TEST(InsertionCertificate, RefusesImplantsThatAreBent) {
  Model bent = shaft;
  bent.primitives.front().superquadric.exponents = {1.0, 1.0};
  bent.primitives.front().bend = Bend{0.01, 0.0};
  const std::vector<Point> bone{{5.0, 0.0, 0.0}};
  const InsertionOptions options{.tolerance = tolerance, .device = "host"};
  const std::vector<Pose> path(1);
  const Insertion found = smallest_distance_along(path, bent, bone, options);
  EXPECT_THROW((void)certified_insertion(path, bent, bone, found, options), Error);
}

/// Nothing is proven where numbers overflow, and nothing that is not finite is handed on.
TEST(InsertionCertificate, BearsHugeWays) {
  const std::vector<Point> bone = bone_of(9, 2);
  const InsertionOptions options{.tolerance = tolerance, .device = "host"};
  for (const double length : {1e100, 1e200, 1e308}) {
    const std::vector<Pose> path = straight_path({}, {0.0, 0.0, -1.0}, length, 1);
    const Insertion found = smallest_distance_along(path, shaft_with_neck, bone, options);
    const CertifiedInsertion proven = certified_insertion(path, shaft_with_neck, bone, found, options);
    const InsertionChecker check(shaft_with_neck, path);
    for (std::size_t n = 0; n < bone.size(); ++n) {
      EXPECT_EQ(check(bone[n], proven.rows[n].distance, proven.certificates[n]).verdict, Verdict::proved) << length;
      for (const WayPart& part : proven.certificates[n].parts)
        for (const Point& end : part.segment) EXPECT_TRUE(std::isfinite(end[0]) && std::isfinite(end[2]));
    }
  }
}

TEST(InsertionCertificate, HasTheRowsBeforeAnInterruption) {
  const WayScene scene = way_scenes().front();
  const std::vector<Point> bone = bone_of(8, 600);
  InsertionOptions options{.tolerance = tolerance, .device = "host"};
  const Insertion found = smallest_distance_along(scene.path, scene.implant, bone, options);
  bool told = false;
  options.progress = [&told](double) { told = true; };
  options.interrupted = [&told] { return told; };
  const CertifiedInsertion part = certified_insertion(scene.path, scene.implant, bone, found, options);
  EXPECT_TRUE(part.summary.interrupted);
  EXPECT_GT(part.rows.size(), 0U);
  EXPECT_LT(part.rows.size(), bone.size());
  EXPECT_EQ(part.certificates.size(), part.rows.size());
}

}  // namespace
}  // namespace verisq::oracle
