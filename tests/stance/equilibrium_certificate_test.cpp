/// Certificates of equilibria prove what is found, hold an independent formulation's samples, and never prove a
/// forgery. VERISQ_FORGED_EQUILIBRIA says how many bodies are tried.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>
#include <verisq/error.hpp>

#include "tests/fixtures/forged_numbers.hpp"
#include "tests/fixtures/forgeries.hpp"
#include "tests/fixtures/requested_count.hpp"
#include "tests/oracle/random_cases.hpp"
#include "tests/oracle/standing_energy.hpp"
#include "verify/proof/body_at_rest.hpp"
#include "verify/proof/equilibrium_checker.hpp"
#include "verisq/stance_equilibrium.hpp"

namespace verisq::stance {
namespace {

using namespace oracle;
using verify::Differentiated;
using verify::PreciseInterval;

/// What is found of a body, with what proves it.
struct Case {
  Model model;
  CertifiedEquilibrium certified;
  Equilibrium found;

  Case(Model of, const std::vector<std::uint32_t>& uncertain, const EquilibriumOptions& options = {})
      : model(std::move(of)), certified(), found(equilibrium(model, uncertain, options)) {
    certified = certified_equilibrium(model, uncertain, options.control, found, {});
  }

  [[nodiscard]] std::vector<Finding> findings() const { return findings_of(certified.claims, certified.certificate); }
  [[nodiscard]] std::vector<Finding> findings_of(const EquilibriumClaims& claims,
                                                 const EquilibriumCertificate& certificate) const {
    return check(claims, prove(model, claims, certificate, {}));
  }
};

std::ptrdiff_t proved(const std::vector<Finding>& findings) {
  return std::ranges::count(findings, Verdict::proved, &Finding::verdict);
}

/// By 1e-12 of it.
double above(double x) {
  return verisq::oracle::moved(x, infinity);
}

/// As numbers_of has them.
void replace_number(Standing& standing, std::size_t k, const Enclosure& number) {
  std::vector<Enclosure*> all;
  for (Enclosure& position : standing.positions) all.push_back(&position);
  for (Enclosure& torque : standing.torques) all.push_back(&torque);
  for (CylinderLoad& load : standing.loads) all.insert(all.end(), {&load.force, &load.penetration});
  all.insert(all.end(), {&standing.centre_of_pressure_x, &standing.centre_of_pressure_z, &standing.least_penetration});
  *all[k] = number;
}

bool meet(const Enclosure& a, const Enclosure& b) {
  return a.lo <= b.hi && b.lo <= a.hi;
}

/// What is claimed of the same numbers has something in common, and is wider by no more than `share` of the widest of
/// the kind that was found, and than roundings.
void expect_like_what_was_found(const Case& found, double share) {
  const Standing& standing = found.found.standing.value();
  const std::vector<Enclosure> numbers = numbers_of(standing);
  const std::vector<Enclosure> claimed = numbers_of(found.certified.claims.standing.value());
  ASSERT_EQ(numbers.size(), claimed.size());
  const std::size_t joints = standing.positions.size();
  const std::size_t loads = standing.loads.size();
  const auto expect_kind = [&](std::size_t first, std::size_t count, std::size_t step) {
    double widest = 0.0;
    for (std::size_t k = 0; k < count; ++k) widest = std::fmax(widest, numbers[first + k * step].width());
    for (std::size_t i = first; i < first + count * step; i += step) {
      EXPECT_TRUE(meet(numbers[i], claimed[i])) << i;
      EXPECT_LE(claimed[i].width(), numbers[i].width() + share * widest + 1e-9) << i;
    }
  };
  expect_kind(0, joints, 1);                    // positions
  expect_kind(joints, joints, 1);               // torques
  expect_kind(2 * joints, loads, 2);            // forces
  expect_kind(2 * joints + 1, loads, 2);        // penetrations
  expect_kind(2 * (joints + loads), 2, 1);      // the centre of pressure
  expect_kind(2 * (joints + loads) + 2, 1, 1);  // the least penetration
}

TEST(EquilibriumCertificateTest, ProvesWhatIsFound) {
  const Case nominal_body(standing_model(), {});
  EXPECT_EQ(nominal_body.certified.claims.stands, 1.0);
  EXPECT_EQ(proved(nominal_body.findings()), std::ssize(nominal_body.findings()));
  expect_like_what_was_found(nominal_body, 0.0);

  const Model model = within_one_per_cent(standing_model());
  const Case box(model, indices(model, {"mp", "px", "py", "k"}));
  EXPECT_EQ(box.certified.claims.stands, 1.0);
  EXPECT_EQ(proved(box.findings()), std::ssize(box.findings()));
  expect_like_what_was_found(box, 0.06);
}

TEST(EquilibriumCertificateTest, ProvesProportionalJointsAndTheOtherExponent) {
  const Case proportional(standing_model(), {}, {.control = JointControl::proportional});
  EXPECT_EQ(proportional.certified.claims.stands, 1.0);
  EXPECT_EQ(proved(proportional.findings()), std::ssize(proportional.findings()));
  expect_like_what_was_found(proportional, 0.0);

  Model model = standing_model();
  for (ContactCylinder& cylinder : model.cylinders) {
    cylinder.exponent = 1.5;
    cylinder.stiffness = {2e6, {2e6, 2e6}, {}};
  }
  model.applied.force[1] = {-120.0, {-120.0, -120.0}, {}};
  model.bodies.front().joints[ty].position = 0.974;
  const Case other(model, indices(model, {"mp"}));
  EXPECT_GT(other.certified.claims.stands, 0.5);
  EXPECT_EQ(proved(other.findings()), std::ssize(other.findings()));
}

TEST(EquilibriumCertificateTest, HoldsSamplesOfLeastEnergy) {
  Model model = standing_model();
  const std::vector<std::uint32_t> uncertain = indices(model, {"mp", "px", "pz"});
  model = narrowed(model, uncertain[0], {45.0, 55.0});
  model = narrowed(model, uncertain[1], {0.07, 0.08});
  model = narrowed(model, uncertain[2], {-0.005, 0.01});
  const Case box(model, uncertain);
  ASSERT_EQ(box.certified.claims.stands, 1.0);
  const Standing& standing = box.certified.claims.standing.value();
  std::mt19937_64 random(3);
  for (int sample = 0; sample < 24; ++sample) {
    std::vector<double> parameters = nominal(model);
    for (std::size_t k = 0; k < uncertain.size(); ++k) {
      const Enclosure& range = box.certified.claims.ranges[k];
      const double share = sample < 8 ? (sample >> k) & 1 : std::uniform_real_distribution<double>(0, 1)(random);
      parameters[uncertain[k]] = range.lo + share * (range.hi - range.lo);
    }
    const Energy energy(model, parameters, Joints::stiff);
    const Positions q = energy.stationary(of_file(model));
    constexpr double of_differences = 1e-9;
    const auto expect_holds = [&](const Enclosure& claim, long double number, const char* what) {
      EXPECT_GE(static_cast<double>(number), claim.lo - of_differences) << what;
      EXPECT_LE(static_cast<double>(number), claim.hi + of_differences) << what;
    };
    for (const std::size_t joint : {ty, rz, rx}) expect_holds(standing.positions[joint], q[joint], "position");
    const std::vector<long double> depths = energy.penetrations(q);
    for (std::size_t i = 0; i < depths.size(); ++i)
      expect_holds(standing.loads[i / 2].penetration, depths[i], "penetration");
    expect_holds(standing.least_penetration, *std::ranges::min_element(depths), "least penetration");
    for (std::size_t c = 0; c < model.cylinders.size(); ++c) {
      const long double half = 0.5L * value(model.cylinders[c].stiffness, parameters);
      const long double force = half * (depths[2 * c] + depths[2 * c + 1]);  // of these, of exponent 1
      EXPECT_GE(static_cast<double>(force), standing.loads[c].force.lo - 1e-6);
      EXPECT_LE(static_cast<double>(force), standing.loads[c].force.hi + 1e-6);
    }
    // What holds a joint is the slope of the energy, of which a difference is known to its own error.
    for (std::size_t joint = 6; joint < model.degrees_of_freedom(); ++joint) {
      const double slope = static_cast<double>(energy.slope(q, joint));
      EXPECT_GE(slope, standing.torques[joint].lo - 1e-6) << joint;
      EXPECT_LE(slope, standing.torques[joint].hi + 1e-6) << joint;
    }
  }
}

/// The balance in any posture is the slope of the potential energy.
TEST(EquilibriumCertificateTest, BalanceIsTheSlopeOfTheEnergy) {
  verisq::oracle::RandomCases random(4);
  for (int i = 0; i < 20; ++i) {
    Model model = standing_model();
    if (i % 2 == 1) {
      for (ContactCylinder& cylinder : model.cylinders) cylinder.exponent = 1.5;
    }
    model.applied.force[1] = {random.uniform(-200.0, 200.0), {0.0, 0.0}, {}};
    const std::vector<double> parameters = nominal(model);
    Positions q = of_file(model);
    for (std::size_t joint = 0; joint < q.size(); ++joint) {
      if (joint != 0 && joint != 2) q[joint] += random.uniform(-0.03, 0.03);
    }
    verify::Posture<PreciseInterval> posture{PreciseInterval(0), {}};
    for (const long double position : q) posture.joints.emplace_back(verify::Real(position));
    std::vector<PreciseInterval> precise;
    precise.reserve(parameters.size());
    for (const double parameter : parameters) precise.emplace_back(verify::Real(parameter));
    const Point reference{0.02, -0.97, 0.01};
    // The root's height and the reference point's differ by what does not depend on the height.
    const auto at_zero = body_at_rest(model, precise, posture, reference);
    posture.height = PreciseInterval(verify::Real(q[ty])) - at_zero.height_of_root;
    const auto at_rest = body_at_rest(model, precise, posture, reference);
    const Energy energy(model, parameters, Joints::stiff);
    const auto middle = [](const PreciseInterval& a) {
      EXPECT_LT((a.upper().to_double(verify::Direction::up) - a.lower().to_double(verify::Direction::down)), 1e-9);
      return a.lower().to_double(verify::Direction::down);
    };
    EXPECT_NEAR(middle(at_rest.force), -static_cast<double>(energy.slope(q, ty)), 1e-5) << i;
    // The root turns about its own origin, about z and then about x; its moments are about the reference point.
    const Vector to_reference =
        turn(2, q[rz]) * turn(0, q[rx]) * turn(1, q[5]) * Vector(reference[0], reference[1], reference[2]);
    const double about_z = middle(at_rest.moment_z) + middle(at_rest.force) * static_cast<double>(to_reference[0]);
    const double about_x = middle(at_rest.moment_x) + middle(at_rest.force) * static_cast<double>(to_reference[2]);
    EXPECT_NEAR(about_z, -static_cast<double>(energy.slope(q, rz)), 1e-5) << i;
    EXPECT_NEAR(about_x * std::cos(static_cast<double>(q[rz])), static_cast<double>(energy.slope(q, rx)), 1e-5) << i;
    const std::vector<long double> depths = energy.penetrations(q);
    for (std::size_t k = 0; k < depths.size(); ++k)
      EXPECT_NEAR(middle(at_rest.penetrations[k]), static_cast<double>(depths[k]), 1e-12) << i;
    for (std::size_t joint = 6; joint < q.size(); ++joint)
      EXPECT_NEAR(middle(at_rest.torques[joint]), static_cast<double>(energy.slope(q, joint)), 1e-5) << i;
  }
}

/// Where nothing is uncertain in one parameter, or a range has no numbers between its ends, there are no halves:
/// counted twice, a part of the box would be all of it.
TEST(EquilibriumCertificateTest, PartsAreNeverCountedTwice) {
  Model model = standing_model();
  const std::vector<std::uint32_t> uncertain = indices(model, {"mp", "px"});
  model.parameters[uncertain[0]].range = {50.0, 50.0};
  model.parameters[uncertain[1]].range = {0.02, 0.18};
  const Case honest(model, uncertain, {.cells = 4});
  ASSERT_GT(honest.found.stands, 0.1);
  ASSERT_LT(honest.found.stands, 0.9);
  EXPECT_LE(honest.certified.claims.stands, honest.found.stands + 1e-9);
  EXPECT_EQ(proved(honest.findings()), std::ssize(honest.findings()));
  for (const double end : {50.0, std::nextafter(50.0, 51.0)}) {
    EquilibriumClaims claims = honest.certified.claims;
    claims.ranges[0].hi = end;
    claims.stands = 0.999;
    EquilibriumCertificate certificate = honest.certified.certificate;
    const std::vector<EquilibriumPart> once = certificate.parts;
    for (int i = 0; i < 2; ++i) {
      std::vector<EquilibriumPart> twice{{0, {}}};
      for (int half = 0; half < 2; ++half)
        twice.insert(twice.end(), certificate.parts.begin(), certificate.parts.end());
      certificate.parts = std::move(twice);
    }
    EXPECT_NE(honest.findings_of(claims, certificate).front().verdict, Verdict::proved);
    EXPECT_EQ(prove(model, claims, certificate, {}).stands, 0.0);
  }
}

TEST(EquilibriumCertificateTest, DerivativesAreThoseOfDifferences) {
  const auto f = [](const auto& x, const auto& y) {
    return sin(x * y) / (cos(y) + square(x)) - sqrt(x) * power_of_three_halves(y - x) + x;
  };
  const Differentiated x = Differentiated::variable(PreciseInterval(verify::Real(0.7)), 0, 2);
  const Differentiated y = Differentiated::variable(PreciseInterval(verify::Real(0.4)), 1, 2);
  const Differentiated at = f(x, y);
  const verify::Real step(0x1p-40);
  const auto moved = [&](const verify::Real& a, const verify::Real& b) {
    return f(PreciseInterval(a), PreciseInterval(b)).lower().to_long_double();
  };
  const auto plus = [&](double number, int sign) {
    return add(verify::Real(number), sign > 0 ? step : -step, verify::Direction::up);
  };
  const long double by_x =
      (moved(plus(0.7, 1), verify::Real(0.4)) - moved(plus(0.7, -1), verify::Real(0.4))) / 0x1p-39L;
  const long double by_y =
      (moved(verify::Real(0.7), plus(0.4, 1)) - moved(verify::Real(0.7), plus(0.4, -1))) / 0x1p-39L;
  EXPECT_NEAR(static_cast<double>(at.by[0].lower().to_long_double() - by_x), 0.0, 1e-6);
  EXPECT_NEAR(static_cast<double>(at.by[1].lower().to_long_double() - by_y), 0.0, 1e-6);
}

/// Of a body about as that of the example, with ranges of 1 % where they are not points.
Case random_case(verisq::oracle::RandomCases& random, bool of_points) {
  Model model = standing_model();
  for (Parameter& parameter : model.parameters) {
    const double at = random.uniform(0.45, 0.55) * (parameter.range.lo + parameter.range.hi);
    const double size = of_points ? 0.0 : 0.005 * std::abs(at);
    parameter.nominal = at;
    parameter.range = {at - size, at + size};
  }
  return {model, indices(model, {"mp", "px", "py"}), {.cells = 2}};
}

class ForgedCase {
 public:
  ForgedCase(const Case& honest, verisq::oracle::Forgeries& forgeries)
      : honest_(honest),
        forgeries_(forgeries),
        claims_(honest.certified.claims),
        certificate_(honest.certified.certificate),
        proven_(prove(honest.model, claims_, certificate_, {})),
        numbers_(numbers_of(claims_.standing.value())) {}

  /// Beyond what a value is known to reach, and short of what is proven.
  void forge_ends() {
    const std::vector<Enclosure> some = numbers_of(proven_.of_some.value());
    for (std::size_t k = 0; k < numbers_.size(); ++k) {
      const auto& [lo, hi] = numbers_[k];
      for (const Enclosure& forged : {Enclosure{above(some[k].hi), infinity}, Enclosure{-infinity, -above(-some[k].lo)},
                                      Enclosure{above(lo), hi}, Enclosure{lo, -above(-hi)}}) {
        EquilibriumClaims other = claims_;
        replace_number(*other.standing, k, forged);
        expect(check(other, proven_), k + 1, "an end");
      }
    }
    EquilibriumClaims more = claims_;
    more.stands = std::nextafter(1.0, 2.0);
    expect(check(more, proven_), 0, "more than all of the box");
  }

  void forge_subjects() {
    for (std::size_t k = 0; k < claims_.uncertain.size(); ++k) {
      EquilibriumClaims other = claims_;
      const Enclosure range = claims_.ranges[k];
      other.ranges[k] = {2.0 * range.lo, range.hi + range.lo};
      expect_unproved(other, certificate_, "other parameters");
    }
    EquilibriumClaims turning = claims_;
    turning.control = JointControl::proportional;
    expect_unproved(turning, certificate_, "other joints");
  }

  void forge_parts() {
    for (std::size_t p = 0; p < certificate_.parts.size(); ++p) {
      if (!certificate_.parts[p].postures.empty()) forge_part(p);
    }
    EquilibriumCertificate shorter = certificate_;
    shorter.parts.pop_back();
    expect(honest_.findings_of(claims_, shorter), 0, "parts cut short");
  }

 private:
  void forge_part(std::size_t p) {
    for (std::size_t u = 0; u < certificate_.parts[p].postures.size(); ++u) {
      EquilibriumCertificate other = certificate_;
      Enclosure& side = other.parts[p].postures[u];
      side.hi = side.lo;
      expect_unproved(claims_, other, "a posture that is a point");
      side = certificate_.parts[p].postures[u];
      const double away = 2.0 * side.width() + 1e-3;
      side = {side.lo + away, side.hi + away};
      expect_unproved(claims_, other, "another posture");
    }
    EquilibriumCertificate silent = certificate_;
    silent.parts[p].postures.clear();
    expect(honest_.findings_of(claims_, silent), 0, "a part of which nothing is said");
  }

  void expect(const std::vector<Finding>& findings, std::size_t which, const char* what) {
    forgeries_.expect_not_proved(findings[which], findings[which].proven, what);
  }
  void expect_unproved(const EquilibriumClaims& claims, const EquilibriumCertificate& by, const char* what) {
    const std::vector<Finding> findings = honest_.findings_of(claims, by);
    for (std::size_t k = 0; k < findings.size(); ++k) {
      // What the file says of joints that are held, and of the root's, holds of all equilibria.
      if (k == 0 || numbers_[k - 1].width() > 0.0) expect(findings, k, what);
    }
  }

  const Case& honest_;
  verisq::oracle::Forgeries& forgeries_;
  const EquilibriumClaims& claims_;
  const EquilibriumCertificate& certificate_;
  ProvenEquilibrium proven_;
  std::vector<Enclosure> numbers_;
};

TEST(EquilibriumCertificateTest, NeverProvesAForgery) {
  verisq::oracle::RandomCases random(5);
  verisq::oracle::Forgeries forgeries;
  for (std::size_t i = 0; i < verisq::oracle::requested_count("VERISQ_FORGED_EQUILIBRIA", 3); ++i) {
    const Case honest = random_case(random, i % 3 == 0);
    if (!honest.certified.claims.standing) continue;
    ASSERT_EQ(proved(honest.findings()), std::ssize(honest.findings())) << i;
    ForgedCase forged(honest, forgeries);
    forged.forge_ends();
    forged.forge_subjects();
    forged.forge_parts();
  }
  EXPECT_GT(forgeries.told(), 500U);
}

}  // namespace
}  // namespace verisq::stance
