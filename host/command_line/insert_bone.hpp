/// Where bone is, of which an insertion takes some away: from the options and the meshes themselves.
#pragma once

#include <optional>
#include <verisq/removed_volume.hpp>

#include "host/command_line/insert_command.hpp"

namespace verisq::command_line {

/// Throws Error(input) where the options alone contradict each other, or leave open where bone ends.
void check_bone_options(const InsertArguments& arguments);

/// The mesh without what lies beyond the resection. Throws Error(input) where nothing is left.
[[nodiscard]] Mesh before_resection(const InsertArguments& arguments, const Mesh& mesh);

/// Nothing unless --cavity or --bone is given; `mesh` is the whole one. Throws Error(input) for surfaces that are not
/// what the user says.
[[nodiscard]] std::optional<BoneRegion> bone_region(const InsertArguments& arguments, const Mesh& mesh);

}  // namespace verisq::command_line
