/// The tree of a body's segments, and its spatial vectors.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>
#include <verisq/stance.hpp>

#include "verify/numbers/interval.hpp"
#include "verify/stance/scalar.hpp"

namespace verisq::stance {

// Values of a stance model's parameters: nominal, over the box of an uncertain set, and as variables to differentiate
// by.

/// The parameter's value where `quantity` is a parameter, and the nominal number elsewhere.
template <class T>
[[nodiscard]] T value_of(const Quantity& quantity, std::span<const T> parameters) {
  return quantity.parameter ? parameters[*quantity.parameter] : T(quantity.nominal);
}

/// As many as the model has parameters, in their order.
template <class T>
[[nodiscard]] std::vector<T> nominal_parameters(const Model& model) {
  std::vector<T> values;
  values.reserve(model.parameters.size());
  for (const Parameter& parameter : model.parameters) values.push_back(T(parameter.nominal));
  return values;
}

/// The whole range of each uncertain parameter, the nominal value of all others.
[[nodiscard]] inline std::vector<verify::Interval> parameter_box(const Model& model, UncertainSet uncertain) {
  std::vector<verify::Interval> box = nominal_parameters<verify::Interval>(model);
  for (const std::uint32_t i : uncertain) {
    const Enclosure& range = model.parameters[i].range;
    box[i] = verify::Interval(range.lo, range.hi);
  }
  return box;
}

/// The values, as functions of N of themselves: partial derivative k is by the parameter variables[k].
template <std::size_t N, class T>
[[nodiscard]] std::vector<Dual<T, N>> as_variables(std::span<const T> values,
                                                   const std::array<std::uint32_t, N>& variables) {
  std::vector<Dual<T, N>> result(values.begin(), values.end());
  for (std::size_t k = 0; k < N; ++k) result[variables[k]].partial[k] = T(1);
  return result;
}

// Spatial vectors, rigid-body inertia and the transforms of one-degree-of-freedom joints, over any scalar
// (Featherstone, Rigid Body Dynamics Algorithms, chapter 2).

template <class T>
using Vector3 = Eigen::Matrix<T, 3, 1>;
template <class T>
using Matrix3 = Eigen::Matrix<T, 3, 3>;

template <class T>
[[nodiscard]] Vector3<T> zero_vector() {
  return {T(0), T(0), T(0)};
}

/// Featherstone's spatial motion vector, a velocity or acceleration: of the body's rotation, and of the point of it at
/// the frame's origin.
template <class T>
struct SpatialMotion {
  Vector3<T> angular = zero_vector<T>();
  Vector3<T> linear = zero_vector<T>();

  friend SpatialMotion operator+(const SpatialMotion& a, const SpatialMotion& b) {
    return {a.angular + b.angular, a.linear + b.linear};
  }
};

/// A wrench: its moment about the frame's origin, and its force.
template <class T>
struct Force {
  Vector3<T> moment = zero_vector<T>();
  Vector3<T> force = zero_vector<T>();

  friend Force operator+(const Force& a, const Force& b) { return {a.moment + b.moment, a.force + b.force}; }
};

/// Featherstone's v x m: the derivative of m where its frame moves with v.
template <class T>
[[nodiscard]] SpatialMotion<T> cross(const SpatialMotion<T>& v, const SpatialMotion<T>& m) {
  return {v.angular.cross(m.angular), v.angular.cross(m.linear) + v.linear.cross(m.angular)};
}

/// Featherstone's v x* f.
template <class T>
[[nodiscard]] Force<T> cross(const SpatialMotion<T>& v, const Force<T>& f) {
  return {v.angular.cross(f.moment) + v.linear.cross(f.force), v.angular.cross(f.force)};
}

/// Ten numbers about the frame's origin, not about the centre of mass: a body's parameter then occurs once in every
/// entry of the mass matrix that is linear in it, and no interval is divided by the mass (docs/stance.md §3).
template <class T>
struct Inertia {
  T mass = T(0);
  Vector3<T> first_moment = zero_vector<T>();          ///< mass times centre of mass
  Matrix3<T> rotational = Matrix3<T>::Constant(T(0));  ///< about the origin; symmetric

  /// Principal moments are about the centre of mass, in axes parallel to the frame's.
  static Inertia of_body(const T& mass, const Vector3<T>& centre, const Vector3<T>& principal) {
    const Vector3<T> squares(square(centre[0]), square(centre[1]), square(centre[2]));
    Inertia result{mass, Vector3<T>(mass * centre[0], mass * centre[1], mass * centre[2])};
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      const int k = (i + 2) % 3;
      result.rotational(i, i) = principal[i] + mass * (squares[j] + squares[k]);
      result.rotational(j, k) = result.rotational(k, j) = -(mass * (centre[j] * centre[k]));
    }
    return result;
  }

  friend Inertia operator+(const Inertia& a, const Inertia& b) {
    return {a.mass + b.mass, a.first_moment + b.first_moment, a.rotational + b.rotational};
  }

  friend Force<T> operator*(const Inertia& inertia, const SpatialMotion<T>& m) {
    return {inertia.rotational * m.angular + inertia.first_moment.cross(m.linear),
            inertia.mass * m.linear + m.angular.cross(inertia.first_moment)};
  }
};

/// From a parent's frame to that of its child: the origin moves by `shift`, then the axes turn about one of them.
/// Absent steps cost nothing and widen nothing.
template <class T>
struct Transform {
  struct Turn {
    std::uint8_t axis;
    T cosine, sine;
  };
  std::optional<Vector3<T>> shift = {};  ///< in the parent's axes
  std::optional<Turn> turn = {};

  /// A free vector's coordinates.
  [[nodiscard]] Vector3<T> to_child(const Vector3<T>& v) const { return turned(v, true); }
  [[nodiscard]] Vector3<T> to_parent(const Vector3<T>& v) const { return turned(v, false); }

  [[nodiscard]] SpatialMotion<T> to_child(const SpatialMotion<T>& m) const {
    const Vector3<T> linear = shift ? Vector3<T>(m.linear + m.angular.cross(*shift)) : m.linear;
    return {to_child(m.angular), to_child(linear)};
  }

  [[nodiscard]] Force<T> to_parent(const Force<T>& f) const {
    Force<T> result{to_parent(f.moment), to_parent(f.force)};
    if (shift) result.moment += shift->cross(result.force);
    return result;
  }

  [[nodiscard]] Inertia<T> to_parent(const Inertia<T>& inertia) const {
    Inertia<T> result{inertia.mass, to_parent(inertia.first_moment), inertia.rotational};
    if (turn) {
      for (int j = 0; j < 3; ++j) result.rotational.col(j) = to_parent(Vector3<T>(result.rotational.col(j)));
      for (int i = 0; i < 3; ++i) {
        result.rotational.row(i) = to_parent(Vector3<T>(result.rotational.row(i).transpose())).transpose();
      }
    }
    return shift ? shifted(result, *shift) : result;
  }

 private:
  [[nodiscard]] Vector3<T> turned(const Vector3<T>& v, bool to_child) const {
    if (!turn) return v;
    const int j = (turn->axis + 1) % 3;
    const int k = (turn->axis + 2) % 3;
    const T sine = to_child ? turn->sine : T(-turn->sine);
    Vector3<T> result = v;
    result[j] = turn->cosine * v[j] + sine * v[k];
    result[k] = turn->cosine * v[k] - sine * v[j];
    return result;
  }

  /// The inertia about a point from which the origin lies at r: I - [r][h] - [h + m r][r] with [.] the cross product's
  /// matrices.
  static Inertia<T> shifted(const Inertia<T>& inertia, const Vector3<T>& r) {
    const Vector3<T> moment = inertia.first_moment + inertia.mass * r;
    Inertia<T> result{inertia.mass, moment, inertia.rotational};
    const Vector3<T> sum = inertia.first_moment + moment;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      const int k = (i + 2) % 3;
      result.rotational(i, i) += r[j] * sum[j] + r[k] * sum[k];
      const T product = r[j] * inertia.first_moment[k] + r[k] * moment[j];
      result.rotational(j, k) -= product;
      result.rotational(k, j) = result.rotational(j, k);
    }
    return result;
  }
};

// A stance model as Featherstone's tree: one link a degree of freedom, massless but for the last of each body.

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
