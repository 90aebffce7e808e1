/// What `verisq insert` and `verisq-mpi insert` are both about: an implant, a bone, the way into its seat, a tolerance.
#pragma once

#include <optional>
#include <string>
#include <vector>
#include <verisq/insertion.hpp>

#include "host/command_line/options.hpp"

namespace verisq::command_line {

/// As typed.
struct InsertionInputs {
  std::string implant;
  std::optional<Pose> pose;
  std::string mesh;
  std::optional<std::string> poses;  ///< a file, or instead of it:
  std::optional<Point> along;        ///< a direction, with
  std::optional<double> length;
  std::optional<double> turn;  ///< degrees about the direction, on the way
  std::optional<double> tolerance;
};

/// Adds --implant, --pose, --mesh, --poses, --along, --length, --turn and --tol.
void declare_inputs(Options& options, InsertionInputs& inputs);

/// Throws Error(input) where they contradict each other, or leave the way open.
void check_usage(const InsertionInputs& inputs);

/// Throws Error(input) if `output` is one of their files.
void refuse_to_overwrite(const std::string& output, const InsertionInputs& inputs);

/// Precondition: a direction.
[[nodiscard]] WayIn given_way(const InsertionInputs& inputs);

/// Throws Error(input) as `read_poses`.
[[nodiscard]] std::vector<Pose> path_of(const InsertionInputs& inputs, const Model& implant);

/// What --tol says, or its default.
[[nodiscard]] double tolerance_of(const InsertionInputs& inputs, const Model& implant);

}  // namespace verisq::command_line
