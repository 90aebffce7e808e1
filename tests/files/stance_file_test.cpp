/// The stance model format: what it accepts, and the message, with its line, for everything it refuses.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <verisq/stance.hpp>

#include "tests/fixtures/error_matchers.hpp"
#include "tests/fixtures/places.hpp"
#include "tests/fixtures/stance_example.hpp"
#include "tests/fixtures/temporary_folder.hpp"

namespace verisq::stance {
namespace {

using testing::expect_input_error;
using testing::TemporaryFolder;

/// A model of two bodies; the tests count on its lines.
constexpr std::string_view two_bodies = R"(<stance gravity="9.81">
  <applied_force>
    <frequency value="1"/>
    <force x="3" y="0"><z parameter="Fz" unit="N" nominal="2" deviation="0.5"/></force>
  </applied_force>
  <body name="trunk">
    <translation name="height" axis="y" position="1" velocity="-2"/>
    <mass parameter="m" unit="kg" lower="30" upper="50" description="mass"/>
    <centre_of_mass x="0" y="0.25" z="0"/>
    <inertia x="1" y="2" z="3"/>
  </body>
  <body name="foot" parent="trunk">
    <offset x="0" y="-0.9" z="0"/>
    <rotation name="ankle" axis="z"><pid proportional="4" integral="5" derivative="6"/></rotation>
    <mass value="1.5"/>
    <centre_of_mass x="0.1" y="0" z="0"/>
    <inertia x="0" y="0" z="0.25"/>
  </body>
  <cylinder name="sole" body="foot" half_length="0.125" stiffness="1e5" exponent="1.5" impact_velocity="0.5"
            stribeck_velocity="0.25" bristle_stiffness="2e5" bristle_damping="300">
    <centre x="0" y="-0.1" z="0"/>
    <axis x="0" y="0.6" z="0.8"/>
    <radius parameter="r" lower="0.25" nominal="0.25" upper="0.5"/>
    <normal_restitution parameter="e" lower="0.25" upper="0.5"/>
    <tangential_restitution parameter="e"/>
    <static_friction value="0.5"/>
    <dynamic_friction value="0.75"/>
  </cylinder>
</stance>
)";

/// With `from`, which must be there once, replaced.
std::string changed(std::string_view from, std::string_view to) {
  std::string xml(two_bodies);
  const std::size_t at = xml.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  EXPECT_EQ(xml.find(from, at + 1), std::string::npos) << from << " is there twice";
  return xml.replace(at, from.size(), to);
}

void expect_refused(const std::string& xml, const std::string& message) {
  expect_input_error([&] { (void)parse_model(xml, "m.xml"); }, "m.xml", ": " + message);
}

/// Replaces `from` by `to`; the message starts at the line.
void expect_refused(std::string_view from, std::string_view to, const std::string& message) {
  expect_refused(changed(from, to), message);
}

/// The quantity that the mass of the trunk becomes with these attributes.
Quantity mass_of(const std::string& attributes) {
  return parse_model(changed(R"(parameter="m" unit="kg" lower="30" upper="50" description="mass")", attributes),
                     "m.xml")
      .bodies[0]
      .mass;
}

void expect_mass_refused(const std::string& attributes, const std::string& message) {
  expect_refused(R"(parameter="m" unit="kg" lower="30" upper="50" description="mass")", attributes,
                 "line 8: <mass>: " + message);
}

/// Indices of parameters depend on the order in which a model names them: only their names matter.
void expect_equal(const Quantity& a, const Model& model_a, const Quantity& b, const Model& model_b) {
  EXPECT_EQ(a.nominal, b.nominal);
  EXPECT_EQ(a.range, b.range);
  ASSERT_EQ(a.parameter.has_value(), b.parameter.has_value());
  if (!a.parameter) return;
  EXPECT_EQ(model_a.parameters[*a.parameter].name, model_b.parameters[*b.parameter].name);
}

void expect_equal(const QuantityVector& a, const Model& model_a, const QuantityVector& b, const Model& model_b) {
  for (std::size_t k = 0; k < 3; ++k) expect_equal(a[k], model_a, b[k], model_b);
}

void expect_equal(const Joint& a, const Joint& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.axis, b.axis);
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.velocity, b.velocity);
}

void expect_equal(const Body& a, const Model& model_a, const Body& b, const Model& model_b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.parent, b.parent);
  expect_equal(a.offset, model_a, b.offset, model_b);
  ASSERT_EQ(a.joints.size(), b.joints.size());
  for (std::size_t k = 0; k < a.joints.size(); ++k) expect_equal(a.joints[k], b.joints[k]);
  expect_equal(a.mass, model_a, b.mass, model_b);
  expect_equal(a.centre_of_mass, model_a, b.centre_of_mass, model_b);
  expect_equal(a.inertia, model_a, b.inertia, model_b);
}

void expect_equal(const ContactCylinder& a, const Model& model_a, const ContactCylinder& b, const Model& model_b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.body, b.body);
  expect_equal(a.centre, model_a, b.centre, model_b);
  EXPECT_EQ(a.axis, b.axis);
  expect_equal(a.radius, model_a, b.radius, model_b);
  EXPECT_EQ(a.half_length, b.half_length);
  expect_equal(a.stiffness, model_a, b.stiffness, model_b);
  EXPECT_EQ(a.exponent, b.exponent);
  expect_equal(a.impact_velocity, model_a, b.impact_velocity, model_b);
  expect_equal(a.normal_restitution, model_a, b.normal_restitution, model_b);
  expect_equal(a.tangential_restitution, model_a, b.tangential_restitution, model_b);
  expect_equal(a.static_friction, model_a, b.static_friction, model_b);
  expect_equal(a.dynamic_friction, model_a, b.dynamic_friction, model_b);
  EXPECT_EQ(a.stribeck_velocity, b.stribeck_velocity);
  EXPECT_EQ(a.bristle_stiffness, b.bristle_stiffness);
  EXPECT_EQ(a.bristle_damping, b.bristle_damping);
}

TEST(StanceFile, TheExampleIsTheModelOfThePaper) {
  const Model read = read_model(places::example("stance.xml"));
  const Model built = nine_segments();
  EXPECT_EQ(read.gravity, built.gravity);
  EXPECT_EQ(read.degrees_of_freedom(), 26U);
  ASSERT_EQ(read.bodies.size(), built.bodies.size());
  for (std::size_t k = 0; k < read.bodies.size(); ++k) expect_equal(read.bodies[k], read, built.bodies[k], built);
  ASSERT_EQ(read.cylinders.size(), built.cylinders.size());
  for (std::size_t k = 0; k < read.cylinders.size(); ++k) {
    expect_equal(read.cylinders[k], read, built.cylinders[k], built);
  }
  ASSERT_EQ(read.controllers.size(), 20U);
  for (std::size_t k = 0; k < read.controllers.size(); ++k) {
    const auto& [body, joint, proportional, integral, derivative] = read.controllers[k];
    EXPECT_EQ(body, built.controllers[k].body);
    EXPECT_EQ(joint, built.controllers[k].joint);
    EXPECT_EQ(proportional, built.controllers[k].proportional);
    EXPECT_EQ(integral, built.controllers[k].integral);
    EXPECT_EQ(derivative, built.controllers[k].derivative);
  }
  expect_equal(read.applied.force, read, built.applied.force, built);
  expect_equal(read.applied.frequency, read, built.applied.frequency, built);
}

TEST(StanceFile, TheExampleHasTheParametersOfTableOne) {
  const Model read = read_model(places::example("stance.xml"));
  const Model built = nine_segments();
  ASSERT_EQ(read.parameters.size(), built.parameters.size());
  for (const Parameter& expected : built.parameters) {
    const auto found = std::ranges::find(read.parameters, expected.name, &Parameter::name);
    ASSERT_NE(found, read.parameters.end()) << expected.name;
    EXPECT_EQ(found->unit, expected.unit);
    EXPECT_EQ(found->description, expected.description);
    EXPECT_EQ(found->nominal, expected.nominal) << expected.name;
    EXPECT_EQ(found->range, expected.range) << expected.name;
  }
}

TEST(StanceFile, ReadsEveryField) {
  const Model model = parse_model(two_bodies, "m.xml");
  EXPECT_EQ(model.gravity, 9.81);
  EXPECT_EQ(model.applied.frequency.nominal, 1.0);
  EXPECT_EQ(model.applied.force[0].nominal, 3.0);
  EXPECT_EQ(model.applied.force[2].range, (Enclosure{1.5, 2.5}));
  ASSERT_EQ(model.bodies.size(), 2U);
  const auto& [trunk, foot] = std::tie(model.bodies[0], model.bodies[1]);
  EXPECT_EQ(trunk.name, "trunk");
  EXPECT_FALSE(trunk.parent);
  EXPECT_EQ(trunk.offset[0].nominal, 0.0);
  expect_equal(trunk.joints.at(0), {"height", JointKind::translation, 1, 1.0, -2.0});
  EXPECT_EQ(foot.parent, 0U);
  EXPECT_EQ(foot.offset[1].nominal, -0.9);
  expect_equal(foot.joints.at(0), {"ankle", JointKind::rotation, 2, 0.0, 0.0});
  EXPECT_EQ(foot.mass.nominal, 1.5);
  EXPECT_EQ(foot.centre_of_mass[0].nominal, 0.1);
  EXPECT_EQ(foot.inertia[2].nominal, 0.25);
  ASSERT_EQ(model.controllers.size(), 1U);
  EXPECT_EQ(model.controllers[0].body, 1U);
  EXPECT_EQ(model.controllers[0].joint, 0U);
  EXPECT_EQ(model.controllers[0].proportional, 4.0);
  EXPECT_EQ(model.controllers[0].integral, 5.0);
  EXPECT_EQ(model.controllers[0].derivative, 6.0);
  ASSERT_EQ(model.cylinders.size(), 1U);
  const ContactCylinder& sole = model.cylinders[0];
  EXPECT_EQ(sole.name, "sole");
  EXPECT_EQ(sole.body, 1U);
  EXPECT_EQ(sole.centre[1].nominal, -0.1);
  EXPECT_EQ(sole.axis, (std::array{0.0, 0.6, 0.8}));
  EXPECT_EQ(sole.half_length, 0.125);
  EXPECT_EQ(sole.stiffness.nominal, 1e5);
  EXPECT_EQ(sole.exponent, 1.5);
  EXPECT_EQ(sole.impact_velocity.nominal, 0.5);
  EXPECT_EQ(sole.impact_velocity.range, (Enclosure{0.5, 0.5}));
  EXPECT_EQ(sole.stribeck_velocity, 0.25);
  EXPECT_EQ(sole.bristle_stiffness, 2e5);
  EXPECT_EQ(sole.bristle_damping, 300.0);
  EXPECT_EQ(sole.static_friction.nominal, 0.5);
  EXPECT_EQ(sole.dynamic_friction.nominal, 0.75);
}

TEST(StanceFile, NamesParametersInTheOrderOfTheFile) {
  const Model model = parse_model(two_bodies, "m.xml");
  ASSERT_EQ(model.parameters.size(), 4U);
  EXPECT_EQ(model.parameters[0].name, "Fz");
  EXPECT_EQ(model.parameters[0].unit, "N");
  EXPECT_EQ(model.parameters[0].description, "");
  EXPECT_EQ(model.parameters[1].name, "m");
  EXPECT_EQ(model.parameters[1].description, "mass");
  EXPECT_EQ(model.parameters[1].nominal, 40.0);
  EXPECT_EQ(model.parameters[1].range, (Enclosure{30.0, 50.0}));
  EXPECT_EQ(model.parameters[2].nominal, 0.25);
  EXPECT_EQ(model.bodies[0].mass.parameter, 1U);
}

TEST(StanceFile, SharesAParameterThatIsNamedAgain) {
  const ContactCylinder sole = parse_model(two_bodies, "m.xml").cylinders[0];
  EXPECT_EQ(sole.tangential_restitution.parameter, 3U);
  EXPECT_EQ(sole.tangential_restitution.parameter, sole.normal_restitution.parameter);
  EXPECT_EQ(sole.tangential_restitution.nominal, 0.375);
  EXPECT_EQ(sole.tangential_restitution.range, (Enclosure{0.25, 0.5}));
}

TEST(StanceFile, AQuantityHasAnyOfThreeForms) {
  EXPECT_EQ(mass_of(R"(value="3")").range, (Enclosure{3.0, 3.0}));
  EXPECT_FALSE(mass_of(R"(value="3")").parameter);
  EXPECT_TRUE(mass_of(R"(value="3" parameter="m")").parameter);
  EXPECT_EQ(mass_of(R"(parameter="m" lower="1" upper="4")").nominal, 2.5);
  EXPECT_EQ(mass_of(R"(parameter="m" lower="1" upper="4" nominal="1.5")").nominal, 1.5);
  EXPECT_EQ(mass_of(R"(parameter="m" nominal="3" deviation="2")").range, (Enclosure{1.0, 5.0}));
  EXPECT_EQ(mass_of(R"(nominal="3" deviation="0")").range, (Enclosure{3.0, 3.0}));
}

TEST(StanceFile, DeviationsAreRoundedOutward) {
  // The exact difference and sum of the binary64 numbers next to 0.3 and 1e-20 are no binary64 numbers.
  const Quantity mass = mass_of(R"(parameter="m" nominal="0.3" deviation="1e-20")");
  EXPECT_EQ(mass.range.lo, std::nextafter(0.3, 0.0));
  EXPECT_EQ(mass.range.hi, std::nextafter(0.3, 1.0));
}

TEST(StanceFile, RefusesNumbersThatMakeNoQuantity) {
  expect_mass_refused("", "no number: give value, lower and upper, or nominal and deviation");
  expect_mass_refused(R"(value="3" lower="1")", "lower = '1': give value alone, or a range");
  expect_mass_refused(R"(lower="1")", "attribute upper is missing");
  expect_mass_refused(R"(upper="1")", "attribute lower is missing");
  expect_mass_refused(R"(nominal="1")", "attribute deviation is missing");
  expect_mass_refused(R"(deviation="1")", "attribute nominal is missing");
  expect_mass_refused(R"(lower="1" upper="2" deviation="1")",
                      "deviation = '1': give lower and upper, or nominal and deviation");
  expect_mass_refused(R"(parameter="m" lower="2" upper="1")", "lower = 2 exceeds upper = 1");
  expect_mass_refused(R"(parameter="m" lower="1" upper="2" nominal="2.5")",
                      "nominal = '2.5': is not between lower and upper");
  expect_mass_refused(R"(parameter="m" nominal="2" deviation="-1")", "deviation = '-1': must not be negative");
  expect_mass_refused(R"(parameter="m" nominal="1e308" deviation="1e308")",
                      "deviation = '1e308': the range is beyond binary64");
  expect_mass_refused(R"(value="nan")", "value = 'nan': not a finite number");
  expect_mass_refused(R"(value="inf")", "value = 'inf': not a finite number");
  expect_mass_refused(R"(value="1e999")", "value = '1e999': beyond the range of binary64");
  expect_mass_refused(R"(value="3 kg")", "value = '3 kg': not a number");
  expect_mass_refused(R"(value="")", "value = '': must not be blank");
}

TEST(StanceFile, RefusesParametersWithoutAMeaning) {
  expect_mass_refused(R"(lower="1" upper="2")", "a range needs the name of a parameter");
  expect_mass_refused(R"(value="1" unit="kg")", "unit = 'kg': explains a parameter: give its name, too");
  expect_mass_refused(R"(parameter="q")", "parameter = 'q': has no numbers here, nor before");
  expect_mass_refused(R"(parameter="Fz" value="1")", "parameter = 'Fz': has its numbers before: give the name alone");
  expect_mass_refused(R"(parameter="Fz" unit="N")", "unit = 'N': belongs where the parameter has its numbers");
  expect_mass_refused(R"(parameter="all" value="1")", "parameter = 'all': is a word of the command line");
  expect_mass_refused(R"(parameter="a,b" value="1")",
                      "parameter = 'a,b': must be letters, digits and _, a letter first");
}

TEST(StanceFile, RefusesNumbersThatNoBodyHas) {
  expect_mass_refused(R"(value="0")", "0 must be positive");
  expect_mass_refused(R"(parameter="m" lower="-1" upper="2")", "-1 must be positive");
  expect_refused(R"(z="0.25"/>)", R"(z="-0.25"/>)", "line 17: <inertia>: z = '-0.25': must not be negative");
  expect_refused(R"(gravity="9.81")", R"(gravity="-9.81")",
                 "line 1: <stance>: gravity = '-9.81': must not be negative");
  expect_refused(R"(integral="5")", R"(integral="-5")", "line 14: <pid>: integral = '-5': must not be negative");
  expect_refused(R"(axis="z")", R"(axis="w")", "line 14: <rotation>: axis = 'w': must be x, y or z");
}

TEST(StanceFile, RefusesNumbersThatNoContactHas) {
  expect_refused(R"(lower="0.25" nominal="0.25")", R"(lower="-0.25" nominal="0.25")",
                 "line 23: <radius>: -0.25 must be positive");
  expect_refused(R"(parameter="e" lower="0.25" upper="0.5")", R"(parameter="e" lower="0.25" upper="1")",
                 "line 24: <normal_restitution>: 1 must be between 0 and 1, both excluded");
  expect_refused(R"(<tangential_restitution parameter="e"/>)", R"(<tangential_restitution value="0"/>)",
                 "line 25: <tangential_restitution>: 0 must be between 0 and 1, both excluded");
  expect_refused(R"(<static_friction value="0.5"/>)", R"(<static_friction value="-0.5"/>)",
                 "line 26: <static_friction>: -0.5 must not be negative");
  expect_refused(R"(exponent="1.5")", R"(exponent="2")", "line 19: <cylinder>: exponent = '2': must be 1 or 1.5");
  expect_refused(R"(half_length="0.125")", R"(half_length="0")",
                 "line 19: <cylinder>: half_length = '0': must be positive");
  expect_refused(R"(y="0.6" z="0.8")", R"(y="0.6" z="0.81")",
                 "line 22: <axis>: its length is 1.008017857, must be 1 to within 1e-09");
  expect_refused(R"(y="0.6" z="0.8")", R"(y="0" z="0")", "line 22: <axis>: its length is 0, must be 1 to within 1e-09");
}

TEST(StanceFile, AnImpactVelocityMayHaveARange) {
  const std::string without = changed(R"( impact_velocity="0.5")", "");
  const auto with_element = [&](const std::string& attributes) {
    std::string xml = without;
    return xml.insert(xml.find("    <centre x="), "    <impact_velocity " + attributes + "/>\n");
  };
  const auto read = [&](const std::string& attributes) {
    return parse_model(with_element(attributes), "m.xml").cylinders[0].impact_velocity;
  };
  EXPECT_EQ(read(R"(value="0.5")").range, (Enclosure{0.5, 0.5}));
  EXPECT_EQ(read(R"(parameter="v" unit="m/s" lower="0.5" upper="2")").range, (Enclosure{0.5, 2.0}));
  EXPECT_EQ(read(R"(parameter="v" nominal="1" deviation="0.5")").range, (Enclosure{0.5, 1.5}));
}

TEST(StanceFile, RefusesWhatIsNoImpactVelocity) {
  const auto refused = [](const std::string& attribute, const std::string& element, const std::string& message) {
    std::string xml = changed(R"( impact_velocity="0.5")", attribute);
    expect_refused(xml.insert(xml.find("    <centre x="), element), message);
  };
  refused("", "", "line 19: <cylinder>: impact_velocity is missing: give an attribute or an element");
  refused(R"( impact_velocity="0")", "", "line 19: <cylinder>: impact_velocity = '0': must be positive");
  refused(R"( impact_velocity="1")", "<impact_velocity value=\"1\"/>\n",
          "line 21: <impact_velocity>: given as an attribute, too");
  refused("", "<impact_velocity parameter=\"v\" lower=\"0\" upper=\"1\"/>\n",
          "line 21: <impact_velocity>: 0 must be positive");
  refused("", "<impact_velocity lower=\"0.5\" upper=\"1\"/>\n",
          "line 21: <impact_velocity>: a range needs the name of a parameter");
  refused("", "<impact_velocity value=\"1\"/>\n<impact_velocity value=\"1\"/>\n",
          "line 22: <impact_velocity>: a second one in <cylinder>");
}

TEST(StanceFile, DynamicFrictionMayExceedStaticFriction) {
  const ContactCylinder sole = parse_model(two_bodies, "m.xml").cylinders[0];  // as in Table 1
  EXPECT_LT(sole.static_friction.nominal, sole.dynamic_friction.nominal);
}

TEST(StanceFile, RefusesWhatItDoesNotKnow) {
  expect_refused(R"(<mass value="1.5"/>)", R"(<mass value="1.5"/><colour/>)",
                 "line 15: <colour>: unknown element in <body>");
  expect_refused(R"(<mass value="1.5"/>)", R"(<mass value="1.5" colour="red"/>)",
                 "line 15: <mass>: unknown attribute 'colour'");
  expect_refused(R"(<mass value="1.5"/>)", R"(<mass value="1.5" value="2"/>)",
                 "line 15: <mass>: attribute 'value' appears twice");
  expect_refused(R"(<mass value="1.5"/>)", R"(<mass value="1.5"/> 3 kg)",
                 "line 12: <body>: unexpected text ' 3 kg\\x0a    '");
  expect_refused(R"(<mass value="1.5"/>)", R"(<mass value="1.5"><x value="1"/></mass>)",
                 "line 15: <x>: unknown element in <mass>");
}

TEST(StanceFile, RefusesWhatIsMissingOrThereTwice) {
  expect_refused(R"(<mass value="1.5"/>)", "", "line 12: <body>: element <mass> is missing");
  expect_refused(R"(<mass value="1.5"/>)", "<mass value=\"1.5\"/>\n<mass value=\"1.5\"/>",
                 "line 16: <mass>: a second one in <body>");
  expect_refused(R"( bristle_damping="300")", "", "line 19: <cylinder>: attribute bristle_damping is missing");
  expect_refused(R"(<offset x="0" y="-0.9" z="0"/>)", "", "line 12: <body>: element <offset> is missing");
  expect_refused(R"(<frequency value="1"/>)", "", "line 2: <applied_force>: element <frequency> is missing");
  expect_refused(R"(x="0" y="-0.9" z="0")", R"(x="0" z="0")",
                 "line 13: <offset>: y is missing: give an attribute or an element");
  expect_refused(R"(<force x="3" y="0">)", R"(<force x="3" y="0" z="0">)", "line 4: <z>: given as an attribute, too");
  expect_refused(R"(stiffness="1e5")", "",
                 "line 19: <cylinder>: stiffness is missing: give an attribute or an element");
  expect_refused("<stance gravity=\"9.81\">\n</stance>", "line 1: <stance>: element <body> is missing");
  expect_refused(R"(    <translation name="height" axis="y" position="1" velocity="-2"/>)",
                 R"(    <translation name="height" axis="y" axis="y"/>)",
                 "line 7: <translation>: attribute 'axis' appears twice");
  const std::size_t begin = two_bodies.find("  <applied_force>");
  const std::size_t end = two_bodies.find("  <body name=\"trunk\"");
  std::string without(two_bodies);
  expect_refused(without.erase(begin, end - begin), "line 1: <stance>: element <applied_force> is missing");
}

TEST(StanceFile, RefusesAModelThatCannotMove) {
  std::string xml = changed(R"(<translation name="height" axis="y" position="1" velocity="-2"/>)", "");
  const std::size_t begin = xml.find("<rotation");
  xml.erase(begin, xml.find("</rotation>") + std::string("</rotation>").size() - begin);
  expect_refused(xml, "line 1: <stance>: no body has a joint");
}

TEST(StanceFile, RefusesNamesThatAreTakenOrUnknown) {
  expect_refused(R"(name="foot" parent="trunk")", R"(name="trunk" parent="trunk")",
                 "line 12: <body>: name = 'trunk': another body has this name");
  expect_refused(R"(name="foot" parent="trunk")", R"(name="foot" parent="foot")",
                 "line 12: <body>: parent = 'foot': no body before this element has this name");
  expect_refused(R"(name="foot" parent="trunk")", R"(name="foot")", "line 12: <body>: attribute parent is missing");
  expect_refused(R"(<body name="trunk">)", R"(<body name="trunk" parent="foot">)",
                 "line 6: <body>: parent = 'foot': the first body is the root and has none");
  expect_refused(R"(<body name="trunk">)", R"(<body name=" ">)", "line 6: <body>: name = ' ': must not be blank");
  expect_refused(R"(body="foot")", R"(body="hand")",
                 "line 19: <cylinder>: body = 'hand': no body before this element has this name");
  expect_refused(R"(<mass value="1.5"/>)", "<rotation name=\"ankle\" axis=\"x\"/><mass value=\"1.5\"/>",
                 "line 15: <rotation>: name = 'ankle': another joint of this body has this name");
  std::string twice(two_bodies);
  const std::size_t begin = twice.find("  <cylinder");
  const std::string cylinder = twice.substr(begin, twice.find("</stance>") - begin);
  expect_refused(twice.insert(begin, cylinder), "line 29: <cylinder>: name = 'sole': another cylinder has this name");
}

TEST(StanceFile, RefusesWhatIsNoXml) {
  expect_refused("", "line 1: not XML: no element");
  expect_refused("\n\n", "line 3: not XML: no element");
  expect_refused("stance", "not XML: text outside of the root: 'stance'");
  expect_refused("<stance gravity=\"9.81\">\n  <body\n", "line 2: not XML: Error parsing start element tag");
  expect_refused("<stance>\n</stand>", "line 2: not XML: Start-end tags mismatch");
  expect_refused("<stance/>\n<stance/>", "line 2: <stance>: not XML: a second root");
  expect_refused("<stance/>\n\x01", "line 2: not XML: control character \\x01");
  expect_refused("<position/>", "line 1: <position>: the root must be <stance>");
  expect_refused(std::string(two_bodies) + "after", "not XML: text outside of the root: '\\x0aafter'");
}

TEST(StanceFile, CountsLinesOfWindowsToo) {
  std::string xml = changed(R"(<mass value="1.5"/>)", R"(<mass value="-1.5"/>)");
  for (std::size_t at = 0; (at = xml.find('\n', at)) != std::string::npos; at += 2) xml.insert(at, 1, '\r');
  expect_refused(xml, "line 15: <mass>: -1.5 must be positive");
}

TEST(StanceFile, ReadsFilesAndNamesThem) {
  const TemporaryFolder folder;
  EXPECT_EQ(read_model(folder.file("m.xml", two_bodies)).bodies.size(), 2U);
  const auto broken = folder.file("broken.xml", changed(R"(<mass value="1.5"/>)", R"(<mass value="x"/>)"));
  expect_input_error([&] { (void)read_model(broken); }, broken, ": line 15: <mass>: value = 'x': not a number");
  expect_input_error([&] { (void)read_model(folder / "none.xml"); }, folder / "none.xml", ": no such file");
  const auto empty = folder.file("empty.xml", "");
  expect_input_error([&] { (void)read_model(empty); }, empty, ": the file is empty");
}

}  // namespace
}  // namespace verisq::stance
