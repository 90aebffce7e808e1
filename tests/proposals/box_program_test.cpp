/// Linear programs over boxes: multipliers prove bounds that samples keep, and that are met.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "verify/proposals/multipliers.hpp"

namespace verisq::verify {
namespace {

double dual(const PoseParameters& objective, const PoseParameters& half, std::span<const LinearConstraint> constraints,
            std::span<const double> values) {
  PoseParameters slope = objective;
  double constant = 0.0;
  for (std::size_t j = 0; j < constraints.size(); ++j) {
    slope += values[j] * constraints[j].slope;
    constant += values[j] * constraints[j].constant;
  }
  return constant + slope.cwiseAbs().dot(half);
}

TEST(BoxProgram, SolvesWhatIsKnown) {
  // x <= 1/4 and y >= 1/2 in the box [-1, 1]^6: the largest of x - y + z is 1/4 - 1/2 + 1.
  const PoseParameters half = PoseParameters::Ones();
  PoseParameters objective = PoseParameters::Zero();
  objective.head<3>() << 1.0, -1.0, 1.0;
  std::vector<LinearConstraint> constraints{{0.25, -PoseParameters::Unit(0)}, {-0.5, PoseParameters::Unit(1)}};
  const Multipliers found = multipliers(objective, half, constraints);
  EXPECT_FALSE(found.ray);
  EXPECT_NEAR(dual(objective, half, constraints, found.values), 0.75, 1e-12);

  constraints.push_back({0.4, -PoseParameters::Unit(1)});  // y <= 0.4: nothing is left
  const Multipliers ray = multipliers(objective, half, constraints);
  ASSERT_TRUE(ray.ray);
  EXPECT_LT(dual(PoseParameters::Zero(), half, constraints, ray.values), 0.0);
}

TEST(BoxProgram, BoundsWhatSamplesReach) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto any = [&] {
    PoseParameters result;
    for (double& x : result) x = uniform(random);
    return result;
  };
  int rays = 0;
  for (int i = 0; i < 300; ++i) {
    const PoseParameters half = any().cwiseAbs();
    const PoseParameters objective = any();
    std::vector<LinearConstraint> constraints;
    for (int j = 0; j < 12; ++j) constraints.push_back({0.5 * uniform(random) + 0.2, any()});
    const Multipliers found = multipliers(objective, half, constraints);
    rays += found.ray ? 1 : 0;
    for (const double multiplier : found.values) ASSERT_GE(multiplier, 0.0);
    const double bound = dual(found.ray ? PoseParameters::Zero() : objective, half, constraints, found.values);
    // Proves that nothing is left; or no more than what the box alone leaves.
    EXPECT_LE(bound, found.ray ? -1e-15 : objective.cwiseAbs().dot(half) + 1e-12);
    for (int k = 0; k < 300; ++k) {
      const PoseParameters at = any().cwiseProduct(half);
      bool kept = true;
      for (const auto& [constant, slope, tightness] : constraints) kept = kept && constant + slope.dot(at) >= 0.0;
      if (!kept) continue;
      ASSERT_FALSE(found.ray);
      ASSERT_LE(objective.dot(at), bound + 1e-12);
    }
  }
  EXPECT_GT(rays, 5);
  EXPECT_LT(rays, 295);
}

}  // namespace
}  // namespace verisq::verify
