/// The verified bounce against an independent integration in long double, in plain coordinates and units.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <vector>
#include <verisq/enclosure.hpp>
#include <verisq/stance.hpp>

#include "tests/fixtures/stance_example.hpp"
#include "verify/stance/bounce.hpp"

namespace verisq::stance {
namespace {

constexpr double kGravity = 9.81;

/// Of the relation ln((1 + D)/(1 - D e)) = D (1 + e), by bisection between its minimum and its pole.
long double reference_damping(long double e) {
  long double below = 1 / e - 1;
  long double above = 1 / e;
  for (int i = 0; i < 160; ++i) {
    const long double d = 0.5L * (below + above);
    const bool beyond = d * e >= 1 || std::log1p(d) - std::log1p(-d * e) > d * (1 + e);
    (beyond ? above : below) = d;
  }
  return 0.5L * (below + above);
}

/// The numbers of one bounce that a drop gives as ranges.
struct Sample {
  long double mass, restitution, impact_velocity;
};

/// Of a drop with one mass and one impact velocity.
Sample sample_of(const Drop& drop, long double restitution) {
  return {drop.mass.lo, restitution, drop.impact_velocity.lo};
}

struct ReferenceBounce {
  long double lift_off_time, rebound_speed, deepest;
  bool lifts_off;
};

/// Classical Runge-Kutta steps of adapted length, each with its halves and Richardson's extrapolation. The steps
/// shrink with the way to the ground, where the law is not smooth.
class ReferenceIntegration {
 public:
  ReferenceIntegration(const Drop& drop, const Sample& sample)
      : drop_(drop),
        sample_(sample),
        damping_(reference_damping(sample.restitution)),
        speed_(std::sqrt(2.0L * drop.gravity * drop.height)),
        unit_(std::pow(sample.mass / (drop.stiffness * std::pow(speed_, n() - 1)), 1 / (n() + 1))) {}

  [[nodiscard]] ReferenceBounce run(long double tolerance) const {
    State state{0, speed_};
    long double time = 0;
    long double deepest = 0;
    long double step = 1e-9L * unit_;
    const long double smallest = 1e-19L * unit_ * speed_;
    while (state.depth > smallest || state.velocity > 0) {
      if (state.velocity < 0) step = std::min(step, -0.5L * state.depth / state.velocity);
      const State whole = runge_kutta(state, step);
      const State halves = runge_kutta(runge_kutta(state, step / 2), step / 2);
      const long double error =
          std::max(std::abs(halves.depth - whole.depth) / unit_, std::abs(halves.velocity - whole.velocity)) / speed_;
      if (error > tolerance) {
        step *= 0.7L;
        continue;
      }
      const State next{halves.depth + (halves.depth - whole.depth) / 15,
                       halves.velocity + (halves.velocity - whole.velocity) / 15};
      if (state.velocity > 0 && next.velocity <= 0) deepest = deepest_between(state, step);
      if (state.velocity < 0 && next.velocity >= 0) return {infinity, 0, deepest, false};
      state = next;
      time += step;
      if (error < tolerance / 8) step *= 1.3L;
    }
    const long double fall = std::sqrt(2.0L * drop_.height / drop_.gravity);
    return {fall + time - state.depth / state.velocity, -state.velocity, deepest, true};
  }

 private:
  struct State {
    long double depth, velocity;
  };

  [[nodiscard]] long double n() const { return drop_.exponent; }

  [[nodiscard]] State slope(const State& s) const {
    const long double depth = std::max(s.depth, 0.0L);
    const long double elastic = drop_.stiffness * (drop_.exponent == 1.0 ? depth : depth * std::sqrt(depth));
    const long double damped = std::max(0.0L, 1 + damping_ * s.velocity / sample_.impact_velocity);
    return {s.velocity, drop_.gravity - elastic * damped / sample_.mass};
  }

  [[nodiscard]] State runge_kutta(const State& s, long double h) const {
    const auto moved = [&](const State& k, long double t) {
      return State{s.depth + t * k.depth, s.velocity + t * k.velocity};
    };
    const State a = slope(s);
    const State b = slope(moved(a, h / 2));
    const State c = slope(moved(b, h / 2));
    const State d = slope(moved(c, h));
    return {s.depth + h / 6 * (a.depth + 2 * b.depth + 2 * c.depth + d.depth),
            s.velocity + h / 6 * (a.velocity + 2 * b.velocity + 2 * c.velocity + d.velocity)};
  }

  /// The velocity vanishes within the step.
  [[nodiscard]] long double deepest_between(const State& s, long double step) const {
    long double before = 0;
    long double after = step;
    for (int i = 0; i < 64; ++i) {
      const long double t = 0.5L * (before + after);
      (runge_kutta(s, t).velocity > 0 ? before : after) = t;
    }
    return runge_kutta(s, before).depth;
  }

  Drop drop_;
  Sample sample_;
  long double damping_;
  long double speed_;
  long double unit_;  ///< of time
};

ReferenceBounce reference(const Drop& drop, const Sample& sample) {
  return ReferenceIntegration(drop, sample).run(1e-17L);
}

ReferenceBounce reference(const Drop& drop, long double restitution) {
  return reference(drop, sample_of(drop, restitution));
}

/// Whether the enclosure, widened by the reference's own error, contains the reference.
testing::AssertionResult encloses(const Enclosure& enclosure, long double value) {
  constexpr long double reference_error = 1e-13L;
  const long double slack = reference_error * std::abs(value);
  if (enclosure.lo <= value + slack && value - slack <= enclosure.hi) return testing::AssertionSuccess();
  return testing::AssertionFailure() << fmt::format("{:.17g} is not in [{:.17g}, {:.17g}]", static_cast<double>(value),
                                                    enclosure.lo, enclosure.hi);
}

void expect_encloses(const Bounce& bounce, const ReferenceBounce& exact) {
  EXPECT_TRUE(encloses(bounce.deepest_penetration, exact.deepest));
  EXPECT_TRUE(encloses(bounce.rebound_speed, exact.rebound_speed));
  if (exact.lifts_off) {
    EXPECT_TRUE(encloses(bounce.lift_off_time, exact.lift_off_time));
  } else {
    EXPECT_EQ(bounce.lift_off_time.hi, infinity);
  }
}

double relative_width(const Enclosure& e) {
  return e.width() / e.hi;
}

/// The same, with the touch-down speed for impact velocity, to nearest: the speed of the restitution.
Drop at_impact_velocity(Drop drop) {
  const double speed = std::sqrt(2.0) * std::sqrt(drop.gravity) * std::sqrt(drop.height);
  drop.impact_velocity = {speed, speed};
  return drop;
}

/// A forefoot's cylinder, so stiff that it lies still at `rest` m of penetration.
Drop forefoot(double mass, double exponent, double rest, const Enclosure& restitution) {
  return at_impact_velocity({.mass = {mass, mass},
                             .radius = {0.04, 0.2},
                             .height = 0.05,
                             .gravity = kGravity,
                             .stiffness = mass * kGravity / std::pow(rest, exponent),
                             .exponent = exponent,
                             .restitution = restitution,
                             .impact_velocity = {}});
}

std::string described(const Drop& d) {
  return fmt::format(
      "mass [{}, {}] height {} gravity {} stiffness {} exponent {} restitution [{}, {}] impact velocity [{}, {}]",
      d.mass.lo, d.mass.hi, d.height, d.gravity, d.stiffness, d.exponent, d.restitution.lo, d.restitution.hi,
      d.impact_velocity.lo, d.impact_velocity.hi);
}

TEST(StanceBounce, ReferenceAgreesWithItself) {
  for (const double exponent : {1.0, 1.5}) {
    const Drop drop = forefoot(0.36, exponent, 2e-5, {0.1, 0.1});
    const ReferenceIntegration integration(drop, sample_of(drop, 0.1L));
    const ReferenceBounce coarse = integration.run(1e-15L);
    const ReferenceBounce fine = integration.run(1e-18L);
    ASSERT_TRUE(fine.lifts_off);
    EXPECT_NEAR(static_cast<double>(coarse.rebound_speed / fine.rebound_speed), 1.0, 1e-12);
    EXPECT_NEAR(static_cast<double>(coarse.lift_off_time / fine.lift_off_time), 1.0, 1e-13);
  }
}

TEST(StanceBounce, FallIsInClosedForm) {
  const Bounce b = bounce(forefoot(0.36, 1.0, 1e-4, {0.2, 0.2}));
  EXPECT_TRUE(encloses(b.touch_down_time, std::sqrt(2.0L * 0.05 / kGravity)));
  EXPECT_TRUE(encloses(b.touch_down_speed, std::sqrt(2.0L * 0.05 * kGravity)));
  EXPECT_LT(relative_width(b.touch_down_time), 3e-16);
  EXPECT_LT(relative_width(b.touch_down_speed), 3e-16);
}

TEST(StanceBounce, ReboundOfThinRestitutionIsTight) {
  for (const double restitution : {0.1, 0.2}) {
    for (const double exponent : {1.0, 1.5}) {
      for (const double mass : {0.36, 35.0}) {
        const Drop drop = forefoot(mass, exponent, 2e-5, {restitution, restitution});
        SCOPED_TRACE(described(drop));
        const Bounce b = bounce(drop);
        EXPECT_TRUE(b.proven);
        const ReferenceBounce exact = reference(drop, restitution);
        ASSERT_TRUE(exact.lifts_off);
        expect_encloses(b, exact);
        EXPECT_LT(relative_width(b.rebound_speed), 1e-5);
        EXPECT_LT(relative_width(b.lift_off_time), 1e-6);
        EXPECT_LT(relative_width(b.deepest_penetration), 1e-5);
        EXPECT_TRUE(encloses(b.effective_restitution, exact.rebound_speed / std::sqrt(2.0L * 0.05 * kGravity)));
      }
    }
  }
}

TEST(StanceBounce, ContainsTheReferenceForManyDrops) {
  std::mt19937 random(6);
  const auto uniform = [&](double lowest, double highest) {
    return std::uniform_real_distribution(lowest, highest)(random);
  };
  int lifted = 0;
  int stayed = 0;
  for (int i = 0; i < 120; ++i) {
    const double restitution = uniform(0.03, 0.97);
    Drop drop = forefoot(std::exp(uniform(-3.0, 5.0)), i % 2 == 0 ? 1.0 : 1.5, std::exp(uniform(-14.0, -5.0)),
                         {restitution, restitution});
    drop.height = std::exp(uniform(-6.0, 0.0));
    drop = at_impact_velocity(drop);
    SCOPED_TRACE(described(drop));
    const Bounce b = bounce(drop, {.relative_tolerance = i % 3 == 0 ? 1e-12 : 1e-6});
    const ReferenceBounce exact = reference(drop, restitution);
    EXPECT_TRUE(b.proven);
    expect_encloses(b, exact);
    EXPECT_LT(b.rebound_speed.width(), 1e-4 * static_cast<double>(exact.rebound_speed) + 1e-6);
    ++(exact.lifts_off ? lifted : stayed);
  }
  EXPECT_GT(lifted, 30);
  EXPECT_GT(stayed, 5);
}

TEST(StanceBounce, SmallerToleranceIsTighter) {
  const Drop drop = forefoot(0.36, 1.0, 2e-5, {0.2, 0.2});
  const Bounce coarse = bounce(drop, {.relative_tolerance = 1e-5});
  const Bounce fine = bounce(drop, {.relative_tolerance = 1e-13});
  EXPECT_LT(fine.rebound_speed.width(), 1e-3 * coarse.rebound_speed.width());
  EXPECT_GT(fine.steps, coarse.steps);
}

TEST(StanceBounce, IntervalRestitutionGivesTheHull) {
  for (const double exponent : {1.0, 1.5}) {
    const Drop drop = forefoot(0.36, exponent, 2e-5, {0.1, 0.2});
    SCOPED_TRACE(described(drop));
    const Bounce b = bounce(drop);
    EXPECT_TRUE(b.proven);
    for (int i = 0; i <= 16; ++i) expect_encloses(b, reference(drop, 0.1L + 0.1L * i / 16));
    const ReferenceBounce least = reference(drop, 0.1L);
    const ReferenceBounce most = reference(drop, 0.2L);
    EXPECT_NEAR(b.rebound_speed.lo, static_cast<double>(least.rebound_speed), 1e-5);
    EXPECT_NEAR(b.rebound_speed.hi, static_cast<double>(most.rebound_speed), 1e-5);
    EXPECT_NEAR(b.deepest_penetration.lo, static_cast<double>(least.deepest), 1e-8);
    EXPECT_NEAR(b.deepest_penetration.hi, static_cast<double>(most.deepest), 1e-8);
    // By subdivision alone: it takes longest with the smallest restitution.
    const auto contact = static_cast<double>(least.lift_off_time - most.lift_off_time);
    EXPECT_LT(b.lift_off_time.width(), 1.5 * contact);
  }
}

TEST(StanceBounce, ReproducesTheRestitutionWhereGravityIsNegligible) {
  for (const double exponent : {1.0, 1.5}) {
    for (const double restitution : {0.02, 0.1, 0.2, 0.5, 0.9}) {
      const Drop drop{.mass = {1.0, 1.0},
                      .radius = {0.1, 0.1},
                      .height = 5e11,
                      .gravity = 1e-12,  // so that the touch-down speed is 1 m/s
                      .stiffness = 1.0,
                      .exponent = exponent,
                      .restitution = {restitution, restitution},
                      .impact_velocity = {1.0, 1.0}};
      const Bounce b = bounce(drop, {.relative_tolerance = 1e-10});
      EXPECT_TRUE(b.proven);
      EXPECT_NEAR(b.effective_restitution.lo, restitution, 1e-8 * restitution);
      EXPECT_NEAR(b.effective_restitution.hi, restitution, 1e-8 * restitution);
    }
  }
}

TEST(StanceBounce, StaysOnSoftGround) {
  for (const double exponent : {1.0, 1.5}) {
    const Drop drop = forefoot(35.0, exponent, 3e-3, {0.1, 0.1});
    ASSERT_FALSE(reference(drop, 0.1L).lifts_off);
    const Bounce b = bounce(drop);
    EXPECT_TRUE(b.proven);
    EXPECT_EQ(b.rebound_speed, (Enclosure{0.0, 0.0}));
    EXPECT_EQ(b.effective_restitution, (Enclosure{0.0, 0.0}));
    EXPECT_EQ(b.lift_off_time.hi, infinity);
    EXPECT_GT(b.lift_off_time.lo, b.touch_down_time.hi);
  }
}

TEST(StanceBounce, RestitutionThatAllowsBothModes) {
  const Drop drop = forefoot(0.36, 1.0, 3.3e-4, {0.1, 0.2});
  ASSERT_FALSE(reference(drop, 0.1L).lifts_off);
  const ReferenceBounce most = reference(drop, 0.2L);
  ASSERT_TRUE(most.lifts_off);
  const Bounce b = bounce(drop);
  EXPECT_TRUE(b.proven);
  EXPECT_EQ(b.rebound_speed.lo, 0.0);
  EXPECT_NEAR(b.rebound_speed.hi, static_cast<double>(most.rebound_speed), 1e-5);
  EXPECT_EQ(b.lift_off_time.hi, infinity);
  for (int i = 0; i <= 8; ++i) expect_encloses(b, reference(drop, 0.1L + 0.1L * i / 8));
}

TEST(StanceBounce, GrazingTakesBothModes) {
  Drop drop = forefoot(0.36, 1.0, 3.3e-4, {0.1, 0.1});
  double stays = 0.1;
  double lifts_off = 0.2;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (stays + lifts_off);
    (reference(drop, middle).lifts_off ? lifts_off : stays) = middle;
  }
  drop.restitution = {stays - 1e-9, lifts_off + 1e-9};
  const Bounce b = bounce(drop);
  EXPECT_TRUE(b.proven);
  EXPECT_EQ(b.rebound_speed.lo, 0.0);
  EXPECT_TRUE(encloses(b.rebound_speed, reference(drop, drop.restitution.hi).rebound_speed));
  EXPECT_LT(b.rebound_speed.hi, 0.01);
  EXPECT_EQ(b.lift_off_time.hi, infinity);
}

TEST(StanceBounce, ContactPhaseLeavesAGrazingOutcomeOpen) {
  // One damping factor, next to that at which the body comes back to the surface with no speed.
  const BounceFlow flow(1.0);
  const auto outcome = [&](double damping) { return contact_phase(flow, Interval(0.1), Interval(damping), 1e-8, {}); };
  EXPECT_EQ(outcome(4.36).outcome, Outcome::lifts_off);
  EXPECT_EQ(outcome(4.363).outcome, Outcome::stays);
  const ContactPhase grazing = outcome(4.3614501133561134);
  EXPECT_EQ(grazing.outcome, Outcome::either);
  EXPECT_EQ(grazing.rebound.lower(), 0.0);
  EXPECT_LT(grazing.rebound.upper(), 1e-3);
  EXPECT_EQ(grazing.lift_off.upper(), infinity);
}

/// A cylinder of the nine-segment model with all numbers of its body and contact, dropped from rest.
Drop dropped(const std::string& name, double height) {
  const Model model = nine_segments();
  const auto cylinder = std::ranges::find(model.cylinders, name, &ContactCylinder::name);
  return {.mass = model.bodies.at(cylinder->body).mass.range,
          .radius = cylinder->radius.range,
          .height = height,
          .gravity = model.gravity,
          .stiffness = cylinder->stiffness.nominal,
          .exponent = cylinder->exponent,
          .restitution = cylinder->normal_restitution.range,
          .impact_velocity = cylinder->impact_velocity.range};
}

/// The range's ends times the factor's.
Enclosure scaled(const Enclosure& range, const Enclosure& factor) {
  return {range.lo * factor.lo, range.hi * factor.hi};
}

/// The corners of the box of mass, restitution and impact velocity, then random points, `count` in all.
std::vector<Sample> samples_of(const Drop& drop, int count, std::mt19937& random) {
  std::vector<Sample> samples;
  for (const double mass : {drop.mass.lo, drop.mass.hi}) {
    for (const double restitution : {drop.restitution.lo, drop.restitution.hi}) {
      for (const double speed : {drop.impact_velocity.lo, drop.impact_velocity.hi}) {
        samples.push_back({mass, restitution, speed});
      }
    }
  }
  const auto within = [&](const Enclosure& range) {
    return std::uniform_real_distribution<double>(range.lo, range.hi)(random);
  };
  while (std::ssize(samples) < count) {
    samples.push_back({within(drop.mass), within(drop.restitution), within(drop.impact_velocity)});
  }
  return samples;
}

/// What the samples attain.
struct Attained {
  Enclosure deepest{infinity, -infinity};
  Enclosure rebound{infinity, -infinity};
  Enclosure lift_off{infinity, -infinity};
  int lifted = 0;
  int stayed = 0;

  void add(const ReferenceBounce& exact) {
    extend(deepest, exact.deepest);
    extend(rebound, exact.rebound_speed);
    if (exact.lifts_off) extend(lift_off, exact.lift_off_time);
    ++(exact.lifts_off ? lifted : stayed);
  }

 private:
  static void extend(Enclosure& hull, long double value) {
    hull = {std::min(hull.lo, static_cast<double>(value)), std::max(hull.hi, static_cast<double>(value))};
  }
};

/// Expects that the bounce contains the samples. Their error is far below what the bounce's own tolerance widens.
Attained expect_encloses_samples(const Bounce& bounce, const Drop& drop, int count) {
  std::mt19937 random(14);
  Attained attained;
  for (const Sample& sample : samples_of(drop, count, random)) {
    const ReferenceBounce exact = ReferenceIntegration(drop, sample).run(1e-15L);
    SCOPED_TRACE(fmt::format("mass {} restitution {} impact velocity {}", static_cast<double>(sample.mass),
                             static_cast<double>(sample.restitution), static_cast<double>(sample.impact_velocity)));
    expect_encloses(bounce, exact);
    attained.add(exact);
  }
  return attained;
}

/// Expects that each end is that of the samples to one per cent of their hull's width.
void expect_tight(const Enclosure& enclosure, const Enclosure& attained) {
  EXPECT_NEAR(enclosure.lo, attained.lo, 0.01 * attained.width());
  EXPECT_NEAR(enclosure.hi, attained.hi, 0.01 * attained.width());
}

constexpr int kSamples = 1000;

TEST(StanceBounce, FeetOfUncertainMassAndImpactVelocityContainAThousandSamples) {
  for (const char* name : {"right hindfoot", "right forefoot"}) {
    Drop drop = dropped(name, 0.05);
    drop.mass = scaled(drop.mass, {0.5, 1.5});
    drop.restitution = {0.15, 0.15};
    drop.impact_velocity = {0.8, 1.25};
    SCOPED_TRACE(described(drop));
    const Bounce b = bounce(drop);
    EXPECT_TRUE(b.proven);
    const Attained attained = expect_encloses_samples(b, drop, kSamples);
    EXPECT_EQ(attained.stayed, 0);
    expect_tight(b.deepest_penetration, attained.deepest);
    expect_tight(b.rebound_speed, attained.rebound);
    expect_tight(b.lift_off_time, attained.lift_off);
  }
}

TEST(StanceBounce, FeetThatMayStayContainAThousandSamples) {
  for (const char* name : {"right hindfoot", "right forefoot"}) {
    Drop drop = dropped(name, 0.01);
    drop.mass = scaled(drop.mass, {0.5, 1.5});
    drop.restitution = {0.02, 0.2};
    drop.impact_velocity = {0.8, 1.25};
    SCOPED_TRACE(described(drop));
    const Bounce b = bounce(drop);
    EXPECT_TRUE(b.proven);
    const Attained attained = expect_encloses_samples(b, drop, kSamples);
    EXPECT_GT(attained.stayed, 10);
    EXPECT_GT(attained.lifted, 10);
    expect_tight(b.deepest_penetration, attained.deepest);
    expect_tight(b.rebound_speed, attained.rebound);
    EXPECT_EQ(b.rebound_speed.lo, 0.0);
    EXPECT_EQ(b.lift_off_time.hi, infinity);
    EXPECT_NEAR(b.lift_off_time.lo, attained.lift_off.lo, 0.01 * attained.lift_off.lo);
  }
}

TEST(StanceBounce, MassAloneMovesThePenetrationByItsEnds) {
  Drop drop = at_impact_velocity(dropped("right forefoot", 0.01));
  drop.mass = {0.18, 0.54};
  drop.restitution = {0.105, 0.105};
  const Bounce b = bounce(drop);
  EXPECT_TRUE(b.proven);
  EXPECT_NEAR(b.deepest_penetration.lo, 2.391e-4, 1e-7);
  EXPECT_NEAR(b.deepest_penetration.hi, 4.178e-4, 1e-7);
  EXPECT_EQ(b.rebound_speed.lo, 0.0) << "0.54 kg do not lift off";
  (void)expect_encloses_samples(b, drop, 50);
}

TEST(StanceBounce, ImpactVelocityDamps) {
  const auto rebound = [](const char* name, double speed) {
    Drop drop = dropped(name, 0.01);
    drop.restitution = {0.105, 0.105};
    drop.impact_velocity = {speed, speed};
    const Bounce b = bounce(drop);
    EXPECT_TRUE(b.proven);
    expect_encloses(b, reference(drop, drop.restitution.lo));
    return b.rebound_speed;
  };
  EXPECT_NEAR(rebound("right forefoot", 1.0).lo, 0.07699, 1e-5);
  EXPECT_NEAR(rebound("right hindfoot", 1.0).lo, 0.0606, 1e-4);
  // The touch-down speed, to nearest.
  EXPECT_NEAR(rebound("right forefoot", 0.4429446918070021).lo, 0.01323, 1e-5);
  EXPECT_EQ(rebound("right hindfoot", 0.4429446918070021).hi, 0.0);
  // Much slower and much faster than the touch-down.
  EXPECT_EQ(rebound("right forefoot", 0.05).hi, 0.0);
  EXPECT_GT(rebound("right forefoot", 100.0).lo, 0.96 * 0.4429446918070021);
}

TEST(StanceBounce, ContainsTheSamplesOfManyBoxes) {
  std::mt19937 random(15);
  const auto uniform = [&](double lowest, double highest) {
    return std::uniform_real_distribution(lowest, highest)(random);
  };
  int both_modes = 0;
  for (int i = 0; i < 20; ++i) {
    Drop drop = forefoot(std::exp(uniform(-3.0, 5.0)), i % 2 == 0 ? 1.0 : 1.5, std::exp(uniform(-10.0, -5.0)), {});
    const double restitution = uniform(0.05, 0.8);
    drop.restitution = {restitution, restitution + uniform(0.0, 0.15)};
    drop.mass = scaled(drop.mass, {uniform(0.4, 1.0), uniform(1.0, 2.5)});
    const double speed = std::exp(uniform(-1.0, 2.0));
    drop.impact_velocity = scaled(drop.impact_velocity, {speed, speed * uniform(1.0, 1.5)});
    SCOPED_TRACE(described(drop));
    const Bounce b = bounce(drop);
    EXPECT_TRUE(b.proven);
    const Attained attained = expect_encloses_samples(b, drop, 20);
    if (attained.lifted > 0 && attained.stayed > 0) ++both_modes;
    expect_tight(b.deepest_penetration, attained.deepest);
  }
  EXPECT_GT(both_modes, 1);
}

TEST(StanceBounce, RefusesAbsurdDrops) {
  const Drop good = forefoot(0.36, 1.0, 2e-5, {0.1, 0.2});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](const Drop& drop) {
    const Bounce b = bounce(drop);
    return !b.proven && b.rebound_speed == Enclosure{-infinity, infinity};
  };
  for (const double bad : {0.0, -1.0, infinity, nan}) {
    for (double Drop::*const member : {&Drop::height, &Drop::gravity, &Drop::stiffness, &Drop::exponent}) {
      Drop drop = good;
      drop.*member = bad;
      EXPECT_TRUE(refused(drop)) << described(drop);
    }
    for (Enclosure Drop::*const member : {&Drop::mass, &Drop::impact_velocity}) {
      for (const Enclosure range : {Enclosure{bad, 1.0}, {1.0, bad}, {bad, bad}, {0.5, 0.25}}) {
        Drop drop = good;
        drop.*member = range;
        EXPECT_TRUE(refused(drop)) << described(drop);
      }
    }
  }
  for (const Enclosure bad : {Enclosure{0.2, 0.1}, {0.0, 0.1}, {0.5, 1.0}, {-0.1, 0.1}, {nan, 0.1}, {0.1, nan}}) {
    Drop drop = good;
    drop.restitution = bad;
    EXPECT_TRUE(refused(drop)) << described(drop);
    drop = good;
    drop.radius = {bad.hi - 0.1, bad.lo - 0.1};
    EXPECT_TRUE(refused(drop) || drop.radius.lo > 0.0) << described(drop);
  }
  Drop cubic = good;
  cubic.exponent = 2.0;
  EXPECT_TRUE(refused(cubic));
}

TEST(StanceBounce, IsHonestAtTheEndsOfTheNumbers) {
  const Drop good = forefoot(0.36, 1.5, 2e-5, {0.1, 0.2});
  int calls = 0;
  const BounceOptions short_run{.interrupted = [&] { return ++calls > 300; }};
  for (const double extreme : {1e-320, 1e-300, 1e-100, 1e100, 1e300}) {
    for (double Drop::*const member : {&Drop::height, &Drop::gravity, &Drop::stiffness}) {
      Drop drop = good;
      drop.*member = extreme;
      drop = at_impact_velocity(drop);
      SCOPED_TRACE(described(drop));
      calls = 0;
      const Bounce b = bounce(drop, short_run);
      EXPECT_LE(b.rebound_speed.lo, b.rebound_speed.hi);
      EXPECT_LE(b.effective_restitution.lo, 0.2);
      // Contact takes energy: nothing rebounds faster than it came.
      EXPECT_LE(b.effective_restitution.hi, b.proven ? 0.2001 : infinity);
    }
    for (const Enclosure mass : {Enclosure{extreme, extreme}, {std::min(0.36, extreme), std::max(0.36, extreme)}}) {
      Drop drop = good;
      drop.mass = mass;
      SCOPED_TRACE(described(drop));
      calls = 0;
      const Bounce b = bounce(drop, short_run);
      EXPECT_LE(b.effective_restitution.lo, 0.2);
      EXPECT_LE(b.effective_restitution.hi, b.proven ? 0.2001 : infinity);
    }
    // With the least damping, it rebounds as fast as it came.
    Drop drop = good;
    drop.impact_velocity = {extreme, extreme};
    SCOPED_TRACE(described(drop));
    calls = 0;
    const Bounce b = bounce(drop, short_run);
    EXPECT_LE(b.effective_restitution.lo, 1.0);
    EXPECT_LE(b.effective_restitution.hi, b.proven ? 1.0001 : infinity);
    EXPECT_EQ(b.effective_restitution.lo > 0.99, b.proven && extreme > 1.0);
  }
  Drop dead = good;
  for (const double restitution : {1e-300, 1e-9}) {
    dead.restitution = {restitution, restitution};
    calls = 0;
    EXPECT_FALSE(bounce(dead, short_run).proven);
  }
}

TEST(StanceBounce, ImpossibleToleranceIsNotProven) {
  const Drop drop = forefoot(0.36, 1.0, 2e-5, {0.1, 0.1});
  const ReferenceBounce exact = reference(drop, 0.1L);
  for (const double tolerance : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    const Bounce b = bounce(drop, {.relative_tolerance = tolerance});
    EXPECT_FALSE(b.proven);
    expect_encloses(b, exact);
  }
}

TEST(StanceBounce, InterruptedHalfwayStillContains) {
  const Drop drop = forefoot(0.36, 1.0, 2e-5, {0.1, 0.1});
  const ReferenceBounce exact = reference(drop, 0.1L);
  for (const int allowed : {0, 1, 10, 40}) {
    int calls = 0;
    const Bounce b = bounce(drop, {.interrupted = [&] { return ++calls > allowed; }});
    EXPECT_FALSE(b.proven);
    EXPECT_LE(b.steps, allowed);
    EXPECT_EQ(b.lift_off_time.hi, infinity);
    expect_encloses(b, exact);
  }
}

TEST(StanceBounce, InterruptedAmidRangesStillContains) {
  Drop drop = dropped("right forefoot", 0.05);
  drop.mass = {0.18, 0.54};
  drop.restitution = {0.15, 0.15};
  drop.impact_velocity = {0.8, 1.25};
  for (const int allowed : {0, 5, 30, 60, 200}) {
    int calls = 0;
    const Bounce b = bounce(drop, {.interrupted = [&] { return ++calls > allowed; }});
    EXPECT_FALSE(b.proven);
    (void)expect_encloses_samples(b, drop, 12);
  }
}

/// x' = v, v' = -x, time' = 1.
struct Oscillator {
  static constexpr int size = 3;

  template <class T>
  [[nodiscard]] std::vector<StateVector<T, size>> taylor_coefficients(const StateVector<T, size>& state,
                                                                      std::size_t order) const {
    std::vector<StateVector<T, size>> result{state};
    for (std::size_t k = 0; k < order; ++k) {
      const T next(Interval(static_cast<int>(k) + 1));
      StateVector<T, size> coefficient;
      coefficient << T(result[k][1] / next), T(-result[k][0] / next), T(k == 0 ? 1 : 0);
      result.push_back(coefficient);
    }
    return result;
  }
};

ReachableSet<3> oscillator_start() {
  StateBox<3> box;
  box << Interval(0.9, 1.1), Interval(-0.1, 0.1), Interval(0);
  return ReachableSet<3>::of(box);
}

TEST(VerifiedIntegration, RotationDoesNotWrap) {
  const Oscillator oscillator;
  ReachableSet<3> set = oscillator_start();
  for (int i = 0; i < 400; ++i) {
    const std::optional<TaylorStep<Oscillator>> step = TaylorStep<Oscillator>::attempt(oscillator, set, 0.25, 1e-12);
    ASSERT_TRUE(step);
    set = step->at(0.25);
  }
  for (const double x : {0.9, 1.0, 1.1}) {
    for (const double v : {-0.1, 0.0, 0.1}) {
      const double c = std::cos(100.0);
      const double s = std::sin(100.0);
      EXPECT_TRUE(encloses({set.hull[0].lower(), set.hull[0].upper()}, x * c + v * s));
      EXPECT_TRUE(encloses({set.hull[1].lower(), set.hull[1].upper()}, v * c - x * s));
    }
  }
  // The square's diagonal is 0.283; axis-parallel boxes alone would have grown by e^100.
  EXPECT_LT(set.hull[0].upper() - set.hull[0].lower(), 0.6);
  EXPECT_LT(set.hull[1].upper() - set.hull[1].lower(), 0.6);
}

TEST(VerifiedIntegration, CrossingHoldsForEveryStateOfTheSet) {
  const Oscillator oscillator;
  ReachableSet<3> set = oscillator_start();
  const auto advance = [&](double length) {
    const std::optional<TaylorStep<Oscillator>> step = TaylorStep<Oscillator>::attempt(oscillator, set, length, 1e-9);
    return step.value();
  };
  for (int i = 0; i < 5; ++i) {
    const TaylorStep<Oscillator> step = advance(0.25);
    EXPECT_EQ(crossing(step, step.at(0.25), 0), Crossing::none);
    set = step.at(0.25);
  }
  const TaylorStep<Oscillator> early = advance(0.3);  // ends amid the crossings, at 1.55
  EXPECT_EQ(crossing(early, early.at(0.3), 0), Crossing::unclear);
  const TaylorStep<Oscillator> step = advance(0.55);
  ASSERT_EQ(crossing(step, step.at(0.55), 0), Crossing::falling);
  const StateBox<3> state = state_at_crossing(oscillator, step, 0);
  EXPECT_EQ(state[0].lower(), 0.0);
  EXPECT_EQ(state[0].upper(), 0.0);
  for (const double x : {0.9, 1.0, 1.1}) {
    for (const double v : {-0.1, 0.0, 0.1}) {
      EXPECT_TRUE(encloses({state[1].lower(), state[1].upper()}, -std::hypot(x, v)));
      EXPECT_TRUE(encloses({state[2].lower(), state[2].upper()}, std::atan2(x, -v)));
    }
  }
  EXPECT_LT(state[2].upper() - state[2].lower(), 0.35);  // exactly 2 atan(1/9), 0.221
}

}  // namespace
}  // namespace verisq::stance
