/// The bound of a fit: that no sampled pose exceeds it, within boxes and over the whole range, and that it gets tight.
#include "host/plan/fit_bound.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <random>

#include "host/prepare/eigen_points.hpp"
#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/fit_objective.hpp"
#include "tests/fixtures/offset_cavity.hpp"
#include "tests/fixtures/small_hook.hpp"
#include "verisq/distance.hpp"
#include "verisq/fit.hpp"

namespace verisq {
namespace {

using fit_search::BoundedImplant;
using verify::FitBoxResult;
using verify::PoseBox;
using verify::PoseParameters;
using verify::WeightedPoint;
using ::verisq::testing::FitObjective;
using ::verisq::testing::small_hook;

constexpr double kPlay = 0.5;

FitBoundOptions options(const Fitness& fitness, double translation, double degrees) {
  return {.fitness = fitness,
          .penetration_limit = 0.1,
          .range = {{{0.2, -0.3, 0.1}, {0.999, 0.01, -0.02, 0.015}}, translation, degrees},
          .known = 1.0,
          .gap = 0.05,
          .device = "auto"};
}

std::vector<WeightedPoint> weighted(const Cavity& cavity) {
  std::vector<WeightedPoint> points;
  for (std::size_t i = 0; i < cavity.points.size(); ++i)
    points.push_back({vector_of(cavity.points[i]), cavity.areas[cavity.area_of[i]].weight});
  return points;
}

std::array<double, 6> numbers(const PoseParameters& parameters) {
  std::array<double, 6> result{};
  std::ranges::copy(parameters, result.begin());
  return result;
}

class Poses {
 public:
  PoseParameters within(const PoseBox& box) {
    PoseParameters result = box.centre;
    for (Eigen::Index i = 0; i < 6; ++i) result[i] += uniform_(random_) * box.half[i];
    return result;
  }
  double share() { return uniform_(random_); }

 private:
  std::mt19937_64 random_{4};
  std::uniform_real_distribution<double> uniform_{-1.0, 1.0};
};

struct HookCase {
  Fitness fitness;
  double taper;
};

class BoundedHook : public ::testing::TestWithParam<HookCase> {};

TEST_P(BoundedHook, NoPoseOfABoxExceedsItsBound) {
  const Model hook = small_hook(GetParam().taper);
  const Cavity cavity = testing::offset_cavity(hook, kPlay, 40);
  const FitBoundOptions how = options(GetParam().fitness, 4.0, 20.0);
  const BoundedImplant bounded(UncertainModel(hook), weighted(cavity), how);
  FitObjective objective(cavity, how.fitness, how.penetration_limit);
  Poses poses;
  const PoseParameters range = Eigen::Map<const PoseParameters>(bounded.space().upper().data());
  int feasible = 0;
  int excluded = 0;
  double tightest = infinity;
  for (int i = 0; i < 200; ++i) {
    const double size = std::pow(2.0, 4.0 * poses.share() - 5.0);
    // Every other box about the pose that the cavity was made of, where poses keep the limit.
    PoseBox box{PoseParameters::Zero(), range * size};
    const PoseParameters anywhere = poses.within({PoseParameters::Zero(), range * (1.0 - size)});
    box.centre = i % 2 == 0 ? anywhere : 0.05 * anywhere;
    const FitBoxResult bound = bounded(box);
    if (bound.upper == -infinity) ++excluded;
    for (int k = 0; k < 10; ++k) {
      const std::optional<double> reached = objective(bounded.space(), numbers(poses.within(box)));
      if (!reached) continue;
      ++feasible;
      ASSERT_LE(*reached, bound.upper + 1e-6) << i;
      tightest = std::min(tightest, bound.upper / *reached);
    }
  }
  EXPECT_GT(feasible, 50);
  EXPECT_GT(excluded, 20);
  EXPECT_LT(tightest, GetParam().fitness.target > 0.0 ? 1.2 : 1.05);  // nearer than the target counts as at it
}

INSTANTIATE_TEST_SUITE_P(Completions, BoundedHook,
                         ::testing::Values(HookCase{cementless(0.5, 0.1), 1.0}, HookCase{cementless(3.0, 0.1), 4.0},
                                           HookCase{cemented(0.5, 0.25), 1.0}));

class FieldOfDistances : public ::testing::TestWithParam<double> {};

TEST_P(FieldOfDistances, EnclosesThem) {
  const Model model = small_hook(GetParam());
  const Cavity cavity = testing::offset_cavity(model, 3.0, 10);
  const BoundedImplant bounded(UncertainModel(model), weighted(cavity), options(cementless(1.0, 0.0), 4.0, 20.0));
  const SignedDistance distance(model);
  Poses poses;
  double loss_outside = 0.0;
  double loss_inside = 0.0;
  int outside = 0;
  int inside = 0;
  for (int i = 0; i < 400; ++i) {
    const double reach = i % 4 == 0 ? 100.0 : 12.0;
    const Eigen::Vector3d x(reach * poses.share(), reach * poses.share(), reach * poses.share());
    const Enclosure exact = distance(point_of(x), 1e-6);
    const auto [node, place] = bounded.field().near(x);
    const double lower =
        std::min({node.nearest[0].distance(x), node.nearest[1].distance(x), node.others - (x - place).norm()});
    if (exact.lo > 0.0) {
      ASSERT_LE(lower, exact.hi);
      loss_outside += exact.lo - lower;
      ++outside;
    }
    if (node.ball < 0) continue;
    const verify::InnerBall& ball = bounded.field().ball(node);
    const double upper = (x - ball.centre).norm() - ball.radius;
    ASSERT_GE(upper, exact.lo);
    if (exact.hi < 0.0) {
      loss_inside += upper - exact.hi;
      ++inside;
    }
  }
  EXPECT_GT(outside, 100);
  EXPECT_GT(inside, 15);
  EXPECT_LT(loss_outside / outside, 0.3);
  EXPECT_LT(loss_inside / inside, 1.0);
}

INSTANTIATE_TEST_SUITE_P(Tapers, FieldOfDistances, ::testing::Values(1.0, 0.3, 5.0));

/// The model's quaternions and the start's.
std::pair<Model, Pose> lengthened(Model model, Pose start, int by_model, int by_start) {
  for (Primitive& primitive : model.primitives)
    for (double& x : primitive.pose.quaternion) x = std::ldexp(x, by_model);
  for (double& x : start.quaternion) x = std::ldexp(x, by_start);
  return {model, start};
}

TEST(FitBound, DoesNotDependOnLengthsOfQuaternions) {
  const Model stone{"mm", {{"stone", {{1.0, 1.2, 1.5}, {1.0, 1.0}}, {{}, {1.0, 0.0, 1.0, 0.5}}, {}}}, {}};
  const Cavity cavity = testing::offset_cavity(stone, kPlay, 12);
  FitBoundOptions how = options(cementless(0.5, 0.1), 1.0, 10.0);
  how.device = "host";
  const BoundedImplant bounded(UncertainModel(stone), weighted(cavity), how);
  FitObjective objective(cavity, how.fitness, how.penetration_limit);
  Poses poses;
  const PoseParameters range = Eigen::Map<const PoseParameters>(bounded.space().upper().data());
  const std::array<std::array<int, 2>, 2> exponents{{{-700, 600}, {1000, -1000}}};
  for (const auto& [by_model, by_start] : exponents) {
    const auto [same, start] = lengthened(stone, how.range.start, by_model, by_start);
    FitBoundOptions from_there = how;
    from_there.range.start = start;
    const BoundedImplant other(UncertainModel(same), weighted(cavity), from_there);
    for (int i = 0; i < 20; ++i) {
      const PoseBox box{poses.within({PoseParameters::Zero(), 0.5 * range}), 0.02 * range};
      EXPECT_EQ(other(box).upper, bounded(box).upper) << by_model << " " << by_start;
      const auto at = numbers(poses.within(box));
      EXPECT_EQ(objective(other.space(), at), objective(bounded.space(), at)) << by_model << " " << by_start;
    }
  }
}

TEST(FitBound, ProvesAPlantedFitAndHoldsForSampledPoses) {
  const Model implant = small_hook();
  const Cavity cavity = testing::offset_cavity(implant, kPlay, 30);
  FitBoundOptions how = options(cementless(2.0, 0.0), 0.5, 2.0);
  how.range.start = {};
  how.penetration_limit = 0.0;
  const BoundedImplant bounded(UncertainModel(implant), weighted(cavity), how);
  FitObjective objective(cavity, how.fitness, how.penetration_limit);
  how.known = *objective(bounded.space(), numbers(PoseParameters::Zero()));
  int rounds = 0;
  how.progress = [&rounds](const FitBoundProgress&) { ++rounds; };
  how.out_of_time = [&rounds] { return rounds >= 40; };
  const UncertainModel exact = implant;
  const FitBound bound = bound_fit({&exact, 1}, cavity, how);
  EXPECT_TRUE(bound.reached);
  EXPECT_GE(how.known, (1.0 - how.gap) * bound.upper);
  EXPECT_LT(bound.upper, 0.999 * static_cast<double>(cavity.points.size()));  // less than all points served
  Poses poses;
  const PoseBox whole{PoseParameters::Zero(), Eigen::Map<const PoseParameters>(bounded.space().upper().data())};
  int feasible = 0;
  for (int i = 0; i < 500; ++i) {
    const std::optional<double> reached = objective(bounded.space(), numbers(poses.within(whole)));
    if (!reached) continue;
    ++feasible;
    ASSERT_LE(*reached, bound.upper);
  }
  EXPECT_GT(feasible, 5);
}

/// At first every point may serve as well as can be, so that ranges of fitness do not tell which direction matters.
TEST(FitBound, DividesWideRangesOfFewPoints) {
  const Model implant = small_hook();
  const Cavity cavity = testing::offset_cavity(implant, kPlay, 12);
  FitBoundOptions how = options(cementless(2.0, 0.0), 12.0, 12.0);
  how.range.start = {};
  how.penetration_limit = 0.0;
  how.known = value(how.fitness, kPlay) * static_cast<double>(cavity.points.size());
  int rounds = 0;
  how.progress = [&rounds](const FitBoundProgress&) { ++rounds; };
  how.out_of_time = [&rounds] { return rounds >= 60; };
  const UncertainModel exact = implant;
  const FitBound bound = bound_fit({&exact, 1}, cavity, how);
  EXPECT_TRUE(bound.reached) << bound.boxes;
  EXPECT_GE(bound.upper, how.known);
}

TEST(FitBound, OfOnePoseIsItsObjective) {
  const Model implant = small_hook();
  const Cavity cavity = testing::offset_cavity(implant, kPlay, 12);
  FitBoundOptions how = options(cementless(2.0, 0.0), 0.0, 0.0);
  how.range.start = {};
  how.penetration_limit = 0.0;
  const UncertainModel exact = implant;
  const FitBound bound = bound_fit({&exact, 1}, cavity, how);
  EXPECT_EQ(bound.boxes, 1U);
  const double objective = value(how.fitness, kPlay) * static_cast<double>(cavity.points.size());
  EXPECT_GE(bound.upper, objective * (1.0 - 1e-9));
  EXPECT_LE(bound.upper, objective * 1.05);
}

TEST(FitBound, SaysThatNoPoseKeepsTheLimit) {
  Cavity cavity = testing::offset_cavity(small_hook(), kPlay, 10);
  cavity.points.push_back({0.0, 0.0, 0.0});  // in the arm, wherever it is moved
  cavity.area_of.push_back(0);
  const UncertainModel exact = small_hook();
  const FitBound bound = bound_fit({&exact, 1}, cavity, options(cementless(2.0, 0.1), 0.5, 2.0));
  EXPECT_EQ(bound.upper, -infinity);
  EXPECT_FALSE(bound.promising);
}

TEST(FitBound, MeetsABetterPoseAndEndsInTime) {
  const Cavity cavity = testing::offset_cavity(small_hook(), kPlay, 20);
  FitBoundOptions how = options(cementless(2.0, 0.0), 1.0, 3.0);
  how.known = 0.5;  // as of a bad pose
  how.gap = 0.01;
  bool divided = false;
  how.progress = [&divided](const FitBoundProgress& progress) { divided = progress.boxes > 1; };
  how.out_of_time = [&divided] { return divided; };
  const UncertainModel exact = small_hook();
  const FitBound bound = bound_fit({&exact, 1}, cavity, how);
  EXPECT_TRUE(bound.out_of_time);
  EXPECT_FALSE(bound.reached);
  ASSERT_TRUE(bound.promising);
  EXPECT_GT(bound.promising->objective, how.known);
  EXPECT_LE(bound.promising->objective, bound.upper);
}

/// Boxes of a large mesh take long: few are looked at after the limit, and what is not looked at keeps its whole's
/// bound.
TEST(FitBound, EndsWithinABatchOfBoxes) {
  const Cavity cavity = testing::offset_cavity(small_hook(), kPlay, 20);
  const UncertainModel exact = small_hook();
  FitBoundOptions how = options(cementless(2.0, 0.0), 1.0, 3.0);
  how.known = 0.5;
  how.gap = 0.01;
  bool begun = false;
  std::size_t polls = 0;
  how.progress = [&begun](const FitBoundProgress& progress) { begun = begun || progress.open > 100; };
  how.out_of_time = [&] { return begun && ++polls > 20; };
  const FitBound bound = bound_fit({&exact, 1}, cavity, how);
  EXPECT_TRUE(bound.out_of_time);
  EXPECT_LT(bound.boxes, 1024U);
  EXPECT_GE(bound.upper, bound.promising ? bound.promising->objective : how.known);
}

TEST(FitBound, SaysNoMoreThanTheWeightsWhereItEndsBeforeItBegins) {
  const Cavity cavity = testing::offset_cavity(small_hook(), kPlay, 4);
  FitBoundOptions how = options(cementless(2.0, 0.0), 1.0, 3.0);
  how.out_of_time = [] { return true; };
  const UncertainModel exact = small_hook();
  const FitBound bound = bound_fit({&exact, 1}, cavity, how);
  EXPECT_TRUE(bound.out_of_time);
  EXPECT_FALSE(bound.reached);
  EXPECT_EQ(bound.upper, static_cast<double>(cavity.points.size()));
}

TEST(FitBound, HasNotTooManyNodesAboutANeedle) {
  const Model needle{"mm", {{"needle", {{1e-3, 1e-3, 1e3}, {1.0, 1.0}}, {}, {}}}, {}};
  const verify::DistanceField field(needle, 10.0, 1e4);
  EXPECT_LT(field.slabs(), 100'000U);
  const verify::DistanceField::Found found = field.near({0.0, 0.0, 0.0});
  EXPECT_LT((found.place - Eigen::Vector3d::Zero()).norm(), 10.0);
}

/// Where nothing is proposed, a primitive is still known to lie in its box.
TEST(FitBound, NeedsNoProposalToBeRight) {
  const Model ball{"mm", {{"ball", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {}, {}}}, {}};
  verify::DistanceField field(ball, 10.0, 100.0);
  for (std::size_t slab = 0; slab < field.slabs(); ++slab) {
    field.find_slab(slab, [](std::size_t, const Eigen::Vector3d&) {
      return Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    });
  }
  for (const double r : {0.5, 1.2, 4.0}) {
    const Eigen::Vector3d x(r, 0.1, -0.2);
    const auto [node, place] = field.near(x);
    const double lower =
        std::min({node.nearest[0].distance(x), node.nearest[1].distance(x), node.others - (x - place).norm()});
    EXPECT_LE(lower, x.norm() - 1.0);
  }
}

TEST(FitBound, NeedsNoProposalOfLengthOne) {
  const Model ball{"mm", {{"ball", {{1.0, 1.0, 1.0}, {1.0, 1.0}}, {}, {}}}, {}};
  for (const double length : {1e-320, 2e-162, 1e-160, 1e200, 1e308}) {
    verify::DistanceField field(ball, 3.0, 100.0);
    for (std::size_t slab = 0; slab < field.slabs(); ++slab) {
      field.find_slab(slab, [length](std::size_t, const Eigen::Vector3d& x) -> Eigen::Vector3d {
        return length * (x / (x.cwiseAbs().maxCoeff() + 1e-3));
      });
    }
    for (const double r : {0.1, 0.5, 1.2, 3.0}) {
      const Eigen::Vector3d x(0.6 * r, 0.64 * r, -0.48 * r);
      const verify::DistanceField::Node& node = field.near(x).node;
      const double lower = node.nearest[0].distance(x);
      EXPECT_LE(lower, r - 1.0) << length;
      EXPECT_GE(lower, r - 1.0 - 0.4) << length;
    }
  }
}

/// In binary32 the half-spaces of such a model would be no bounds.
TEST(FitBound, RefusesLengthsThatItsNumbersCannotHold) {
  for (const double size : {1e-40, 1e40, 1e-200, 1e200}) {
    const Cavity cavity{{{2.0 * size, 0.0, 0.0}}, {{"all", 1.0}}, {0}};
    const UncertainModel exact = Model{"mm", {{"ball", {{size, size, size}, {1.0, 1.0}}, {}, {}}}, {}};
    FitBoundOptions how = options(cementless(size, 0.0), size, 3.0);
    how.range.start.translation = {};
    EXPECT_THAT(
        [&] {
          (void)bound_fit({&exact, 1}, cavity, how);
        },
        ::testing::ThrowsMessage<Error>(::testing::HasSubstr("give all lengths in another unit")))
        << size;
  }
}

TEST(FitBound, RefusesSizesAndGapsOutOfRange) {
  const Cavity cavity = testing::offset_cavity(small_hook(), kPlay, 4);
  UncertainModel sized = small_hook();
  FitBoundOptions how = options(cementless(2.0, 0.0), 1.0, 3.0);
  how.gap = 1.0;
  testing::expect_error(
      [&] {
        (void)bound_fit({&sized, 1}, cavity, how);
      },
      ErrorKind::input, "gap to be proven: must lie between 0 and 1, not 1", "");
  how.gap = 0.1;
  sized.primitives[0].semi_axes[0] = {4.0, 5.0};
  testing::expect_error(
      [&] {
        (void)bound_fit({&sized, 1}, cavity, how);
      },
      ErrorKind::input, "implants[0]: has sizes to choose from, and the bound is of poses alone", "");
}

}  // namespace
}  // namespace verisq
