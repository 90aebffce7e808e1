/// Fuzz target of stance::parse_model.
#include <algorithm>
#include <cmath>
#include <set>
#include <verisq/stance.hpp>

#include "tests/fuzz/promise.hpp"
#include "tests/fuzz/targets.hpp"

namespace verisq::fuzz {
namespace {

using stance::ContactCylinder;
using stance::Quantity;
using stance::QuantityVector;

void check_range(const Enclosure& range, double nominal) {
  check(std::isfinite(range.lo) && std::isfinite(range.hi), "numbers are finite");
  check(range.contains(nominal), "a range contains the nominal number");
}

/// Promises of one model, which its quantities refer to.
class ModelPromise {
 public:
  explicit ModelPromise(const stance::Model& model) : model_(model) {}

  void check_all() const {
    check(std::isfinite(model_.gravity) && model_.gravity >= 0.0, "gravity is finite and not negative");
    check_parameters();
    check_bodies();
    for (const ContactCylinder& cylinder : model_.cylinders) check_cylinder(cylinder);
    check_names(model_.cylinders);
    check_controllers();
    check_vector(model_.applied.force);
    check_quantity(model_.applied.frequency);
  }

 private:
  template <class Named>
  static void check_names(const std::vector<Named>& all) {
    std::set<std::string> names;
    for (const Named& one : all) check(!one.name.empty() && names.insert(one.name).second, "names are distinct");
  }

  void check_quantity(const Quantity& quantity) const {
    check_range(quantity.range, quantity.nominal);
    if (!quantity.parameter) {
      check(quantity.range.width() == 0.0, "what has a range is a parameter");
      return;
    }
    check(*quantity.parameter < model_.parameters.size(), "parameters are known");
    const stance::Parameter& parameter = model_.parameters[*quantity.parameter];
    check(parameter.range == quantity.range && parameter.nominal == quantity.nominal,
          "a quantity has its parameter's numbers");
  }

  void check_vector(const QuantityVector& vector) const {
    for (const Quantity& quantity : vector) check_quantity(quantity);
  }

  void check_positive(const Quantity& quantity) const {
    check_quantity(quantity);
    check(quantity.range.lo > 0.0, "masses, radii and impact velocities are positive");
  }

  void check_parameters() const {
    check_names(model_.parameters);
    for (const stance::Parameter& parameter : model_.parameters) check_range(parameter.range, parameter.nominal);
  }

  void check_bodies() const {
    check(!model_.bodies.empty() && !model_.bodies[0].parent, "the first body is the root");
    check(model_.degrees_of_freedom() > 0, "a model can move");
    check_names(model_.bodies);
    for (std::size_t k = 0; k < model_.bodies.size(); ++k) {
      const stance::Body& body = model_.bodies[k];
      check(k == 0 || (body.parent && *body.parent < k), "parents stand before their children");
      check_names(body.joints);
      check_vector(body.offset);
      check_vector(body.centre_of_mass);
      check_vector(body.inertia);
      check_positive(body.mass);
      check(std::ranges::all_of(body.inertia, [](const Quantity& i) { return i.range.lo >= 0.0; }),
            "inertia is not negative");
      for (const stance::Joint& joint : body.joints) {
        check(joint.axis < 3 && std::isfinite(joint.position) && std::isfinite(joint.velocity), "joints are finite");
      }
    }
  }

  void check_cylinder(const ContactCylinder& cylinder) const {
    check(cylinder.body < model_.bodies.size(), "bodies of cylinders are known");
    check_vector(cylinder.centre);
    check_positive(cylinder.radius);
    for (const Quantity& quantity : {cylinder.normal_restitution, cylinder.tangential_restitution}) {
      check_positive(quantity);
      check(quantity.range.hi < 1.0, "restitution is below 1");
    }
    for (const Quantity& quantity : {cylinder.static_friction, cylinder.dynamic_friction}) {
      check_quantity(quantity);
      check(quantity.range.lo >= 0.0, "friction is not negative");
    }
    check_positive(cylinder.impact_velocity);
    check_positive(cylinder.stiffness);
    for (const double number : {cylinder.half_length, cylinder.stribeck_velocity}) {
      check(std::isfinite(number) && number > 0.0, "numbers of contact are positive");
    }
    const double k_t = cylinder.bristle_stiffness;
    const double c_t = cylinder.bristle_damping;
    check(std::isfinite(k_t) && std::isfinite(c_t) && (k_t > 0.0) == (c_t > 0.0) && k_t >= 0.0 && c_t >= 0.0,
          "bristles are positive or not there");
    check(cylinder.exponent == 1.0 || cylinder.exponent == 1.5, "the exponent is 1 or 1.5");
    const auto& [x, y, z] = cylinder.axis;
    check(std::abs(std::hypot(x, y, z) - 1.0) < 1e-8, "axes have length 1");
  }

  void check_controllers() const {
    for (const auto& [body, joint, proportional, integral, derivative] : model_.controllers) {
      check(body < model_.bodies.size() && joint < model_.bodies[body].joints.size(), "controlled joints are known");
      for (const double gain : {proportional, integral, derivative}) {
        check(std::isfinite(gain) && gain >= 0.0, "gains are finite and not negative");
      }
    }
  }

  const stance::Model& model_;
};

}  // namespace

void stance_model(Bytes bytes) {
  const std::string name = "stance.xml";
  const std::string xml(bytes.begin(), bytes.end());  // a copy, so that reading past its end shows
  read_or_refuse(name, [&] { ModelPromise(stance::parse_model(xml, name)).check_all(); });
}

}  // namespace verisq::fuzz
