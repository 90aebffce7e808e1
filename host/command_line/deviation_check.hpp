/// `verisq check --certificate` of a deviation: proves it again from the distances that the file holds.
#pragma once

#include <verisq/certificate_file.hpp>

#include "host/command_line/check_command.hpp"
#include "host/command_line/exit_status.hpp"

namespace verisq::command_line {

/// Throws Error(input) for what the user can correct, also for other files than those that the answer is about.
ExitStatus run_deviation_check(const DeviationAnswer& answer, const CheckArguments& arguments);

}  // namespace verisq::command_line
