/// What a model must be to stand, and the posture next to which it is sought.
#include "verify/stance/standing_problem.hpp"

#include <fmt/core.h>

#include <verisq/error.hpp>

#include "verify/stance/standing_equations.hpp"

namespace verisq::stance {
namespace {

constexpr std::uint8_t vertical = 1;

/// In the root's frame.
std::array<double, 3> mean_point_of_contact(const Model& model, const std::vector<double>& joints) {
  const StandingTerms<double> terms =
      standing_terms<double>(model, nominal_parameters<double>(model), {0.0, joints}, {}, false);
  Vector3<double> sum = zero_vector<double>();
  for (const PressedPoint<double>& point : terms.points) sum += point.force.place;
  const Vector3<double> in_root = standing_details::orientation_of_root(model, joints).transpose() * sum;
  const auto count = static_cast<double>(terms.points.size());
  return {in_root[0] / count, in_root[1] / count, in_root[2] / count};
}

void require_stand(bool holds, const std::string& message) {
  if (!holds) throw Error(ErrorKind::input, message);
}

void check_model(const Model& model) {
  require_stand(!model.cylinders.empty(), "equilibrium: the model has no cylinder to stand on");
  const std::vector<Joint>& joints = model.bodies.front().joints;
  std::array<int, 3> turns{};
  int heights = 0;
  bool turned = false;
  for (const Joint& joint : joints) {
    if (joint.kind == JointKind::rotation) ++turns[joint.axis];
    if (joint.kind == JointKind::translation && joint.axis == vertical) ++heights;
    require_stand(joint.kind == JointKind::rotation || !turned,
                  fmt::format("equilibrium: the root's joint {} is a translation after a rotation", joint.name));
    turned = turned || joint.kind == JointKind::rotation;
  }
  require_stand(heights == 1 && turns[0] == 1 && turns[2] == 1,
                "equilibrium: the root needs one translation along y and one rotation about each of x and z");
  for (const int k : {0, 2}) {
    const Quantity& force = model.applied.force[static_cast<std::size_t>(k)];
    require_stand(force.nominal == 0.0 && force.range == Enclosure{0.0, 0.0},
                  fmt::format("equilibrium: the applied force has a part along {}, which friction alone could hold: "
                              "it must be 0",
                              k == 0 ? "x" : "z"));
  }
  for (const Controller& controller : model.controllers)
    require_stand(controller.body != 0, "equilibrium: the root has a controller, and nothing to push against");
}

/// 0 where none acts.
std::vector<double> stiffness_of_joints(const Model& model) {
  std::vector<double> result(model.degrees_of_freedom(), 0.0);
  for (const Controller& controller : model.controllers)
    result[joint_index(model, controller.body, controller.joint)] = controller.proportional;
  return result;
}

}  // namespace

std::size_t joint_index(const Model& model, std::size_t body, std::size_t joint) {
  for (std::size_t i = 0; i < body; ++i) joint += model.bodies[i].joints.size();
  return joint;
}

StandingProblem standing_problem(const Model& model, JointControl control, UncertainSet uncertain) {
  check_model(model);
  StandingProblem problem{.model = model,
                          .control = control,
                          .parameters = {uncertain.begin(), uncertain.end()},
                          .positions = stance_state<double>(model).position,
                          .stiffness = stiffness_of_joints(model)};
  const std::vector<Joint>& root = model.bodies.front().joints;
  double height = 0.0;  // of the root, by its translation in the file
  for (std::size_t i = 0; i < root.size(); ++i) {
    if (root[i].kind == JointKind::rotation && root[i].axis != vertical) problem.joints.push_back(i);
    if (root[i].kind == JointKind::translation && root[i].axis == vertical) height = root[i].position;
  }
  if (control == JointControl::proportional) {
    for (std::size_t i = root.size(); i < model.degrees_of_freedom(); ++i) problem.joints.push_back(i);
  }
  problem.reference = mean_point_of_contact(model, problem.positions);
  const StandingTerms<double> terms = standing_terms<double>(model, nominal_parameters<double>(model),
                                                             {0.0, problem.positions}, problem.reference, false);
  problem.start.push_back(height - terms.root_translation);
  for (const std::size_t joint : problem.joints) problem.start.push_back(problem.positions[joint]);
  return problem;
}

}  // namespace verisq::stance
