/// What is proven again of paths, what forged certificates prove, and how far the claims lie from single times.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/error.hpp>
#include <verisq/path.hpp>

#include "tests/fixtures/forged_numbers.hpp"
#include "tests/fixtures/forgeries.hpp"
#include "tests/fixtures/hip_joint.hpp"
#include "tests/oracle/random_cases.hpp"
#include "tests/oracle/random_solids.hpp"
#include "tests/sweep/random_paths.hpp"

namespace verisq {
namespace {

using oracle::ball;
using oracle::Forgeries;
using oracle::moved;
using oracle::pose_at;
using oracle::random_pose;
using oracle::random_union;
using oracle::RandomCases;
using oracle::with_wrong_digit;

/// VERISQ_FORGED_PATHS, for long runs.
int cases(int usually) {
  const char* asked = std::getenv("VERISQ_FORGED_PATHS");
  return asked != nullptr ? std::stoi(asked) : usually;
}

struct Case {
  Model a, b;
  std::vector<Pose> path;
  PathDistanceOptions options;
};

struct Proven {
  PathDistance found;
  CertifiedPath certified;
};

Proven proven(const Case& c) {
  const PathDistance found = distance_along(c.path, c.a, c.b, c.options);
  return {found, certified_path(c.path, c.a, c.b, found, c.options)};
}

Case random_case(RandomCases& random) {
  Case c{random_union(random), random_union(random), {}, {.tolerance = 1e-6}};
  for (std::size_t i = 0; i < 2 + random.choice(3); ++i) c.path.push_back(random_pose(random));
  return c;
}

/// Of whatever is not a union of convex primitives.
Case random_solid_case(oracle::RandomSolids& solids, RandomCases& random) {
  const auto [a, b] = solids.pair();
  const double size = std::max(bounding_radius(a), bounding_radius(b));
  Case c{a, b, {}, {.tolerance = 0.01 * size, .time_tolerance = 1e-3}};
  for (std::size_t i = 0; i < 2 + random.choice(2); ++i) {
    c.path.push_back(random_pose(random));
    for (double& t : c.path.back().translation) t *= 0.7 * size;
  }
  return c;
}

PathClaims proven_by(const PathChecker& checker, const PathCertificate& certificate) {
  return checker.prove(certificate, {});
}

PathFindings findings_of(const PathChecker& checker, const PathClaims& claims, const PathCertificate& certificate) {
  return check(claims, proven_by(checker, certificate));
}

bool is_quick(const Case& c) {
  constexpr std::uint64_t quick = 500;  // cubes of a search
  return ModelSearch(c.a, c.b)(c.path.front(), {.tolerance = 0.1 * c.options.tolerance}).cubes <= quick;
}

void expect_proved(const Case& c, const CertifiedPath& certified) {
  const PathFindings findings = findings_of(PathChecker(c.a, c.b, c.path), certified.claims, certified.certificate);
  EXPECT_EQ(findings.smallest.verdict, Verdict::proved);
  EXPECT_EQ(findings.first_contact.has_value(), certified.claims.first_contact.has_value());
  if (findings.first_contact) {
    EXPECT_EQ(findings.first_contact->verdict, Verdict::proved);
  }
}

TEST(PathCertificate, ProvesWhatIsFoundOfUnionsOfConvexPrimitives) {
  RandomCases random(51);
  int apart = 0;
  int meeting = 0;
  for (int k = 0; k < 40; ++k) {
    SCOPED_TRACE(k);
    const Case c = random_case(random);
    const auto [found, certified] = proven(c);
    expect_proved(c, certified);
    EXPECT_FALSE(certified.interrupted);
    if (found.proximity == PathProximity::apart) {
      ++apart;
      EXPECT_LE(certified.claims.smallest.width(), 1.1 * c.options.tolerance);
      EXPECT_LE(certified.claims.smallest.lo, found.smallest.hi);
      EXPECT_GE(certified.claims.smallest.hi, found.smallest.lo);
      EXPECT_FALSE(certified.claims.first_contact);
    } else if (found.meet_at) {
      ++meeting;
      EXPECT_EQ(certified.claims.smallest, (Enclosure{0.0, 0.0}));
      ASSERT_TRUE(certified.claims.first_contact);
      EXPECT_LE(certified.claims.first_contact->width(), 2.0 * c.options.time_tolerance);
    }
  }
  EXPECT_GT(apart, 0);
  EXPECT_GT(meeting, 0);
}

TEST(PathCertificate, ClaimsNothingButWhatIsSoAtSingleTimes) {
  constexpr int times = 24;
  RandomCases random(52);
  for (int k = 0; k < 20; ++k) {
    SCOPED_TRACE(k);
    const Case c = random_case(random);
    const CertifiedPath certified = proven(c).certified;
    const PathClaims& claims = certified.claims;
    const PairDistance pair(c.a, c.b);
    const auto last = static_cast<double>(c.path.size() - 1);
    for (int i = 0; i <= times; ++i) {
      const double time = last * i / times;
      const ModelDistance at = pair(pose_at(c.path, time));
      EXPECT_GE(at.distance.hi, claims.smallest.lo - 1e-11) << "time " << time;
      const bool before = claims.first_contact && time < claims.first_contact->lo;
      EXPECT_FALSE(before && at.proximity == Proximity::overlapping) << "time " << time;
    }
  }
}

/// Of each part alone, at its ends, in its middle and between: its bound is of all its times.
TEST(PathCertificate, IsNoMoreOfAPartThanAtAnyOfItsTimes) {
  RandomCases random(53);
  std::size_t parts = 0;
  for (int k = 0; k < 30; ++k) {
    SCOPED_TRACE(k);
    const Case c = random_case(random);
    const PathCertificate certificate = proven(c).certified.certificate;
    const PathChecker checker(c.a, c.b, c.path);
    const PairDistance pair(c.a, c.b);
    double begin = 0.0;
    for (PathPart part : certificate.parts) {
      const double end = part.until;
      // Prolonged to where it proves little, too.
      for (const double until : {end, std::min(std::floor(begin) + 1.0, end + 3.0 * (end - begin))}) {
        part.until = until;
        const double lower = checker.lower(begin, part);
        for (const double share : {0.0, 0.21, 0.5, 0.84, 1.0}) {
          const ModelDistance at = pair(pose_at(c.path, begin + share * (until - begin)));
          EXPECT_GE(at.distance.hi, lower - 1e-11) << begin << " to " << until << " at " << share;
        }
      }
      begin = end;
      ++parts;
    }
  }
  EXPECT_GT(parts, 300U);
}

TEST(PathCertificate, ProvesBendsAndSetOperations) {
  constexpr int times = 8;
  oracle::RandomSolids solids(54);
  RandomCases random(55);
  int tight = 0;
  int apart = 0;
  int meeting = 0;
  for (int k = 0; k < 8; ++k) {
    SCOPED_TRACE(k);
    const Case c = random_solid_case(solids, random);
    if (!is_quick(c)) continue;
    const ModelSearch pair(c.a, c.b);
    const auto [found, certified] = proven(c);
    const PathClaims& claims = certified.claims;
    expect_proved(c, certified);
    if (found.proximity == PathProximity::apart) {
      ++apart;
      tight += claims.smallest.width() <= 1.5 * c.options.tolerance ? 1 : 0;
    }
    meeting += claims.smallest == Enclosure{0.0, 0.0} ? 1 : 0;
    const double size = std::max(bounding_radius(c.a), bounding_radius(c.b));
    for (int i = 0; i <= times; ++i) {
      const double time = static_cast<double>(c.path.size() - 1) * i / times;
      const SearchedDistance at = pair(pose_at(c.path, time), {.tolerance = 0.1 * c.options.tolerance});
      EXPECT_GE(at.distance.hi, claims.smallest.lo - 1e-11 * size) << "time " << time;
      const bool before = claims.first_contact && time < claims.first_contact->lo;
      EXPECT_FALSE(before && at.proximity == Proximity::overlapping) << "time " << time;
    }
  }
  EXPECT_GT(tight, apart / 2);
  EXPECT_GT(meeting, 0);
}

using Change = std::function<void(PathCertificate&)>;

/// Proofs that are not the one that was found.
std::vector<Change> changes(RandomCases& random, const std::vector<Pose>& path) {
  const auto last = static_cast<double>(path.size() - 1);
  const auto any = [&random](PathCertificate& proof) -> PathPart& {
    return proof.parts[random.choice(proof.parts.size())];
  };
  const auto if_parts = [](const auto& change) {
    return [change](PathCertificate& proof) {
      if (!proof.parts.empty()) change(proof);
    };
  };
  return {
      [](PathCertificate&) {},
      [](PathCertificate& proof) { proof.parts.clear(); },
      if_parts([&random](PathCertificate& proof) {
        proof.parts.erase(proof.parts.begin() + static_cast<std::ptrdiff_t>(random.choice(proof.parts.size())));
      }),
      if_parts([any](PathCertificate& proof) { std::swap(any(proof).certificate, any(proof).certificate); }),
      if_parts([any](PathCertificate& proof) { any(proof).until = any(proof).until; }),
      if_parts(
          [any, &random](PathCertificate& proof) { any(proof).until = with_wrong_digit(any(proof).until, random); }),
      if_parts([any](PathCertificate& proof) { any(proof).until = std::nan(""); }),
      if_parts([last](PathCertificate& proof) {
        proof.parts.resize(1);
        proof.parts.front().until = last;
      }),
      if_parts([any, &random](PathCertificate& proof) {
        PairCertificate& certificate = any(proof).certificate;
        for (Separation& s : certificate.separations) s.vector[0] = with_wrong_digit(s.vector[0], random);
        for (DividedSeparation& d : certificate.divisions) d.cuts.clear();
        for (SurroundedPrimitive& s : certificate.covers_b) s.distance = with_wrong_digit(s.distance, random);
      }),
      if_parts([any](PathCertificate& proof) { any(proof).certificate = {}; }),
      if_parts([any](PathCertificate& proof) { proof.parts.push_back(any(proof)); }),
      [last, &random](PathCertificate& proof) { proof.nearest = random.uniform(-1.0, last + 1.0); },
      [](PathCertificate& proof) {
        proof.at_nearest.common = Point{0.0, 0.0, 0.0};
      },
      [](PathCertificate& proof) { proof.nearest = infinity; },
  };
}

/// What is not so: past what is proven, by 1e-12 of it.
std::vector<PathClaims> false_claims(const PathClaims& claims, double last) {
  const Enclosure& smallest = claims.smallest;
  std::vector<PathClaims> result{{{moved(smallest.hi, 1.0), infinity}, std::nullopt}};
  if (smallest.lo > 0.0) {
    result.push_back({{0.0, moved(smallest.lo, -1.0)}, std::nullopt});
    result.push_back({{0.0, 0.0}, std::nullopt});
    result.push_back({{0.0, infinity}, Enclosure{0.0, last}});
  } else if (claims.first_contact) {
    const auto [apart_before, meet_at] = *claims.first_contact;
    if (meet_at < infinity) result.push_back({{0.0, infinity}, Enclosure{moved(meet_at, 1.0), infinity}});
    if (meet_at < infinity) result.push_back({{0.0, infinity}, Enclosure{infinity, infinity}});
    if (apart_before > 0.0) result.push_back({{0.0, infinity}, Enclosure{0.0, moved(apart_before, -1.0)}});
  }
  return result;
}

void try_forgeries(const Case& c, RandomCases& random, Forgeries& forgeries) {
  const CertifiedPath certified = proven(c).certified;
  const PathChecker checker(c.a, c.b, c.path);
  for (const PathClaims& claims : false_claims(certified.claims, static_cast<double>(c.path.size() - 1))) {
    for (const Change& change : changes(random, c.path)) {
      PathCertificate proof = certified.certificate;
      change(proof);
      const PathFindings findings = findings_of(checker, claims, proof);
      const bool of_contact = claims.first_contact.has_value();
      forgeries.expect_not_proved(of_contact ? *findings.first_contact : findings.smallest,
                                  of_contact ? *claims.first_contact : claims.smallest, "claims moved");
    }
  }
  // Another case: its models nearer to each other all the way by more than the claim is wide.
  const Enclosure& smallest = certified.claims.smallest;
  if (!(smallest.lo > 0.0)) return;
  Case nearer = c;
  const double grown = 1.0 + 2.0 * smallest.width() / bounding_radius(c.a);
  for (Primitive& primitive : nearer.a.primitives) {
    for (double& axis : primitive.superquadric.semi_axes) axis *= grown;
  }
  const PathClaims truth = proven(nearer).certified.claims;
  if (!(truth.smallest.hi < smallest.lo)) return;
  const PathChecker other(nearer.a, nearer.b, nearer.path);
  forgeries.expect_not_proved(findings_of(other, certified.claims, certified.certificate).smallest, smallest,
                              "another model");
}

TEST(PathCertificate, NoForgeryIsProved) {
  RandomCases random(56);
  Forgeries forgeries;
  for (int k = 0; k < cases(12); ++k) {
    SCOPED_TRACE(k);
    try_forgeries(random_case(random), random, forgeries);
  }
  EXPECT_GE(forgeries.told(), static_cast<std::size_t>(20 * cases(12)));
}

TEST(PathCertificate, NoForgeryOfBendsAndSetOperationsIsProved) {
  oracle::RandomSolids solids(57);
  RandomCases random(58);
  Forgeries forgeries;
  for (int k = 0; k < cases(3); ++k) {
    SCOPED_TRACE(k);
    const Case c = random_solid_case(solids, random);
    if (is_quick(c)) try_forgeries(c, random, forgeries);
  }
  EXPECT_GE(forgeries.told(), 20U);
}

/// What looks like a certificate.
class Nonsense {
 public:
  explicit Nonsense(RandomCases& random) : random_(&random) {}

  [[nodiscard]] bool one_of(std::size_t count) const { return random_->choice(count) == 0; }

  [[nodiscard]] double number() const {
    constexpr std::array<double, 7> extremes{
        0.0, -0.0, 1e308, 5e-324, -1e-200, infinity, std::numeric_limits<double>::quiet_NaN()};
    return one_of(2) ? extremes.at(random_->choice(7)) : random_->uniform(-0.5, 0.5);
  }

  [[nodiscard]] PairCertificate like(PairCertificate certificate) const {
    for (Separation& s : certificate.separations) s = {index(), index(), vector(), vector(), vector()};
    for (DividedSeparation& division : certificate.divisions) change(division);
    for (SurroundedPrimitive& s : certificate.covers_b) s = {index(), number(), {one_of(2), one_of(2)}};
    if (one_of(2)) certificate.covers_a = certificate.covers_b;
    if (one_of(2)) certificate.covers_b.push_back({index(), number(), {true, false, false}});
    if (one_of(3)) certificate.balls_a = {{index(), vector(), number(), number(), {{}, {}}}};
    if (one_of(3)) certificate.balls_b = {{index(), vector(), number(), number(), {{}, {}}}};
    if (one_of(3)) certificate.common = vector();
    if (one_of(3)) certificate.near_points = {vector(), vector()};
    return certificate;
  }

  [[nodiscard]] PathCertificate like(PathCertificate certificate) const {
    certificate.at_nearest = like(certificate.at_nearest);
    if (one_of(2)) certificate.nearest = number();
    for (PathPart& part : certificate.parts) {
      if (one_of(20)) part.until = number();
      if (one_of(3)) part.certificate = like(part.certificate);
    }
    return certificate;
  }

 private:
  [[nodiscard]] Point vector() const { return {number(), number(), number()}; }
  [[nodiscard]] std::uint32_t index() const { return static_cast<std::uint32_t>(random_->choice(5)); }

  void change(DividedSeparation& division) const {
    if (one_of(3)) division.primitive_a = index();
    if (one_of(3)) division.cuts.insert(division.cuts.begin(), SectionCut(random_->choice(3)));
    for (SectionPlane& plane : division.planes) plane = {vector(), number(), number()};
  }

  RandomCases* random_;
};

void expect_nothing_false(const Case& c, const Nonsense& nonsense) {
  const auto [found, certified] = proven(c);
  const PathChecker checker(c.a, c.b, c.path);
  for (int i = 0; i < 20; ++i) {
    const PathClaims proved = proven_by(checker, nonsense.like(certified.certificate));
    EXPECT_LE(proved.smallest.lo, found.smallest.hi);
    EXPECT_GE(proved.smallest.hi, found.smallest.lo);
    EXPECT_LE(proved.first_contact->lo, found.meet_at.value_or(infinity));
    EXPECT_GE(proved.first_contact->hi, found.apart_before);
  }
}

/// Whatever a certificate holds, of solids balls, planes and covers, too: what it proves is so.
TEST(PathCertificate, ProvesNothingFalseFromNonsense) {
  oracle::RandomSolids solids(60);
  RandomCases random(61);
  for (int k = 0; k < 3; ++k) {
    SCOPED_TRACE(k);
    expect_nothing_false(random_case(random), Nonsense(random));
    const Case c = random_solid_case(solids, random);
    if (is_quick(c)) expect_nothing_false(c, Nonsense(random));
  }
}

Case hip_case(RandomCases& random) {
  const testing::HipJoint joint = testing::hip_joint(random);
  return {joint.cup, joint.neck, {testing::hip_pose(random), testing::hip_pose(random)}, {.tolerance = 0.6}};
}

/// Necks move within cups, their rims nearest: covers, of all places that a part has.
TEST(PathCertificate, ProvesNecksThatMoveBesideRims) {
  RandomCases random(62);
  int tight = 0;
  for (int k = 0; k < 2; ++k) {
    SCOPED_TRACE(k);
    const Case c = hip_case(random);
    const auto [found, certified] = proven(c);
    expect_proved(c, certified);
    tight += certified.claims.smallest.width() <= 1.5 * c.options.tolerance ? 1 : 0;
    const ModelSearch pair(c.a, c.b);
    for (const double time : {0.0, 0.3, 0.6, 1.0}) {
      EXPECT_GE(pair(pose_at(c.path, time), {.tolerance = 0.01}).distance.hi, certified.claims.smallest.lo - 1e-9);
    }
  }
  EXPECT_GE(tight, 1);
}

TEST(PathCertificate, NoForgeryOfNecksBesideRimsIsProved) {
  RandomCases random(63);
  Forgeries forgeries;
  for (int k = 0; k < cases(1); ++k) {
    SCOPED_TRACE(k);
    try_forgeries(hip_case(random), random, forgeries);
  }
  EXPECT_GE(forgeries.told(), 20U);
}

TEST(PathCertificate, IsOfASinglePose) {
  const Case c{ball({}, 1.0), ball({}, 0.5), {{.translation = {3.0, 0.0, 0.0}}}, {.tolerance = 1e-9}};
  const CertifiedPath certified = proven(c).certified;
  EXPECT_LE(certified.claims.smallest.lo, 1.5);
  EXPECT_GE(certified.claims.smallest.hi, 1.5);
  EXPECT_LE(certified.claims.smallest.width(), 2e-9);
  ASSERT_EQ(certified.certificate.parts.size(), 1U);
  EXPECT_EQ(certified.certificate.parts.front().until, 0.0);
  expect_proved(c, certified);
}

TEST(PathCertificate, SaysWhereTwoGrazeThatTheyAreApartBefore) {
  const Case c{ball({}, 1.0),
               ball({}, 0.5),
               {{.translation = {-2.0, 1.5, 0.0}}, {.translation = {2.0, 1.5, 0.0}}},
               {.tolerance = 1e-6}};
  const auto [found, certified] = proven(c);
  ASSERT_NE(found.proximity, PathProximity::apart);
  EXPECT_EQ(certified.claims.smallest.lo, 0.0);
  EXPECT_LE(certified.claims.smallest.hi, 1e-6);
  ASSERT_TRUE(certified.claims.first_contact);
  EXPECT_LE(certified.claims.first_contact->lo, 0.5);
  expect_proved(c, certified);
}

TEST(PathCertificate, LongPathsOfFarModelsTakeHardlyMoreThanAPartALeg) {
  std::vector<Pose> path(500);
  for (std::size_t k = 0; k < path.size(); ++k) path[k].translation = {20.0, 0.1 * static_cast<double>(k), 0.0};
  const Case c{ball({}, 1.0), ball({}, 0.5), path, {.tolerance = 1e-6}};
  const CertifiedPath certified = proven(c).certified;
  EXPECT_GE(certified.certificate.parts.size(), 499U);
  EXPECT_LE(certified.certificate.parts.size(), 510U);
  expect_proved(c, certified);
}

TEST(PathCertificate, InterruptedItHoldsLess) {
  RandomCases random(59);
  Case c = random_case(random);
  const PathDistance found = distance_along(c.path, c.a, c.b, c.options);
  c.options.interrupted = [] { return true; };
  const CertifiedPath certified = certified_path(c.path, c.a, c.b, found, c.options);
  EXPECT_TRUE(certified.interrupted);
  expect_proved(c, certified);
}

TEST(PathChecker, RefusesWhatIsNoPath) {
  const Model a = ball({}, 1.0);
  EXPECT_THROW((void)PathChecker(a, a, {}), Error);
  const std::vector<Pose> half_a_turn{{}, {.quaternion = {0.0, 0.0, 0.0, -1.0}}};
  EXPECT_THROW((void)PathChecker(a, a, half_a_turn), Error);
  const std::vector<Pose> nowhere{{.quaternion = {0.0, 0.0, 0.0, 0.0}}};
  EXPECT_THROW((void)PathChecker(a, a, nowhere), Error);
}

}  // namespace
}  // namespace verisq
