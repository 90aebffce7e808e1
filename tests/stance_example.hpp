/// The nine-segment stance model of the paper in code (docs/stance.md §2; paper Table 1), for tests.
#pragma once

#include <cstdint>
#include <string>
#include <verisq/stance_model.hpp>

namespace verisq::stance {

/// Order of the example's parameters: Table 1's, then the mass of the right femur (Table 4's third column).
enum ExampleParameter : std::uint32_t { omega, Fx, Fy, mp, px, py, pz, rff, rhf, eN, eT, mu_st, mu_d, mf };

namespace example {

inline Quantity number(double value) {
  return {value, {value, value}, {}};
}

inline QuantityVector numbers(double x, double y, double z) {
  return {number(x), number(y), number(z)};
}

inline Quantity quantity(const Model& model, std::uint32_t parameter) {
  return {model.parameters[parameter].nominal, model.parameters[parameter].range, parameter};
}

inline Parameter parameter(const char* name, const char* unit, const char* description, double lowest, double highest) {
  return {name, unit, description, 0.5 * (lowest + highest), {lowest, highest}};
}

inline std::vector<Parameter> parameters() {
  return {parameter("omega", "1/s", "frequency of the applied force", 0.5, 6.28),
          parameter("Fx", "N", "applied force along x", 0, 200),
          parameter("Fy", "N", "applied force along y", 0, 50),
          parameter("mp", "kg", "pelvis mass", 35, 65),
          parameter("px", "m", "x of the pelvis's centre of mass", 0.05, 0.1),
          parameter("py", "m", "y of the pelvis's centre of mass", 0.1, 0.5),
          parameter("pz", "m", "z of the pelvis's centre of mass", -0.05, 0.05),
          parameter("rff", "m", "radius of the forefoot", 0.04, 0.2),
          parameter("rhf", "m", "radius of the hindfoot", 0.02, 0.15),
          parameter("eN", "1", "normal restitution", 0.01, 0.2),
          parameter("eT", "1", "tangential restitution", 0.01, 0.2),
          parameter("mu_st", "1", "static friction coefficient", 0.5, 2.0),
          parameter("mu_d", "1", "dynamic friction coefficient", 0.08, 2.3),
          parameter("mf", "kg", "mass of the right femur", 10.34, 10.34)};
}

inline Joint translation(std::uint8_t axis, double position = 0) {
  return {std::string("t") + "xyz"[axis], JointKind::translation, axis, position, 0};
}

inline Joint rotation(std::uint8_t axis) {
  return {std::string("r") + "xyz"[axis], JointKind::rotation, axis, 0, 0};
}

inline std::vector<Joint> ball() {
  return {rotation(2), rotation(0), rotation(1)};
}

/// The body's frame lies between the hips, 0.05 m behind the root's reference point: its centre of mass is at px there.
inline Body pelvis(const Model& model) {
  return {"pelvis",
          {},
          numbers(-0.05, 0, 0),
          {translation(0), translation(1, 1.0), translation(2), rotation(2), rotation(0), rotation(1)},
          quantity(model, mp),
          {quantity(model, px), quantity(model, py), quantity(model, pz)},
          numbers(2.5, 1.0, 2.3)};
}

inline ContactCylinder cylinder(const Model& model, const std::string& name, std::uint32_t body, double x, double y,
                                ExampleParameter radius) {
  return {name,
          body,
          numbers(x, y, 0),
          {0, 0, 1},
          quantity(model, radius),
          0.04,
          1e5,
          1,
          number(1),
          quantity(model, eN),
          quantity(model, eT),
          quantity(model, mu_st),
          quantity(model, mu_d),
          0.01};
}

/// Femur, tibia, hindfoot, forefoot, each the next one's parent; `side` is 1 on the right and -1 on the left.
inline void add_leg(Model& model, const std::string& name, double side, const Quantity& femur_mass) {
  const auto hip = static_cast<std::uint32_t>(model.bodies.size());
  model.bodies.push_back({name + " femur", 0, numbers(0, 0, side * 0.0795), ball(), femur_mass, numbers(0, -0.172, 0),
                          numbers(0.20, 0.041, 0.20)});
  model.bodies.push_back({name + " tibia", hip, numbers(0, -0.42, 0), ball(), number(3.87), numbers(0, -0.189, 0),
                          numbers(0.046, 0.0075, 0.047)});
  model.bodies.push_back({name + " hindfoot", hip + 1, numbers(0, -0.43, 0), ball(), number(0.84),
                          numbers(0.0342, -0.045, 0), numbers(0.0012, 0.0022, 0.0024)});
  model.bodies.push_back({name + " forefoot",
                          hip + 2,
                          numbers(0.11, -0.06, 0),
                          {rotation(2)},
                          number(0.36),
                          numbers(0.025, -0.01, 0),
                          numbers(3e-4, 4e-4, 4e-4)});
  model.cylinders.push_back(cylinder(model, name + " hindfoot", hip + 2, 0, -0.045, rhf));
  model.cylinders.push_back(cylinder(model, name + " forefoot", hip + 3, 0.025, -0.01, rff));
}

}  // namespace example

inline Model nine_segments() {
  Model model{9.81, {}, {}, {}, {}, example::parameters()};
  model.bodies.push_back(example::pelvis(model));
  example::add_leg(model, "right", 1, example::quantity(model, mf));
  example::add_leg(model, "left", -1, example::number(10.34));
  for (std::uint32_t body = 1; body < model.bodies.size(); ++body) {
    for (std::uint32_t joint = 0; joint < model.bodies[body].joints.size(); ++joint) {
      model.controllers.push_back({body, joint, 400, 40, 20});
    }
  }
  model.applied = {{example::quantity(model, Fx), example::quantity(model, Fy), example::number(0)},
                   example::quantity(model, omega)};
  return model;
}

}  // namespace verisq::stance
