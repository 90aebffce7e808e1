/// A body at rest on the ground: its forces and their derivatives.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "verify/numbers/functions.hpp"
#include "verify/numbers/interval.hpp"
#include "verisq/model.hpp"
#include "verisq/stance.hpp"
#include "verisq/stance_equilibrium.hpp"

namespace verisq::verify {

// Functions of several variables with all of their first derivatives, at 127 bits: forward-mode differentiation.

/// Over a box of the variables `value` contains all values, and `by[k]` all partial derivatives by variable k. Throws
/// like intervals.
struct Differentiated {
  PreciseInterval value = 0;
  std::vector<PreciseInterval> by = {};  ///< one for each variable; empty: a constant

  Differentiated() = default;
  Differentiated(double constant) : value(Real(constant)) {}  // NOLINT(google-explicit-constructor): a constant is one
  Differentiated(const PreciseInterval& constant)             // NOLINT(google-explicit-constructor): likewise
      : value(constant) {}
  Differentiated(const PreciseInterval& of, std::vector<PreciseInterval> derivatives)
      : value(of), by(std::move(derivatives)) {}

  /// The k-th of `count` variables.
  static Differentiated variable(const PreciseInterval& range, std::size_t k, std::size_t count) {
    Differentiated result(range, std::vector<PreciseInterval>(count, PreciseInterval(0)));
    result.by[k] = 1;
    return result;
  }

  friend Differentiated operator-(const Differentiated& a) { return chain(a, -a.value, -1); }
  friend Differentiated operator+(const Differentiated& a, const Differentiated& b) {
    return combined(a, 1, b, 1, a.value + b.value);
  }
  friend Differentiated operator-(const Differentiated& a, const Differentiated& b) {
    return combined(a, 1, b, -1, a.value - b.value);
  }
  friend Differentiated operator*(const Differentiated& a, const Differentiated& b) {
    return combined(a, b.value, b, a.value, a.value * b.value);
  }
  friend Differentiated operator/(const Differentiated& a, const Differentiated& b) {
    const PreciseInterval quotient = a.value / b.value;
    return combined(a, PreciseInterval(1) / b.value, b, -quotient / b.value, quotient);
  }
  Differentiated& operator+=(const Differentiated& b) { return *this = *this + b; }
  Differentiated& operator-=(const Differentiated& b) { return *this = *this - b; }

  friend Differentiated square(const Differentiated& a) {
    return chain(a, square(a.value), PreciseInterval(2) * a.value);
  }
  /// Infinite derivatives where the root comes down to 0.
  friend Differentiated sqrt(const Differentiated& a) {
    const PreciseInterval root = sqrt(a.value);
    return a.by.empty() ? Differentiated(root) : chain(a, root, PreciseInterval(1) / (PreciseInterval(2) * root));
  }
  friend Differentiated sin(const Differentiated& a) { return chain(a, sin(a.value), cos(a.value)); }
  friend Differentiated cos(const Differentiated& a) { return chain(a, cos(a.value), -sin(a.value)); }
  /// sgn(a) |a|^1.5, which has a continuous derivative everywhere.
  friend Differentiated power_of_three_halves(const Differentiated& a) {
    const PreciseInterval root = sqrt(abs(a.value));
    return chain(a, a.value * root, PreciseInterval(Real(1.5)) * root);
  }

 private:
  /// f(a), whose derivative by a is `slope`.
  static Differentiated chain(const Differentiated& a, const PreciseInterval& f, const PreciseInterval& slope) {
    Differentiated result(f, a.by);
    for (PreciseInterval& derivative : result.by) derivative = slope * derivative;
    return result;
  }

  /// f(a, b), whose derivatives by a and b are these.
  static Differentiated combined(const Differentiated& a, const PreciseInterval& by_a, const Differentiated& b,
                                 const PreciseInterval& by_b, const PreciseInterval& f) {
    if (b.by.empty()) return chain(a, f, by_a);
    if (a.by.empty()) return chain(b, f, by_b);
    Differentiated result(f, a.by);
    for (std::size_t k = 0; k < result.by.size(); ++k) result.by[k] = by_a * a.by[k] + by_b * b.by[k];
    return result;
  }
};

[[nodiscard]] inline PreciseInterval power_of_three_halves(const PreciseInterval& a) {
  return a * sqrt(abs(a));
}

/// Returns whether the number is 0, and constant.
[[nodiscard]] inline bool is_zero(const PreciseInterval& a) {
  return a.lower() == Real(0) && a.upper() == Real(0);
}
[[nodiscard]] inline bool is_zero(const Differentiated& a) {
  return a.by.empty() && is_zero(a.value);
}

// The body that is to stand, and the numbers that describe its postures.

/// A posture consists of the reference point's height and then the positions of the sought joints.
struct StandingBody {
  const stance::Model& model;
  stance::JointControl control;
  std::vector<std::uint32_t> uncertain;  ///< parameters of the model
  Point reference;  ///< in the root's frame; any point is valid, ranges are narrow for points next to the ground
  std::vector<std::size_t> joints;  ///< sought
  std::vector<double> stiffness;    ///< of all joints

  [[nodiscard]] std::size_t unknowns() const { return joints.size() + 1; }
};

/// Throws Error(input) as require_standing_model.
[[nodiscard]] StandingBody standing_body(const stance::Model& model, stance::JointControl control,
                                         stance::UncertainSet uncertain, const Point& reference);

// The loads that hold a body at rest on the ground, as functions of its posture and its parameters: the statics of a
// tree of rigid bodies, by each load's lever about each joint (docs/stance.md §7).

// T is PreciseInterval or Differentiated. Axes are the world's, y upward. Places are relative to the reference point, a
// point of the root next to the ground: levers and heights then change by no more than the parts that turn about the
// feet.

template <class T>
struct Posture {
  T height;               ///< of the reference point above the ground, m
  std::vector<T> joints;  ///< of all bodies in order, m or rad; the root's translations do not count
};

template <class T>
struct BodyAtRest {
  T force;               ///< all vertical forces together, N: 0 in equilibrium
  T moment_z, moment_x;  ///< moments of these forces about the reference point, about z and -x, N m: 0 in equilibrium
  std::vector<T> penetrations;  ///< of all points, m
  std::vector<T> forces;        ///< of the ground on all cylinders, N
  T pressure_x, pressure_z;     ///< in equilibrium, the centre of pressure, in the world, m
  T height_of_root;             ///< the root's translation along y, m
  std::vector<T> torques;       ///< torques that hold the joints, N m or N; 0 for the root's joints
};

namespace at_rest {

template <class T>
using Vector = std::array<T, 3>;

template <class T>
[[nodiscard]] Vector<T> sum(const Vector<T>& a, const Vector<T>& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

template <class T>
[[nodiscard]] T value_of(const stance::Quantity& quantity, const std::vector<T>& parameters) {
  return quantity.parameter ? parameters[*quantity.parameter] : T(PreciseInterval(Real(quantity.nominal)));
}

template <class T>
[[nodiscard]] Vector<T> values_of(const stance::QuantityVector& quantities, const std::vector<T>& parameters) {
  return {value_of(quantities[0], parameters), value_of(quantities[1], parameters),
          value_of(quantities[2], parameters)};
}

template <class T>
[[nodiscard]] Vector<T> exact(const std::array<double, 3>& v) {
  return {T(PreciseInterval(Real(v[0]))), T(PreciseInterval(Real(v[1]))), T(PreciseInterval(Real(v[2])))};
}

template <class T>
struct Frame {
  Vector<T> origin;
  std::array<Vector<T>, 3> axes;

  static Frame at(const Vector<T>& origin) {
    return {origin, {exact<T>({1.0, 0.0, 0.0}), exact<T>({0.0, 1.0, 0.0}), exact<T>({0.0, 0.0, 1.0})}};
  }

  [[nodiscard]] Vector<T> direction(const Vector<T>& in_frame) const {
    Vector<T> result = exact<T>({0.0, 0.0, 0.0});
    for (std::size_t k = 0; k < 3; ++k) {
      if (is_zero(in_frame[k])) continue;
      for (std::size_t i = 0; i < 3; ++i) {
        if (!is_zero(axes[k][i])) result[i] = result[i] + axes[k][i] * in_frame[k];
      }
    }
    return result;
  }
  [[nodiscard]] Vector<T> point(const Vector<T>& in_frame) const { return sum(origin, direction(in_frame)); }

  /// The frame turned by an angle about one of its axes.
  [[nodiscard]] Frame turned(std::size_t axis, const T& angle) const {
    const T c = cos(angle);
    const T s = sin(angle);
    Vector<T> first = exact<T>({0.0, 0.0, 0.0});
    Vector<T> second = first;
    first[(axis + 1) % 3] = c;
    first[(axis + 2) % 3] = s;
    second[(axis + 1) % 3] = -s;
    second[(axis + 2) % 3] = c;
    Frame result = *this;
    result.axes[(axis + 1) % 3] = direction(first);
    result.axes[(axis + 2) % 3] = direction(second);
    return result;
  }
};

/// A joint of a body that another carries.
template <class T>
struct PlacedJoint {
  std::size_t index;  ///< among all joints
  bool turns;
  Vector<T> axis;
  Vector<T> origin;
};

/// A vertical force on a body.
template <class T>
struct Load {
  std::size_t body;
  T upward;
  Vector<T> place;
};

/// All frames and joints of a posture.
template <class T>
class Skeleton {
 public:
  Skeleton(const stance::Model& model, const std::vector<T>& parameters, const std::vector<T>& joints,
           const Point& reference)
      : model_(model), root_(Frame<T>::at(exact<T>({0.0, 0.0, 0.0}))) {
    // Places are computed in the root's frame first: intervals of the root's own rotation then meet each place once.
    std::size_t joint = 0;
    for (std::size_t i = 0; i < model.bodies.size(); ++i) {
      const stance::Body& body = model.bodies[i];
      joints_.emplace_back();
      if (!body.parent) {
        for (const stance::Joint& of_root : body.joints) {
          if (of_root.kind == stance::JointKind::rotation) root_ = root_.turned(of_root.axis, joints[joint]);
          ++joint;
        }
        frames_.push_back(Frame<T>::at(exact<T>({-reference[0], -reference[1], -reference[2]})));
        continue;
      }
      Frame<T> frame = frames_[*body.parent];
      frame.origin = frame.point(values_of(body.offset, parameters));
      for (const stance::Joint& of_body : body.joints) {
        const std::size_t index = joint++;
        const bool turns = of_body.kind == stance::JointKind::rotation;
        joints_[i].push_back({index, turns, frame.axes[of_body.axis], frame.origin});
        if (turns) {
          frame = frame.turned(of_body.axis, joints[index]);
        } else {
          Vector<T> shift = exact<T>({0.0, 0.0, 0.0});
          shift[of_body.axis] = joints[index];
          frame.origin = frame.point(shift);
        }
      }
      frames_.push_back(frame);
    }
    for (std::vector<PlacedJoint<T>>& of_body : joints_) {
      for (PlacedJoint<T>& placed : of_body) {
        placed.axis = root_.direction(placed.axis);
        placed.origin = root_.direction(placed.origin);
      }
    }
  }

  /// The place of a point of a body.
  [[nodiscard]] Vector<T> place(std::size_t body, const Vector<T>& in_body) const {
    return root_.direction(frames_[body].point(in_body));
  }
  [[nodiscard]] Vector<T> direction(std::size_t body, const Vector<T>& in_body) const {
    return root_.direction(frames_[body].direction(in_body));
  }
  /// The vector from the root's origin to the reference point.
  [[nodiscard]] Vector<T> of_root(const Point& reference) const { return root_.direction(exact<T>(reference)); }

  /// The torque that holds each joint against the loads on the bodies that it carries.
  [[nodiscard]] std::vector<T> holding(const std::vector<Load<T>>& loads) const {
    std::vector<T> torques(model_.degrees_of_freedom(), T(PreciseInterval(0)));
    for (const Load<T>& load : loads) {
      for (std::optional<std::uint32_t> body = load.body; body; body = model_.bodies[*body].parent) {
        for (const PlacedJoint<T>& joint : joints_[*body])
          torques[joint.index] = torques[joint.index] - share_of(joint, load);
      }
    }
    return torques;
  }

 private:
  /// The load's work while the joint moves by one unit: of a rotation, the vertical part of axis x lever.
  static T share_of(const PlacedJoint<T>& joint, const Load<T>& load) {
    if (!joint.turns) return joint.axis[1] * load.upward;
    const T lever_x = load.place[0] - joint.origin[0];
    const T lever_z = load.place[2] - joint.origin[2];
    return (joint.axis[2] * lever_x - joint.axis[0] * lever_z) * load.upward;
  }

  const stance::Model& model_;
  Frame<T> root_;                                    ///< its rotation
  std::vector<Frame<T>> frames_;                     ///< of all bodies, in axes parallel to the root's
  std::vector<std::vector<PlacedJoint<T>>> joints_;  ///< of all bodies
};

/// Vertical forces and their moments about the reference point.
template <class T>
struct Sum {
  T force = T(PreciseInterval(0));
  T moment_z = force;
  T moment_x = force;

  void add(const Load<T>& load) {
    force = force + load.upward;
    moment_z = moment_z + load.upward * load.place[0];
    moment_x = moment_x + load.upward * load.place[2];
  }
};

/// The root's origin in the world, by the file's translations.
template <class T>
[[nodiscard]] Vector<T> origin_of_root(const stance::Model& model, const std::vector<T>& parameters) {
  const stance::Body& root = model.bodies.front();
  Vector<T> origin = values_of(root.offset, parameters);
  for (const stance::Joint& joint : root.joints) {
    if (joint.kind == stance::JointKind::translation)
      origin[joint.axis] = origin[joint.axis] + T(PreciseInterval(Real(joint.position)));
  }
  return origin;
}

}  // namespace at_rest

/// The weights, the applied force's vertical part at t = 0 and the cylinders' elastic forces act. A point above the
/// ground is pulled down, as if the cylinder stuck to it: a proof that a body stands must prove that all points press.
/// Preconditions: a posture of all joints, all parameters; bodies behind their parents, the root alone without one,
/// translated before it is turned; exponents 1 or 1.5. Throws std::domain_error for a cylinder that stands upright.
template <class T>
[[nodiscard]] BodyAtRest<T> body_at_rest(const stance::Model& model, const std::vector<T>& parameters,
                                         const Posture<T>& posture, const Point& reference) {
  using namespace at_rest;
  const Skeleton<T> skeleton(model, parameters, posture.joints, reference);
  const PreciseInterval of_gauss = PreciseInterval(1) / sqrt(PreciseInterval(3));
  BodyAtRest<T> result;
  std::vector<Load<T>> loads;
  Sum<T> ground;
  for (const stance::ContactCylinder& cylinder : model.cylinders) {
    const Vector<T> axis = skeleton.direction(cylinder.body, exact<T>(cylinder.axis));
    const T s = sqrt(T(PreciseInterval(1)) - square(axis[1]));
    const T radius = value_of(cylinder.radius, parameters);
    const T lean = radius * axis[1] / s;
    const T stiffness = value_of(cylinder.stiffness, parameters) / T(PreciseInterval(2));
    T of_cylinder = T(PreciseInterval(0));
    for (const int side : {-1, 1}) {
      Vector<T> centre = values_of(cylinder.centre, parameters);
      for (std::size_t k = 0; k < 3; ++k) {
        const PreciseInterval along = PreciseInterval(Real(cylinder.axis[k])) * PreciseInterval(side) *
                                      PreciseInterval(Real(cylinder.half_length)) * of_gauss;
        centre[k] = centre[k] + T(along);
      }
      const Vector<T> place = skeleton.place(cylinder.body, centre);
      const T penetration = radius * s - (posture.height + place[1]);
      const T force = stiffness * (cylinder.exponent == 1.0 ? penetration : power_of_three_halves(penetration));
      // The disc's lowest point; its height does not matter to a vertical force.
      loads.push_back({cylinder.body, force, {place[0] + lean * axis[0], place[1], place[2] + lean * axis[2]}});
      ground.add(loads.back());
      result.penetrations.push_back(penetration);
      of_cylinder = of_cylinder + force;
    }
    result.forces.push_back(of_cylinder);
  }
  Sum<T> carried;
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const stance::Body& body = model.bodies[i];
    const T weight = value_of(body.mass, parameters) * T(PreciseInterval(Real(-model.gravity)));
    loads.push_back({i, weight, skeleton.place(i, values_of(body.centre_of_mass, parameters))});
    carried.add(loads.back());
  }
  result.torques = skeleton.holding(loads);
  // The force acts on the root, at the point that its translations carry from the world's origin: `offset` before the
  // root's origin.
  const Vector<T> offset = values_of(model.bodies.front().offset, parameters);
  const Vector<T> to_reference = skeleton.of_root(reference);
  carried.add({0,
               value_of(model.applied.force[1], parameters),
               {-offset[0] - to_reference[0], -offset[1] - to_reference[1], -offset[2] - to_reference[2]}});
  result.force = ground.force + carried.force;
  result.moment_z = ground.moment_z + carried.moment_z;
  result.moment_x = ground.moment_x + carried.moment_x;
  const Vector<T> origin = origin_of_root(model, parameters);
  // In equilibrium the ground's forces and moments equal the forces and moments that it carries; stiffness has no part
  // in them.
  result.pressure_x = origin[0] + to_reference[0] + carried.moment_z / carried.force;
  result.pressure_z = origin[2] + to_reference[2] + carried.moment_x / carried.force;
  result.height_of_root = posture.height - to_reference[1] - offset[1];
  return result;
}

}  // namespace verisq::verify
