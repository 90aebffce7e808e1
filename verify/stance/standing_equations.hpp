/// The balance of forces of a body at rest on the ground, over any scalar (docs/stance.md §7).
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "verify/equilibrium/standing_model.hpp"
#include "verify/stance/kinematics.hpp"

namespace verisq::stance {

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

}  // namespace verisq::stance
