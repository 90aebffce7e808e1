/// What is asked of a fit, from the options and files of the user.
#pragma once

#include <verisq/fit_problem.hpp>

#include "host/command_line/fit_command.hpp"

namespace verisq::command_line {

/// Throws Error(input) naming file or option, key and value.
[[nodiscard]] FitRequest read_fit_request(const FitArguments& arguments);

}  // namespace verisq::command_line
