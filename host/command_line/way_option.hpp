/// The way of an implant into its seat: pose by pose from a file, or straight.
#pragma once

#include <optional>
#include <string>
#include <vector>
#include <verisq/insertion.hpp>

#include "host/command_line/options.hpp"

namespace verisq::command_line {

/// As typed.
struct WayArguments {
  std::optional<std::string> poses;  ///< a file, or instead of it:
  std::optional<Point> along;        ///< a direction, with
  std::optional<double> length;
  std::optional<double> turn;  ///< degrees about the direction, on the way
};

/// Adds --poses, --along, --length, --turn.
void declare_way(Options& options, WayArguments& arguments);

/// Throws Error(input) where they contradict each other, or leave the way open.
void check_usage(const WayArguments& arguments);

/// Precondition: a direction.
[[nodiscard]] WayIn given_way(const WayArguments& arguments);

/// Throws Error(input) as `read_poses`.
[[nodiscard]] std::vector<Pose> path_of(const WayArguments& arguments, const Model& implant);

}  // namespace verisq::command_line
