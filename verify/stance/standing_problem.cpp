/// What a model must be to stand, and the posture next to which it is sought.
#include "verify/stance/standing_problem.hpp"

#include "verify/equilibrium/standing_model.hpp"
#include "verify/stance/standing_equations.hpp"

namespace verisq::stance {
namespace {

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

}  // namespace

StandingProblem standing_problem(const Model& model, JointControl control, UncertainSet uncertain) {
  require_standing_model(model);
  StandingProblem problem{.model = model,
                          .control = control,
                          .parameters = {uncertain.begin(), uncertain.end()},
                          .positions = stance_state<double>(model).position,
                          .stiffness = stiffness_of_joints(model)};
  const double height = model.bodies.front().joints[height_of_root(model)].position;
  problem.joints = sought_joints(model, control);
  problem.reference = mean_point_of_contact(model, problem.positions);
  const StandingTerms<double> terms = standing_terms<double>(model, nominal_parameters<double>(model),
                                                             {0.0, problem.positions}, problem.reference, false);
  problem.start.push_back(height - terms.root_translation);
  for (const std::size_t joint : problem.joints) problem.start.push_back(problem.positions[joint]);
  return problem;
}

}  // namespace verisq::stance
