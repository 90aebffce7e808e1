/// The joints of the root tell whether a body can settle on the ground.
#include "verify/equilibrium/standing_model.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <verisq/error.hpp>

namespace verisq::stance {
namespace {

constexpr std::uint8_t vertical = 1;

void require_stand(bool holds, const std::string& message) {
  if (!holds) throw Error(ErrorKind::input, "equilibrium: " + message);
}

}  // namespace

void require_standing_model(const Model& model) {
  require_stand(!model.cylinders.empty(), "the model has no cylinder to stand on");
  const std::vector<Joint>& joints = model.bodies.front().joints;
  std::array<int, 3> turns{};
  int heights = 0;
  bool turned = false;
  for (const Joint& joint : joints) {
    if (joint.kind == JointKind::rotation) ++turns[joint.axis];
    if (joint.kind == JointKind::translation && joint.axis == vertical) ++heights;
    require_stand(joint.kind == JointKind::rotation || !turned,
                  "the root's joint " + joint.name + " is a translation after a rotation");
    turned = turned || joint.kind == JointKind::rotation;
  }
  require_stand(heights == 1 && turns[0] == 1 && turns[2] == 1,
                "the root needs one translation along y and one rotation about each of x and z");
  for (const std::size_t k : {0U, 2U}) {
    const Quantity& force = model.applied.force[k];
    require_stand(force.nominal == 0.0 && force.range == Enclosure{0.0, 0.0},
                  std::string("the applied force has a part along ") + (k == 0 ? "x" : "z") +
                      ", which friction alone could hold: it must be 0");
  }
  for (const Controller& controller : model.controllers)
    require_stand(controller.body != 0, "the root has a controller, and nothing to push against");
}

std::vector<std::size_t> sought_joints(const Model& model, JointControl control) {
  std::vector<std::size_t> sought;
  const std::vector<Joint>& root = model.bodies.front().joints;
  for (std::size_t i = 0; i < root.size(); ++i) {
    if (root[i].kind == JointKind::rotation && root[i].axis != vertical) sought.push_back(i);
  }
  if (control == JointControl::held) return sought;
  for (std::size_t i = root.size(); i < model.degrees_of_freedom(); ++i) sought.push_back(i);
  return sought;
}

std::size_t height_of_root(const Model& model) {
  const auto up = [](const Joint& joint) { return joint.kind == JointKind::translation && joint.axis == vertical; };
  const std::vector<Joint>& joints = model.bodies.front().joints;
  return static_cast<std::size_t>(std::ranges::find_if(joints, up) - joints.begin());
}

std::vector<double> stiffness_of_joints(const Model& model) {
  std::vector<double> result(model.degrees_of_freedom(), 0.0);
  for (const Controller& controller : model.controllers)
    result[joint_index(model, controller.body, controller.joint)] = controller.proportional;
  return result;
}

std::size_t joint_index(const Model& model, std::size_t body, std::size_t joint) {
  for (std::size_t i = 0; i < body; ++i) joint += model.bodies[i].joints.size();
  return joint;
}

}  // namespace verisq::stance
