/// What an analysis takes of a stance model, chosen by name: uncertain parameters, a cylinder to be dropped.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>
#include <verisq/stance_analysis.hpp>
#include <verisq/stance_bounce.hpp>
#include <verisq/stance_model.hpp>

namespace verisq::stance {

/// All parameters that have a deviation: of the others nothing is uncertain.
[[nodiscard]] std::vector<std::uint32_t> uncertain_parameters(const Model& model);

/// Those of these names, in the model's order. Throws Error(input) that names `verisq stance --uncertain` for a name
/// that the model does not have, or twice.
[[nodiscard]] std::vector<std::uint32_t> uncertain_parameters(const Model& model, std::span<const std::string> names);

/// `refusal` is the message of the Error(input) for a name that the model does not have, with {} for the name and for
/// those that there are.
[[nodiscard]] std::uint32_t parameter_named(const Model& model, const std::string& name, const std::string& refusal);

/// The model with a part of a parameter's range, in which a nominal value that lies outside becomes the midpoint.
/// Throws Error(input) for a range that is no part of the parameter's.
[[nodiscard]] Model narrowed(Model model, std::uint32_t parameter, const Enclosure& range);

/// Of each uncertain parameter the part of its range that is at most `per_cent` of the nominal value off it, rounded
/// outward. Throws Error(input) for a nominal value of 0, which has no parts.
[[nodiscard]] Model narrowed_within(Model model, UncertainSet uncertain, double per_cent);

/// Throws Error(input) for a name that no cylinder has.
[[nodiscard]] const ContactCylinder& cylinder_of(const Model& model, const std::string& name);

/// The cylinder alone, with the mass of its body, from `height` (m, above 0): its numbers take their whole range where
/// they are uncertain. Throws Error(input) where its stiffness is: a drop has an exact one.
[[nodiscard]] Drop drop_of(const Model& model, const ContactCylinder& cylinder, UncertainSet uncertain, double height);

/// The joint of that name at a position. Throws Error(input), naming `verisq stance --joint`, for a name that no joint
/// has.
[[nodiscard]] JointPosition joint_position(const Model& model, const std::string& name, double position);

}  // namespace verisq::stance
