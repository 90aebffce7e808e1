/// Equilibria against an independent formulation: the least potential energy.
#include "verisq/stance_equilibrium.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <random>
#include <verisq/error.hpp>
#include <verisq/stance.hpp>

#include "tests/oracle/standing_energy.hpp"

namespace verisq::stance {
namespace {

using namespace oracle;

double middle(const Enclosure& a) {
  return 0.5 * a.lo + 0.5 * a.hi;
}

constexpr double numerical = 1e-9;  // of the differences

void expect_holds(const Enclosure& enclosure, Real sample, const std::string& what) {
  EXPECT_GE(static_cast<double>(sample), enclosure.lo - numerical) << what;
  EXPECT_LE(static_cast<double>(sample), enclosure.hi + numerical) << what;
}

TEST(StandingEquilibrium, IsThatOfTheIndependentFigures) {
  const Model model = standing_model();
  const Equilibrium found = equilibrium(model, {}, {});
  ASSERT_EQ(found.stands, 1.0);
  const Standing& standing = found.standing.value();
  EXPECT_NEAR(middle(standing.positions[ty]), 0.97697155, 5e-9);
  EXPECT_NEAR(middle(standing.positions[rz]), 0.01419251, 5e-9);
  EXPECT_NEAR(middle(standing.loads[0].force), 293.831, 5e-4);
  EXPECT_NEAR(middle(standing.loads[1].force), 102.591, 5e-4);
  for (const Enclosure& position : standing.positions) EXPECT_LE(position.width(), 1e-9);
  for (const CylinderLoad& load : standing.loads) EXPECT_LE(load.force.width(), 1e-9);
  // Hip, knee, ankle and toes of a leg.
  const std::array torques{-17.348, -15.529, -13.283, -2.403};
  const std::array<std::size_t, 4> joints{6, 9, 12, 15};
  for (std::size_t i = 0; i < joints.size(); ++i)
    EXPECT_NEAR(middle(standing.torques[joints[i]]), torques[i], 5e-4) << joints[i];
}

TEST(StandingEquilibrium, IsOfLeastEnergy) {
  const Model model = standing_model();
  const std::vector<double> parameters = nominal(model);
  const Positions q = Energy(model, parameters, Joints::stiff).stationary(of_file(model));
  const Standing standing = equilibrium(model, {}, {}).standing.value();
  for (const std::size_t joint : {ty, rz, rx}) expect_holds(standing.positions[joint], q[joint], std::to_string(joint));
}

TEST(StandingEquilibrium, HoldsSamplesOfABoxAndHardlyMore) {
  const Model model = within_one_per_cent(standing_model());
  const std::vector<std::uint32_t> uncertain = indices(model, {"mp", "px", "py", "k"});
  const Equilibrium found = equilibrium(model, uncertain, {});
  ASSERT_EQ(found.stands, 1.0);
  const Standing& standing = found.standing.value();
  std::mt19937_64 random(1);
  std::array<Enclosure, 2> hull{Enclosure{infinity, -infinity}, Enclosure{infinity, -infinity}};
  const std::array joints{ty, rz};
  for (int sample = 0; sample < 64; ++sample) {
    std::vector<double> parameters = nominal(model);
    for (std::size_t k = 0; k < uncertain.size(); ++k) {
      const Enclosure& range = model.parameters[uncertain[k]].range;
      const bool corner = sample < 16;
      const double share = corner ? (sample >> k) & 1 : std::uniform_real_distribution<double>(0, 1)(random);
      parameters[uncertain[k]] = range.lo + share * (range.hi - range.lo);
    }
    const Energy energy(model, parameters, Joints::stiff);
    const Positions q = energy.stationary(of_file(model));
    for (const std::size_t joint : {ty, rz, rx}) expect_holds(standing.positions[joint], q[joint], "sample");
    const std::vector<Real> depths = energy.penetrations(q);
    for (std::size_t i = 0; i < depths.size(); ++i)
      expect_holds(standing.loads[i / 2].penetration, depths[i], "penetration");
    for (std::size_t i = 0; i < 2; ++i) {
      hull[i].lo = std::min(hull[i].lo, static_cast<double>(q[joints[i]]));
      hull[i].hi = std::max(hull[i].hi, static_cast<double>(q[joints[i]]));
    }
  }
  for (std::size_t i = 0; i < 2; ++i) EXPECT_LE(standing.positions[joints[i]].width(), 1.1 * hull[i].width());
}

/// From random postures within reach.
void expect_no_equilibrium_on_all(const Model& model, std::span<const double> parameters) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> tilt(-equilibrium_reach_of_tilt, equilibrium_reach_of_tilt);
  const Energy energy(model, parameters, Joints::stiff, Ground::lets_go);
  for (int start = 0; start < 4; ++start) {
    Positions q = of_file(model);
    q[rz] = tilt(random);
    q[rx] = tilt(random);
    q[ty] += 0.1 * tilt(random);
    q = energy.stationary(q);
    const bool balanced = std::ranges::all_of(
        std::array{ty, rz, rx}, [&](std::size_t joint) { return std::abs(energy.slope(q, joint)) < 1e-6L; });
    const std::vector<Real> depths = energy.penetrations(q);
    EXPECT_FALSE(balanced && std::abs(q[rz]) < equilibrium_reach_of_tilt &&
                 std::ranges::all_of(depths, [](Real depth) { return depth > 0; }));
  }
}

TEST(StandingEquilibrium, TellsWhereTheBodyDoesNotStandOnAllCylinders) {
  Model model = standing_model();
  model = narrowed(model, indices(model, {"mp"})[0], {62.0, 65.0});
  model = narrowed(model, indices(model, {"px"})[0], {0.05, 0.055});
  model = narrowed(model, indices(model, {"py"})[0], {0.45, 0.5});
  const std::vector<std::uint32_t> uncertain = indices(model, {"mp", "px", "py"});
  const Equilibrium found = equilibrium(model, uncertain, {.cells = 4});
  EXPECT_EQ(found.stands + found.not_on_all + found.open, 1.0);
  EXPECT_GT(found.stands, 0.0);
  EXPECT_GT(found.not_on_all, 0.0);
  for (const EquilibriumCell& cell : found.cells) {
    if (cell.verdict == StandingVerdict::open) continue;
    std::vector<double> parameters = nominal(model);
    for (std::size_t k = 0; k < uncertain.size(); ++k) parameters[uncertain[k]] = middle(cell.ranges[k]);
    const Energy energy(model, parameters, Joints::stiff);
    const std::vector<Real> depths = energy.penetrations(energy.stationary(of_file(model)));
    const bool all = std::ranges::all_of(depths, [](Real depth) { return depth > 0; });
    EXPECT_EQ(all, cell.verdict == StandingVerdict::stands);
    if (cell.verdict == StandingVerdict::not_on_all) expect_no_equilibrium_on_all(model, parameters);
  }
}

TEST(StandingEquilibrium, OfProportionalJointsLeavesNoForce) {
  const Model model = standing_model();
  const std::vector<double> parameters = nominal(model);
  const Standing standing = equilibrium(model, {}, {.control = JointControl::proportional}).standing.value();
  Positions q;
  for (const Enclosure& position : standing.positions) {
    EXPECT_LE(position.width(), 1e-9);
    q.push_back(middle(position));
  }
  const Energy energy(model, parameters, Joints::springs);
  for (std::size_t joint = 0; joint < q.size(); ++joint)
    EXPECT_NEAR(static_cast<double>(energy.slope(q, joint)), 0.0, 1e-7) << joint;
  EXPECT_GT(std::abs(q[15]), 0.05L);  // the toes give way
}

TEST(StandingEquilibrium, KnowsTheOtherExponentAndTheAppliedForce) {
  Model model = standing_model();
  for (ContactCylinder& cylinder : model.cylinders) cylinder.exponent = 1.5;
  model.applied.force[1].nominal = -120.0;
  model.applied.force[1].range = {-120.0, -120.0};
  for (ContactCylinder& cylinder : model.cylinders) cylinder.stiffness = {2e6, {2e6, 2e6}, {}};
  model.bodies.front().joints[ty].position = 0.974;
  const std::vector<double> parameters = nominal(model);
  const Equilibrium found = equilibrium(model, {}, {});
  ASSERT_EQ(found.stands, 1.0);
  Positions q = of_file(model);
  for (const std::size_t joint : {ty, rz, rx}) q[joint] = middle(found.standing->positions[joint]);
  for (const std::size_t joint : {ty, rz, rx})
    EXPECT_NEAR(static_cast<double>(Energy(model, parameters, Joints::stiff).slope(q, joint)), 0.0, 1e-5) << joint;
}

TEST(StandingEquilibrium, LeansWhereTheBodyIsLopsided) {
  Model model = standing_model();
  model = narrowed(model, indices(model, {"pz"})[0], {0.02, 0.02});
  const std::vector<double> parameters = nominal(model);
  const Standing standing = equilibrium(model, {}, {}).standing.value();
  const Positions q = Energy(model, parameters, Joints::stiff).stationary(of_file(model));
  for (const std::size_t joint : {ty, rz, rx}) expect_holds(standing.positions[joint], q[joint], std::to_string(joint));
  EXPECT_GT(std::abs(q[rx]), 1e-3L);
}

TEST(StandingEquilibrium, RefusesWhatCannotStand) {
  const auto refusal = [](const Model& model) -> std::string {
    try {
      (void)equilibrium(model, {}, {});
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  Model model = standing_model();
  model.applied.force[0].nominal = 1.0;
  EXPECT_EQ(refusal(model),
            "equilibrium: the applied force has a part along x, which friction alone could hold: it must be 0");
  model = standing_model();
  model.cylinders.clear();
  EXPECT_EQ(refusal(model), "equilibrium: the model has no cylinder to stand on");
  model = standing_model();
  model.bodies.front().joints.pop_back();
  model.bodies.front().joints.pop_back();
  EXPECT_EQ(refusal(model),
            "equilibrium: the root needs one translation along y and one rotation about each of x and z");
}

TEST(StandingEquilibrium, EndsWhenInterrupted) {
  const Model model = standing_model();
  const Equilibrium found =
      equilibrium(model, indices(model, {"mp", "px", "py"}), {.cells = 64, .interrupted = [] { return true; }});
  EXPECT_TRUE(found.interrupted);
  EXPECT_EQ(found.stands + found.not_on_all + found.open, 1.0);
  EXPECT_GT(found.open, 0.0);
}

}  // namespace
}  // namespace verisq::stance
