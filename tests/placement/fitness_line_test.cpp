/// Straight lines above the fitness, against the fitness itself.
#include <gtest/gtest.h>

#include <cmath>

#include "verify/search/fit_box_bound.hpp"

namespace verisq::verify {
namespace {

// Ranges in the concave part, in the convex part, across both, and inside the implant.
TEST(FitnessLine, LiesAboveTheFitnessAndTouchesIt) {
  for (const Fitness& fitness : {cementless(2.0, 0.5), cemented(1.5, 0.25)}) {
    for (double middle = -3.0; middle < 12.0; middle += 0.0625) {
      for (const double half : {0.0, 0.001, 0.1, 0.7, 2.0, 9.0}) {
        const FitnessLine line = fitness_line_above(fitness, middle, half);
        EXPECT_LE(line.slope, 0.0);
        double least = 1.0;
        for (int i = -64; i <= 64; ++i) {
          const double away = half * i / 64.0;
          const double above = line.value + line.slope * away - falling_fitness(fitness, middle + away);
          ASSERT_GE(above, -1e-14) << middle << " " << half << " " << away;
          ASSERT_GE(falling_fitness(fitness, middle + away), value(fitness, middle + away) - 1e-15);
          least = std::min(least, above);
        }
        EXPECT_LE(least, 1e-3) << middle << " " << half;
      }
    }
  }
}

TEST(FitnessLine, NoSlopeIsSteeperThanTheSteepest) {
  const Fitness fitness = cemented(1.0, 0.5);
  double steepest = 0.0;
  for (double d = 1.0; d < 5.0; d += 1e-4) steepest = std::max(steepest, -slope(fitness, d));
  EXPECT_LE(steepest, steepest_fitness_in_binary64(fitness));
  EXPECT_NEAR(steepest, steepest_fitness_in_binary64(fitness), 1e-6);
}

}  // namespace
}  // namespace verisq::verify
