/// The sagittal model of a body.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>
#include <verisq/stance.hpp>

namespace verisq::stance {

/// Along x or y, or about z.
struct SagittalJoint {
  std::string name;           ///< "pelvis rz"; of a pair without its side: "femur rz"
  double wanted;              ///< the file's position, m or rad
  double proportional = 0.0;  ///< of the controllers of all bodies that this one stands for together
  double integral = 0.0;
  double derivative = 0.0;
  std::vector<std::size_t> joints;  ///< of the model, bodies in order, one of each body
};

/// One body in the plane of symmetry, or a pair beside it that moves alike and counts twice.
struct SagittalBody {
  std::uint32_t body;                     ///< of the model, the first of a pair
  std::optional<std::size_t> parent;      ///< index in SagittalModel::bodies
  double copies;                          ///< 1 or 2
  std::optional<std::size_t> joint = {};  ///< that turns it, index in SagittalModel::joints
};

struct SagittalContact {
  std::uint32_t cylinder;  ///< of the model, the first of a pair
  std::string name;        ///< of a pair without its side
  std::size_t body;        ///< index in SagittalModel::bodies
};

/// The root is translated along x, then y (joints 0 and 1), and turned with all others.
struct SagittalModel {
  const Model& model;
  std::vector<SagittalBody> bodies;  ///< parents first
  std::vector<SagittalJoint> joints;
  std::vector<SagittalContact> contacts;
};

/// A motion that starts symmetric, at rest in all joints across the plane, stays so, by uniqueness: the mirror image of
/// a solution is one. Each leg must lie in a plane of its own, or forces would turn it out of it. Throws Error(input)
/// for a model, or a parameter of the uncertain set, that is not mirror-symmetric in this sense, and for joints that
/// the plane does not have. The model must outlive the result.
[[nodiscard]] SagittalModel sagittal_model(const Model& model, UncertainSet uncertain);

}  // namespace verisq::stance
