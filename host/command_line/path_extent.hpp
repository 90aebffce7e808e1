/// How far a path of poses leads, and what is to be seen of it.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <verisq/model.hpp>

namespace verisq::command_line {

/// Of the moving origin, about: for people.
[[nodiscard]] double length_of(std::span<const Pose> path);

/// Of all its turns, about: for people.
[[nodiscard]] double degrees_of(std::span<const Pose> path);

/// Begin, end, number of poses, length and turning: a line each, under "the `way` begins at". `of_what` moves.
/// Precondition: not empty; `units` empty, or after a space.
[[nodiscard]] std::string path_in_words(std::span<const Pose> path, std::string_view way, std::string_view of_what,
                                        std::string_view units);

}  // namespace verisq::command_line
