/// A stance model as Featherstone's tree: one link a degree of freedom, massless but for the last of each body.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "verify/stance/parameters.hpp"
#include "verify/stance/spatial.hpp"

namespace verisq::stance {

/// Of all joints: the bodies' in their order, each body's in its order. m and m/s, or rad and rad/s.
template <class T>
struct State {
  std::vector<T> position, velocity;
};

/// The stance that is analysed.
template <class T>
[[nodiscard]] State<T> stance_state(const Model& model) {
  State<T> state;
  for (const Body& body : model.bodies) {
    for (const Joint& joint : body.joints) {
      state.position.push_back(T(joint.position));
      state.velocity.push_back(T(joint.velocity));
    }
  }
  return state;
}

/// At the same position, without velocity.
template <class T>
[[nodiscard]] State<T> at_rest(const State<T>& state) {
  return {state.position, std::vector<T>(state.velocity.size(), T(0))};
}

template <class T>
[[nodiscard]] Vector3<T> values_of(const QuantityVector& quantities, std::span<const T> parameters) {
  return {value_of(quantities[0], parameters), value_of(quantities[1], parameters),
          value_of(quantities[2], parameters)};
}

/// A frame that one joint moves against its parent's. Only a body without joints makes a link without one.
template <class T>
struct Link {
  std::optional<std::size_t> parent = {};  ///< smaller than this link's index; none: the world
  const Joint* joint = nullptr;            ///< of the model
  std::size_t degree_of_freedom = 0;       ///< index in State, where there is a joint
  Transform<T> transform = {};             ///< from the parent's frame
  Inertia<T> inertia = {};

  /// The joint's own motion at a rate, in this link's frame: Featherstone's S times the rate. Needs a joint.
  [[nodiscard]] SpatialMotion<T> joint_motion(const T& rate) const {
    SpatialMotion<T> motion;
    (joint->kind == JointKind::rotation ? motion.angular : motion.linear)[joint->axis] = rate;
    return motion;
  }

  /// The transpose of S times f. Needs a joint.
  [[nodiscard]] T joint_force(const Force<T>& f) const {
    return (joint->kind == JointKind::rotation ? f.moment : f.force)[joint->axis];
  }
};

template <class T>
struct Tree {
  std::vector<Link<T>> links;          ///< parents before children
  std::vector<std::size_t> body_link;  ///< the link whose frame is the body's
  std::size_t degrees_of_freedom = 0;
};

namespace tree_details {

/// By `offset`, where there is one, and then along or about the joint's axis.
template <class T>
[[nodiscard]] Transform<T> joint_transform(const std::optional<Vector3<T>>& offset, const Joint& joint,
                                           const T& position) {
  if (joint.kind == JointKind::rotation) return {offset, {{joint.axis, cos(position), sin(position)}}};
  Vector3<T> shift = offset.value_or(zero_vector<T>());
  shift[joint.axis] += position;
  return {shift, {}};
}

}  // namespace tree_details

/// The tree at a position. Preconditions: as many parameters as the model has, as many positions as it has joints. The
/// model must outlive the tree.
template <class T>
[[nodiscard]] Tree<T> tree_of(const Model& model, std::span<const T> parameters, const std::vector<T>& position) {
  Tree<T> tree;
  for (const Body& body : model.bodies) {
    std::optional<std::size_t> parent;
    if (body.parent) parent = tree.body_link[*body.parent];
    std::optional<Vector3<T>> offset = values_of(body.offset, parameters);
    for (const Joint& joint : body.joints) {
      const std::size_t index = tree.degrees_of_freedom++;
      tree.links.push_back({parent, &joint, index, tree_details::joint_transform(offset, joint, position[index]), {}});
      parent = tree.links.size() - 1;
      offset.reset();  // the frames of a body's joints follow each other
    }
    if (body.joints.empty()) tree.links.push_back({parent, nullptr, 0, {offset, {}}, {}});
    tree.body_link.push_back(tree.links.size() - 1);
    tree.links.back().inertia =
        Inertia<T>::of_body(value_of(body.mass, parameters), values_of(body.centre_of_mass, parameters),
                            values_of(body.inertia, parameters));
  }
  return tree;
}

}  // namespace verisq::stance
