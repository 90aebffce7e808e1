/// Certificates of how good a fit can be at best: no sampled pose is better, what is found is proved again, and what is
/// forged is not.
#include <gmock/gmock.h>

#include <random>

#include "host/plan/candidate_evaluation.hpp"
#include "host/prepare/eigen_points.hpp"
#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/fit_objective.hpp"
#include "tests/fixtures/offset_cavity.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "tests/fixtures/small_hook.hpp"
#include "verify/proof/objective_bound.hpp"
#include "verisq/fit.hpp"

namespace verisq {
namespace {

using fit_search::CandidateSpace;
using verify::BoxBound;
using verify::ObjectiveBound;
using verify::PoseCell;
using ::verisq::testing::FitObjective;
using ::verisq::testing::small_hook;

constexpr double play = 0.5;

PoseRange range_about(const Pose& start, double translation, double degrees) {
  return {.start = start, .translation = translation, .rotation_degrees = degrees};
}

const Pose tilted{{0.2, -0.3, 0.1}, {0.999, 0.01, -0.02, 0.015}};

class RandomPoses {
 public:
  explicit RandomPoses(const CandidateSpace& space) : space_(space) {}

  std::array<double, 6> within(const PoseCell& cell) {
    std::array<double, 6> pose{};
    for (std::size_t k = 0; k < 6; ++k) {
      const double share = cell.index[k] + 0.5 + 0.5 * uniform_(random_);
      pose[k] = space_.upper()[k] * (std::ldexp(share, 1 - cell.level[k]) - 1.0);
    }
    return pose;
  }

  /// Anywhere in the range, or about the pose.
  PoseCell cell(int most_levels, const std::array<double, 6>* pose) {
    PoseCell cell;
    const int levels = std::uniform_int_distribution<int>(0, most_levels)(random_);
    for (int i = 0; i < levels; ++i) {
      const auto k = std::uniform_int_distribution<std::size_t>(0, 5)(random_);
      const double middle = space_.upper()[k] * (std::ldexp(cell.index[k] + 0.5, 1 - cell.level[k]) - 1.0);
      const bool high = pose != nullptr ? (*pose)[k] > middle : std::bernoulli_distribution()(random_);
      cell = cell.halves(k)[high ? 1 : 0];
    }
    return cell;
  }

 private:
  const CandidateSpace& space_;
  std::mt19937_64 random_{4};
  std::uniform_real_distribution<double> uniform_{-1.0, 1.0};
};

verify::BoundedObjective bounded(const Cavity& cavity, const Fitness& fitness, double limit) {
  std::vector<verify::PointOfWeight> points;
  for (std::size_t i = 0; i < cavity.points.size(); ++i)
    points.push_back({cavity.points[i], cavity.areas[cavity.area_of[i]].weight});
  return {fitness, limit, verify::weighted_balls(points)};
}

Point centre_of(const CandidateSpace& space) {
  return point_of(space.pose_space().centre);
}

struct HookCase {
  Fitness fitness;
  double taper;
};

class BoxesOfAHook : public ::testing::TestWithParam<HookCase> {};

TEST_P(BoxesOfAHook, HoldNoBetterPoseThanTheirBound) {
  const Model hook = small_hook(GetParam().taper);
  Cavity cavity = testing::offset_cavity(hook, play, 40);
  cavity.areas = {{"light", 0.25}, {"heavy", 3.0}};
  for (std::size_t i = 0; i < cavity.points.size(); ++i) cavity.area_of[i] = i % 3 == 0 ? 1 : 0;
  const PoseRange range = range_about(tilted, 4.0, 20.0);
  constexpr double limit = 0.1;
  const CandidateSpace space(hook, range);
  FitObjective objective(cavity, GetParam().fitness, limit);
  const verify::BoundedObjective terms = bounded(cavity, GetParam().fitness, limit);
  const ObjectiveBound bound(hook, centre_of(space), range, terms);
  RandomPoses poses(space);
  const fit_search::Parameters planted = space.nearest({});
  std::array<double, 6> made_of{};
  std::ranges::copy(planted, made_of.begin());
  int feasible = 0;
  int excluded = 0;
  double tightest = infinity;
  for (int i = 0; i < 200; ++i) {
    const PoseCell cell = poses.cell(60, i % 2 == 0 ? nullptr : &made_of);
    const BoxBound found = bound(cell);
    if (found.upper == -infinity) ++excluded;
    for (int k = 0; k < 10; ++k) {
      const std::optional<double> reached = objective(space, poses.within(cell));
      if (!reached) continue;
      ++feasible;
      ASSERT_LE(*reached, found.upper + 1e-6) << i;
      tightest = std::min(tightest, found.upper / *reached);
    }
  }
  EXPECT_GT(feasible, 50);
  EXPECT_GT(excluded, 20);
  EXPECT_LT(tightest, GetParam().fitness.target > 0.0 ? 1.3 : 1.05);  // nearer than the target counts as at it
}

INSTANTIATE_TEST_SUITE_P(Completions, BoxesOfAHook,
                         ::testing::Values(HookCase{cementless(0.5, 0.1), 1.0}, HookCase{cementless(3.0, 0.1), 4.0},
                                           HookCase{cemented(0.5, 0.25), 1.0}));

TEST(LineAbove, IsNowhereBelowTheFitness) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  double largest_excess = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const Fitness fitness{2.0 * uniform(random), 0.2 + uniform(random), {}};
    const double middle = 8.0 * uniform(random) - 2.0;
    const double half = std::pow(10.0, 4.0 * uniform(random) - 3.5);
    const verify::LineAbove line = verify::line_above(fitness, middle, half);
    ASSERT_LE(line.slope.upper(), 0.0);
    double least = infinity;
    for (int k = 0; k <= 32; ++k) {
      const double d = middle + half * (k - 16) / 16.0;
      const double u = std::max(d - fitness.target, 0.0) / fitness.scale;
      const double excess = line.value.upper() + line.slope.upper() * std::max(d - middle, 0.0) +
                            line.slope.lower() * std::min(d - middle, 0.0) - 1.0 / (1.0 + u * u);
      ASSERT_GE(excess, -1e-14) << middle << " " << half;
      least = std::min(least, excess);
    }
    largest_excess = std::max(largest_excess, least);
  }
  EXPECT_LT(largest_excess, 1e-2);  // it touches, between the samples
}

/// A fit with a planted best pose, its bound and the certificate of that.
class CertifiedBound {
 public:
  CertifiedBound(const Model& implant, std::size_t points, const PoseRange& range, double gap)
      : implant_(implant), cavity_(testing::offset_cavity(implant, play, points)) {
    terms_.range = range;
    FitObjective objective(cavity_, terms_.fitness, terms_.penetration_limit);
    best_ = *objective(CandidateSpace(implant_, range), std::array<double, 6>{});
    const UncertainModel exact = implant_;
    int rounds = 0;
    const FitBound bound = bound_fit({&exact, 1}, cavity_,
                                     {.fitness = terms_.fitness,
                                      .penetration_limit = terms_.penetration_limit,
                                      .range = terms_.range,
                                      .known = best_,
                                      .gap = gap,
                                      .out_of_time = [&rounds] { return rounds >= 60; },
                                      .progress = [&rounds](const FitBoundProgress&) { ++rounds; }});
    found_ = bound.upper;
    auto certified = certified_best_fit({&exact, 1}, cavity_, terms_, bound, {});
    claim_ = certified->claim;
    certificate_ = certified->certificate;
  }

  [[nodiscard]] ProvenBestFit proven(const BestFitClaim& claim, const BestFitCertificate& certificate) const {
    return BestFitChecker({&implant_, 1}, cavity_.points, claim)(certificate, {});
  }
  [[nodiscard]] bool is_proved(const BestFitClaim& claim, const BestFitCertificate& certificate) const {
    return check(claim, proven(claim, certificate)) == Verdict::proved;
  }

  [[nodiscard]] const Model& implant() const { return implant_; }
  [[nodiscard]] const Cavity& cavity() const { return cavity_; }
  [[nodiscard]] double best() const { return best_; }    ///< F of the planted pose, about
  [[nodiscard]] double found() const { return found_; }  ///< the bound of the search
  [[nodiscard]] const BestFitClaim& claim() const { return claim_; }
  [[nodiscard]] const BestFitCertificate& certificate() const { return certificate_; }

 private:
  Model implant_;
  Cavity cavity_;
  BestFitTerms terms_{.fitness = cementless(0.7, 0.0), .penetration_limit = 0.0, .range = {}};
  double best_;
  double found_;
  BestFitClaim claim_;
  BestFitCertificate certificate_;
};

const PoseRange near_range = range_about({}, 1.0, 5.0);

TEST(BestFitCertificate, ProvesTheBoundOfTheSearch) {
  for (const double taper : {1.0, 3.0}) {
    const CertifiedBound bound(small_hook(taper), 20, near_range, 0.25);
    EXPECT_TRUE(bound.is_proved(bound.claim(), bound.certificate()));
    EXPECT_GE(bound.claim().upper, bound.best());
    EXPECT_LT(bound.claim().upper, bound.found() * 1.01);
    EXPECT_GT(bound.certificate().ranges.front().size(), 100U);
  }
}

TEST(BestFitCertificate, ProvesThatNoPoseKeepsTheLimit) {
  Cavity cavity = testing::offset_cavity(small_hook(), play, 10);
  cavity.points.push_back({0.0, 0.0, 0.0});  // in the arm, wherever it is moved
  cavity.area_of.push_back(0);
  const Model implant = small_hook();
  const BestFitClaim claim{.terms = {cementless(2.0, 0.1), 0.1, cavity.areas, cavity.area_of},
                           .range = near_range,
                           .centres = {{0.0, 0.0, 0.0}},
                           .upper = -infinity};
  const BestFitCertificate undivided{{{PoseDivision::none}}};
  const BestFitChecker checker({&implant, 1}, cavity.points, claim);
  EXPECT_EQ(checker(undivided, {}).upper, -infinity);
  EXPECT_EQ(check(claim, checker(undivided, {})), Verdict::proved);
}

TEST(BestFitCertificate, OfSeveralImplantsIsThatOfTheBest) {
  const CertifiedBound bound(small_hook(), 12, near_range, 0.25);
  const Model larger{"mm", {{"ball", {{30.0, 30.0, 30.0}, {1.0, 1.0}}, {}, {}}}, {}};  // swallows all points
  const std::vector<Model> series{bound.implant(), larger};
  BestFitClaim claim = bound.claim();
  claim.centres.push_back({0.0, 0.0, 0.0});
  const BestFitChecker checker(series, bound.cavity().points, claim);
  BestFitCertificate certificate = bound.certificate();
  EXPECT_EQ(check(claim, checker(certificate, {})), Verdict::unproved);  // of one it says nothing
  certificate.ranges.push_back({PoseDivision::none});
  EXPECT_EQ(check(claim, checker(certificate, {})), Verdict::proved);
}

TEST(BestFitCertificate, WithoutSenseProvesNoMoreThanTheWeights) {
  const CertifiedBound bound(small_hook(), 12, near_range, 0.25);
  const auto all = static_cast<double>(bound.cavity().points.size());
  const auto proven = [&](std::vector<PoseDivision> divisions) {
    return bound.proven(bound.claim(), {{std::move(divisions)}}).upper;
  };
  std::vector<PoseDivision> divisions = bound.certificate().ranges.front();
  divisions.pop_back();
  EXPECT_EQ(proven(divisions), all);
  divisions.insert(divisions.end(), 2, PoseDivision::none);
  EXPECT_EQ(proven(divisions), all);
  EXPECT_EQ(proven({}), all);
  EXPECT_EQ(proven({static_cast<PoseDivision>(9), PoseDivision::none, PoseDivision::none}), all);
  std::vector<PoseDivision> too_thin;
  too_thin.insert(too_thin.end(), 40, PoseDivision::about_x);
  too_thin.insert(too_thin.end(), 41, PoseDivision::none);
  EXPECT_EQ(proven(too_thin), all);
  EXPECT_EQ(bound.proven(bound.claim(), {}).upper, all);
}

TEST(BestFitCertificate, IsInterrupted) {
  const CertifiedBound bound(small_hook(), 12, near_range, 0.25);
  const Model& implant = bound.implant();
  const BestFitChecker checker({&implant, 1}, bound.cavity().points, bound.claim());
  CheckOptions options;
  options.interrupted = [] { return true; };
  const ProvenBestFit proven = checker(bound.certificate(), options);
  EXPECT_TRUE(proven.interrupted);
  EXPECT_EQ(check(bound.claim(), proven), Verdict::unproved);
}

TEST(BestFitChecker, RefusesWhatIsNoClaim) {
  const CertifiedBound bound(small_hook(), 4, range_about({}, 0.0, 0.0), 0.5);
  const Model implant = bound.implant();
  const auto refused = [&](const auto& change, const std::string& why) {
    BestFitClaim claim = bound.claim();
    change(claim);
    testing::expect_error(
        [&] {
          (void)BestFitChecker({&implant, 1}, bound.cavity().points, claim);
        },
        ErrorKind::input, why, "");
  };
  refused([](BestFitClaim& c) { c.range.translation = -1.0; },
          "range: translation: must be finite and at least 0, not -1");
  refused([](BestFitClaim& c) { c.range.rotation_degrees = 181.0; },
          "range: rotation: must lie in [0, 180] degrees, not 181");
  refused(
      [](BestFitClaim& c) {
        c.range.start.quaternion = {0.0, 0.0, 0.0, 0.0};
      },
      "range: start: must be finite, its quaternion not zero");
  refused([](BestFitClaim& c) { c.terms.fitness.scale = 0.0; }, "scale: must be positive, not 0");
  refused([](BestFitClaim& c) { c.terms.fitness.target = -1.0; }, "target: must be at least 0, not -1");
  refused([](BestFitClaim& c) { c.terms.penetration_limit = -1.0; }, "penetration limit: must be at least 0, not -1");
  refused([](BestFitClaim& c) { c.terms.areas[0].weight = -1.0; }, "area all: its weight must be at least 0, not -1");
  refused([](BestFitClaim& c) { c.terms.area_of.front() = 7; }, "points[0]: of no area");
  refused([](BestFitClaim& c) { c.upper = infinity; }, "upper: must be a number or minus infinity, not inf");
  refused([](BestFitClaim& c) { c.upper = std::nan(""); }, "upper: must be a number or minus infinity, not nan");
  refused([](BestFitClaim& c) { c.terms.areas[0].weight = 1e308; },
          "implants, points, weights or range: too large for the arithmetic of a bound");
  refused([](BestFitClaim& c) { c.centres.clear(); }, "centres: 0 of 1 implants");
}

/// False claims with the evidence of true ones, cut, changed, or made up. All of them are below F of a pose that the
/// range holds and that keeps the limit, found by another evaluation.
class ForgedBounds : public ::testing::TestWithParam<double> {};

std::vector<PoseDivision> random_divisions(std::mt19937_64& random) {
  std::vector<PoseDivision> divisions;
  int open = 1;
  while (open > 0) {
    const bool halved = divisions.size() < 40 && std::bernoulli_distribution(0.6)(random);
    divisions.push_back(halved ? static_cast<PoseDivision>(std::uniform_int_distribution<int>(0, 5)(random))
                               : PoseDivision::none);
    open += halved ? 1 : -1;
  }
  return divisions;
}

TEST_P(ForgedBounds, AreNotProvedByForgery) {
  const CertifiedBound bound(small_hook(GetParam()), 6, near_range, 0.3);
  ASSERT_TRUE(bound.is_proved(bound.claim(), bound.certificate()));
  std::mt19937_64 random(11);
  const auto share = [&random] { return std::uniform_real_distribution<double>(0.0, 1.0)(random); };
  int tried = 0;
  int proved = 0;
  const auto forge = [&](const BestFitClaim& claim, const BestFitCertificate& certificate) {
    ++tried;
    if (bound.is_proved(claim, certificate)) ++proved;
  };
  const auto changed = [&](BestFitCertificate certificate) {
    std::vector<PoseDivision>& divisions = certificate.ranges.front();
    const auto at = std::uniform_int_distribution<std::size_t>(0, divisions.size() - 1)(random);
    switch (std::uniform_int_distribution<int>(0, 3)(random)) {
      case 0: divisions.resize(at); break;
      case 1: divisions[at] = static_cast<PoseDivision>(std::uniform_int_distribution<int>(0, 7)(random)); break;
      case 2: divisions.erase(divisions.begin() + static_cast<std::ptrdiff_t>(at)); break;
      default: divisions = random_divisions(random);
    }
    return certificate;
  };
  for (std::size_t i = 0; i < oracle::requested_count("VERISQ_FORGED_BOUNDS", 3); ++i) {
    // Below what is reached.
    BestFitClaim low = bound.claim();
    low.upper = bound.best() * (1.0 - std::pow(10.0, -9.0 * share())) - 1e-9;
    forge(low, bound.certificate());
    forge(low, changed(bound.certificate()));
    // What weighs more reaches more.
    BestFitClaim heavy = bound.claim();
    heavy.terms.areas.front().weight = (1.0 + 1e-9 + share()) * bound.claim().upper / bound.best();
    forge(heavy, bound.certificate());
    forge(heavy, changed(bound.certificate()));
    // So does what is to lie nearer, or to be as good farther away.
    BestFitClaim coarse = bound.claim();
    coarse.terms.fitness.scale *= 2.0 + 8.0 * share();
    coarse.upper = static_cast<double>(bound.cavity().points.size()) * (value(coarse.terms.fitness, play) - 1e-9);
    forge(coarse, bound.certificate());
    forge(coarse, changed(bound.certificate()));
    // A range about a start that is turned and moved, and still holds the planted pose.
    BestFitClaim elsewhere = low;
    elsewhere.range =
        range_about({{share(), -share(), share()}, {1.0, 0.02 * share(), 0.0, -0.02 * share()}}, 2.0, 10.0);
    forge(elsewhere, bound.certificate());
    // No pose at all.
    BestFitClaim none = bound.claim();
    none.upper = -infinity;
    forge(none, changed(bound.certificate()));
    none.upper = 0.0;
    forge(none, bound.certificate());
  }
  std::cout << bound.certificate().ranges.front().size() << " divisions, ";
  EXPECT_EQ(proved, 0);
  RecordProperty("forgeries", tried);
  std::cout << tried << " forgeries, " << proved << " proved\n";
}

INSTANTIATE_TEST_SUITE_P(Tapers, ForgedBounds, ::testing::Values(1.0, 0.5, 3.0));

}  // namespace
}  // namespace verisq
