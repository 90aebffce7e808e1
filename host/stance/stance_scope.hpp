/// What acts in an analysis of a stance model, and what of the model does not: for everyone who reads its results.
#pragma once

#include <string>
#include <vector>
#include <verisq/stance_equilibrium.hpp>
#include <verisq/stance_motion.hpp>

namespace verisq::stance {

struct Scope {
  std::string meaning;  ///< of the results, in one sentence
  std::vector<std::string> acts;
  std::vector<std::string> does_not_act;
  std::vector<std::string> parameters_without_effect;  ///< names; of all parameters of the model, uncertain or not
};

/// Also of the sensitivities. Parameters without effect are those whose derivatives are proven to be 0 over the box.
[[nodiscard]] Scope wrench_scope(const Model& model, UncertainSet uncertain, Mode mode);

[[nodiscard]] Scope acceleration_scope(const Model& model, AccelerationCase at);

[[nodiscard]] Scope equilibrium_scope(const Model& model, JointControl control);

[[nodiscard]] Scope stability_scope(const Model& model, JointControl control);
/// Of the motion in the sagittal plane.
[[nodiscard]] Scope motion_scope(const Model& model, const MotionOptions& options);

/// Of the drop of one of the model's cylinders.
[[nodiscard]] Scope bounce_scope(const Model& model, const ContactCylinder& cylinder);

}  // namespace verisq::stance
