/// The option --pose: a model file read, and moved before anything is asked of it.
#pragma once

#include <optional>
#include <string>
#include <verisq/model.hpp>
#include <verisq/uncertain_model.hpp>

#include "host/command_line/options.hpp"

namespace verisq::command_line {

/// Adds --pose.
void add_pose(Options& options, std::optional<Pose>& pose);

/// The file's model, moved (verisq/posed_model.hpp) where there is a pose. Throws Error(input).
[[nodiscard]] Model read_model_at(const std::optional<Pose>& pose, const std::string& file);

/// Likewise. Throws Error(input) also where the pose would move a translation that is an interval.
[[nodiscard]] UncertainModel read_uncertain_model_at(const std::optional<Pose>& pose, const std::string& file);

}  // namespace verisq::command_line
