/// The body on the ground: what a contact presses with, and the equations of a body that stands.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>
#include <verisq/stance_equilibrium.hpp>

#include "verify/numbers/functions.hpp"
#include "verify/proof/equilibrium_checker.hpp"
#include "verify/stance/rnea.hpp"
#include "verify/stance/scalar.hpp"
#include "verify/stance/tree.hpp"

namespace verisq::stance {

// The forces of one contact: stiffness, damping, friction.

// The damping of Hunt-Crossley contact that gives a restitution: D in F = k delta^n (1 + D delta'/v_N)
// (docs/stance.md §4).

/// The positive root D of ln((1 + D)/(1 - D e)) = D (1 + e), for all e of `restitution`: without gravity, a body that
/// touches down at v_N rebounds at e v_N, for every exponent n. 0 for e = 1. Tight: adjacent numbers for one e.
/// Throws std::domain_error unless 0 < e <= 1.
[[nodiscard]] Interval damping_factor(const Interval& restitution);

/// The same to nearest, or next to it.
[[nodiscard]] double damping_factor(double restitution);

/// dD/de for a pair of the relation, by the implicit function theorem: -D e (1 + D) / ((1 + e) (e (1 + D) - 1)).
/// Infinite over intervals that reach e = 1.
template <class T>
[[nodiscard]] T damping_slope(const T& restitution, const T& damping) {
  const T one(1);
  return -(damping * restitution * (one + damping)) / ((one + restitution) * (restitution * (one + damping) - one));
}

/// dD/de of all e of `restitution`, by parts of the range: D nearly is 1/e, so that over a wide one e (1 + D) - 1 would
/// lose its sign. Infinite where the range reaches e = 1. Throws std::domain_error unless 0 < e <= 1.
[[nodiscard]] Interval damping_slopes(const Interval& restitution);

template <class T, std::size_t N>
[[nodiscard]] Dual<T, N> damping_factor(const Dual<T, N>& restitution) {
  const T damping = damping_factor(restitution.value);
  T slope;
  if constexpr (std::is_same_v<T, Interval>) {
    slope = damping_slopes(restitution.value);
  } else {
    slope = damping_slope(restitution.value, damping);
  }
  Dual<T, N> result(damping);
  for (std::size_t k = 0; k < N; ++k) result.partial[k] = slope * restitution.partial[k];
  return result;
}

// Friction with a bristle: an elastic force that a velocity-dependent coefficient limits (docs/stance.md §4).

/// Coefficients of one contact; none negative. Dynamic friction may exceed static friction (paper, Table 1).
template <class T>
struct FrictionLaw {
  T static_coefficient;      ///< mu_st
  T dynamic_coefficient;     ///< mu_d
  double stribeck_velocity;  ///< v_s > 0, m/s
};

namespace friction_details {

/// at_zero + (at_one - at_zero) weight, for a weight in [0, 1].
template <class T>
[[nodiscard]] T mixed(const T& at_zero, const T& at_one, const T& weight) {
  return at_zero + (at_one - at_zero) * weight;
}
/// Linear in the weight, monotone in the rest: the ends of the weight give the exact range.
[[nodiscard]] inline Interval mixed(const Interval& at_zero, const Interval& at_one, const Interval& weight) {
  const auto at = [&](const Interval& w) { return at_zero * (Interval(1) - w) + at_one * w; };
  return hull(at(weight.lower()), at(weight.upper()));
}

}  // namespace friction_details

/// mu(v) = mu_d + (mu_st - mu_d) exp(-(v/v_s)^2), for the sliding velocity v.
template <class T>
[[nodiscard]] T friction_coefficient(const FrictionLaw<T>& law, const T& velocity) {
  const T weight = exp(-square(T(velocity / T(law.stribeck_velocity))));
  return friction_details::mixed(law.dynamic_coefficient, law.static_coefficient, weight);
}

// Hunt-Crossley contact of a cylinder with the ground y = 0 (docs/stance.md §4), over double, Interval and Dual.

namespace contact_details {

template <class T>
[[nodiscard]] T power(const T& base, double exponent) {
  return pow(base, T(exponent));
}
/// A constant exponent: differentiable at base 0.
template <class T, std::size_t N>
[[nodiscard]] Dual<T, N> power(const Dual<T, N>& base, double exponent) {
  return pow(base, T(exponent));
}

}  // namespace contact_details

/// The law F_n = k delta_+^n max(0, 1 + D delta'/v_N).
template <class T>
struct HuntCrossley {
  T stiffness;        ///< k, N / m^n
  double exponent;    ///< n >= 1
  T damping;          ///< D, see damping_factor()
  T impact_velocity;  ///< v_N > 0, m/s
};

/// N, never negative; 0 without penetration. `rate` is delta', m/s.
template <class T>
[[nodiscard]] T normal_force(const HuntCrossley<T>& law, const T& penetration, const T& rate) {
  const auto clear = [](const T&) { return T(0); };
  const auto pressed = [&](const T& delta) {
    const T damped = max(T(T(1) + law.damping * rate / law.impact_velocity), T(0));
    return T(law.stiffness * contact_details::power(delta, law.exponent) * damped);
  };
  return piecewise(penetration, 0.0, clear, pressed);
}

// The equations of a standing body.

// The balance of forces of a body at rest on the ground, over any scalar (docs/stance.md §7).

/// A vertical force and the place that it acts on, in axes parallel to the world's, from the reference point on.
template <class T>
struct VerticalForce {
  T upward;  ///< N
  Vector3<T> place;
};

/// One of the points at which a cylinder presses.
template <class T>
struct PressedPoint {
  T penetration;           ///< m
  VerticalForce<T> force;  ///< above the ground downward, as if the cylinder stuck to it
};

/// A posture by what is next to the ground. The root's joints turn the body about the reference point, which lies
/// `reference` from the root's origin in its own frame: levers and heights then change by no more than what turns about
/// the feet, and intervals of them stay narrow.
template <class T>
struct StandingPosture {
  T height;               ///< of the reference point above the ground, m
  std::vector<T> joints;  ///< positions of all; the root's translations do not count
};

namespace standing_details {

/// Links and bodies in the root's frame.
template <class T>
struct BodyInRoot {
  Tree<T> tree;
  std::vector<BodyPose<T>> links;

  [[nodiscard]] const BodyPose<T>& body(std::size_t i) const { return links[tree.body_link[i]]; }
};

template <class T>
[[nodiscard]] BodyInRoot<T> body_in_root(const Model& model, const std::vector<T>& parameters,
                                         const std::vector<T>& joints) {
  BodyInRoot<T> result{tree_of<T>(model, parameters, joints), {}};
  const std::vector<Link<T>>& links = result.tree.links;
  for (std::size_t i = 0; i < links.size(); ++i) {
    const bool of_root = i <= result.tree.body_link.front();
    result.links.push_back(of_root ? BodyPose<T>{Matrix3<T>::Identity(), zero_vector<T>()}
                                   : kinematics_details::composed(result.links[*links[i].parent], links[i].transform));
  }
  return result;
}

template <class T>
[[nodiscard]] Vector3<T> exact(const std::array<double, 3>& x) {
  return {T(x[0]), T(x[1]), T(x[2])};
}

/// Of the root, by its rotations in their order.
template <class T>
[[nodiscard]] Matrix3<T> orientation_of_root(const Model& model, const std::vector<T>& joints) {
  BodyPose<T> pose{Matrix3<T>::Identity(), zero_vector<T>()};
  const std::vector<Joint>& of_root = model.bodies.front().joints;
  for (std::size_t j = 0; j < of_root.size(); ++j) {
    if (of_root[j].kind != JointKind::rotation) continue;
    pose = kinematics_details::composed(
        pose, Transform<T>{std::nullopt, {{of_root[j].axis, T(cos(joints[j])), T(sin(joints[j]))}}});
  }
  return pose.orientation;
}

/// k |delta|^n sgn(delta) for the exponents that there are. Its derivative is infinite, over intervals, where n is 1.5
/// and delta may be 0. For second derivatives, which |delta| has not everywhere, delta must be positive.
template <class T>
[[nodiscard]] T elastic_force(const T& stiffness, double exponent, const T& penetration) {
  if (exponent == 1.0) return stiffness * penetration;
  if constexpr (requires { abs(penetration); })
    return stiffness * (penetration * sqrt(abs(penetration)));
  else
    return stiffness * (penetration * sqrt(penetration));
}

/// On a cylinder's axis, in the frame of its body; where it is rounded to is part of the model.
template <class T>
[[nodiscard]] Vector3<T> gauss_point(const ContactCylinder& cylinder, std::span<const T> parameters, double side) {
  static const double of_gauss = 1.0 / std::sqrt(3.0);
  Vector3<T> point = values_of(cylinder.centre, parameters);
  for (int k = 0; k < 3; ++k)
    point[k] += T(cylinder.axis[static_cast<std::size_t>(k)] * (side * cylinder.half_length * of_gauss));
  return point;
}

}  // namespace standing_details

template <class T>
struct StandingTerms {
  std::vector<PressedPoint<T>> points;    ///< of the cylinders in their order
  std::vector<VerticalForce<T>> weights;  ///< of the bodies
  VerticalForce<T> applied;
  Vector3<T> reference;    ///< from the root's origin to the reference point, in axes parallel to the world's
  T root_translation;      ///< along y
  std::vector<T> torques;  ///< that hold the joints, 0 for the root's; or empty
};

namespace standing_details {

/// What holds each joint against the forces on the bodies that it carries.
template <class T>
class HoldingTorques {
 public:
  HoldingTorques(const BodyInRoot<T>& body, const Matrix3<T>& turned, const Vector3<T>& reference)
      : body_(body), turned_(turned), reference_(reference), torques_(body.tree.degrees_of_freedom, T(0)) {}

  void add(std::size_t body, const VerticalForce<T>& force) {
    const std::vector<Link<T>>& links = body_.tree.links;
    for (std::size_t i = body_.tree.body_link[body]; i > body_.tree.body_link.front(); i = *links[i].parent) {
      if (links[i].joint != nullptr) torques_[links[i].degree_of_freedom] -= of_joint(i, force);
    }
  }

  [[nodiscard]] const std::vector<T>& torques() const { return torques_; }

 private:
  [[nodiscard]] T of_joint(std::size_t link, const VerticalForce<T>& force) const {
    const Joint& joint = *body_.tree.links[link].joint;
    const BodyPose<T>& pose = body_.links[link];
    const Vector3<T> axis = turned_ * Vector3<T>(pose.orientation.col(joint.axis));
    if (joint.kind == JointKind::translation) return axis[1] * force.upward;
    const Vector3<T> lever = force.place - turned_ * Vector3<T>(pose.position - reference_);
    return (axis[2] * lever[0] - axis[0] * lever[2]) * force.upward;
  }

  const BodyInRoot<T>& body_;
  const Matrix3<T>& turned_;
  const Vector3<T>& reference_;  ///< in the root's frame
  std::vector<T> torques_;
};

}  // namespace standing_details

/// Gravity, the applied force's vertical part and the cylinders act. Preconditions as tree_of; the root is translated
/// before it is turned.
template <class T>
[[nodiscard]] StandingTerms<T> standing_terms(const Model& model, const std::vector<T>& parameters,
                                              const StandingPosture<T>& posture, const std::array<double, 3>& reference,
                                              bool with_torques) {
  using namespace standing_details;
  const BodyInRoot<T> body = body_in_root(model, parameters, posture.joints);
  const Matrix3<T> turned = orientation_of_root(model, posture.joints);
  const Vector3<T> from = exact<T>(reference);
  const auto place = [&](const Vector3<T>& in_root) { return Vector3<T>(turned * Vector3<T>(in_root - from)); };

  StandingTerms<T> terms;
  terms.reference = turned * from;
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const Vector3<T> centre = body.body(i).point(values_of<T>(model.bodies[i].centre_of_mass, parameters));
    terms.weights.push_back({-(T(model.gravity) * value_of<T>(model.bodies[i].mass, parameters)), place(centre)});
  }
  for (const ContactCylinder& cylinder : model.cylinders) {
    const BodyPose<T>& pose = body.body(cylinder.body);
    const Vector3<T> axis = turned * Vector3<T>(pose.orientation * exact<T>(cylinder.axis));
    const T s = sqrt(T(T(1) - square(axis[1])));
    const T radius = value_of<T>(cylinder.radius, parameters);
    const T lean = radius * axis[1] / s;
    const T stiffness = value_of<T>(cylinder.stiffness, parameters) / T(static_cast<double>(points_of_cylinder));
    for (const double side : {-1.0, 1.0}) {
      const Vector3<T> centre = place(pose.point(gauss_point<T>(cylinder, parameters, side)));
      const T penetration = radius * s - (posture.height + centre[1]);
      const Vector3<T> lowest(centre[0] + lean * axis[0], T(centre[1] - radius * s), centre[2] + lean * axis[2]);
      terms.points.push_back({penetration, {elastic_force(stiffness, cylinder.exponent, penetration), lowest}});
    }
  }
  // The applied force acts at the origin, which the root's translations carry along: `offset` before the root's origin.
  const Vector3<T> offset = values_of<T>(model.bodies.front().offset, parameters);
  terms.applied = {value_of<T>(model.applied.force[1], parameters), Vector3<T>(-offset - terms.reference)};
  terms.root_translation = posture.height - terms.reference[1] - offset[1];
  if (!with_torques) return terms;
  HoldingTorques<T> torques(body, turned, from);
  for (std::size_t i = 0; i < terms.weights.size(); ++i) torques.add(i, terms.weights[i]);
  for (std::size_t i = 0; i < terms.points.size(); ++i)
    torques.add(model.cylinders[i / points_of_cylinder].body, terms.points[i].force);
  terms.torques = torques.torques();
  return terms;
}

// What the ground does to the cylinders of a body at rest, over any scalar (docs/stance.md §7).

/// The ground's force at a place on a cylinder's axis, vertical because the bristles of a body at rest are not
/// stretched yet: `upward` times what a newton of it is at the origin of the cylinder's body, in the body's frame. The
/// disc's lowest point lies off its centre along the axis by the radius times the axis's lean; what it lies below the
/// centre is along the force.
template <class T>
struct GroundForce {
  T upward;            ///< N, never below 0
  Force<T> at_centre;  ///< of 1 N at the disc's centre
  Force<T> by_radius;  ///< what the lean adds, by m of radius
};

/// Of half of the stiffness at each of Gauss's two points. Where the axis is exactly level, both are pressed alike: all
/// of it at the middle is the same wrench, and intervals do not take the two forces for different ones. A cylinder
/// whose axis may be vertical divides by 0: std::domain_error over intervals.
template <class T>
[[nodiscard]] std::vector<GroundForce<T>> ground_forces(const ContactCylinder& cylinder, const BodyPose<T>& pose,
                                                        std::span<const T> parameters) {
  const Vector3<T> up = pose.orientation.row(1).transpose();
  const Vector3<T> axis = standing_details::exact<T>(cylinder.axis);
  const T rise = up.dot(axis);
  const bool level = is_zero(rise);
  const std::vector<double> sides = level ? std::vector<double>{0.0} : std::vector<double>{-1.0, 1.0};
  const T s = level ? T(1) : T(sqrt(T(T(1) - square(rise))));
  const T radius = value_of<T>(cylinder.radius, parameters);
  // At rest the damped law is the elastic one, whatever the restitution is.
  const HuntCrossley<T> law{value_of<T>(cylinder.stiffness, parameters) / T(static_cast<double>(sides.size())),
                            cylinder.exponent, T(0), T(1)};
  std::vector<GroundForce<T>> forces;
  for (const double side : sides) {
    const Vector3<T> centre = standing_details::gauss_point<T>(cylinder, parameters, side);
    const T height = pose.position[1] + up.dot(centre);
    forces.push_back({normal_force(law, T(radius * s - height), T(0)),
                      {centre.cross(up), up},
                      {Vector3<T>((rise / s) * Vector3<T>(axis.cross(up))), zero_vector<T>()}});
  }
  return forces;
}

/// Of all cylinders, on the joints: one number each.
template <class T>
[[nodiscard]] std::vector<T> ground_generalised_force(const Model& model, const std::vector<T>& parameters,
                                                      const Tree<T>& tree) {
  const std::vector<BodyPose<T>> poses = forward_kinematics(tree);
  std::vector<T> result(tree.degrees_of_freedom, T(0));
  for (const ContactCylinder& cylinder : model.cylinders) {
    const T radius = value_of<T>(cylinder.radius, std::span<const T>(parameters));
    for (const GroundForce<T>& point : ground_forces<T>(cylinder, poses[cylinder.body], parameters)) {
      const Force<T> unit{point.at_centre.moment + radius * point.by_radius.moment, point.at_centre.force};
      const std::vector<T> part = generalised_force(tree, cylinder.body, unit);
      for (std::size_t i = 0; i < part.size(); ++i) result[i] += point.upward * part[i];
    }
  }
  return result;
}

// A model that is to stand: which of its postures are sought, and with what control.

struct StandingProblem {
  const Model& model;
  JointControl control;
  std::vector<std::uint32_t> parameters;  ///< the uncertain set
  std::vector<double> positions = {};     ///< of all joints in the file
  std::vector<double> stiffness = {};     ///< of all joints, as controllers turn them; 0 where none acts
  std::vector<std::size_t> joints = {};   ///< whose positions are sought: two rotations of the root first
  /// Of the point, in the root's frame, whose height is sought, too: near the cylinders.
  std::array<double, 3> reference = {};
  std::vector<double> start = {};  ///< the file's posture: that height, then the joints
};

/// Throws Error(input) as `equilibrium`.
[[nodiscard]] StandingProblem standing_problem(const Model& model, JointControl control, UncertainSet uncertain);

}  // namespace verisq::stance
