/// `verisq check --certificate` of a path: how near two models come while one of them moves, proved again.
#pragma once

#include <verisq/certificate_file.hpp>

#include "host/command_line/check_command.hpp"
#include "host/command_line/exit_status.hpp"

namespace verisq::command_line {

/// `verified` only when every claim is proved, and the smallest distance has an end. Throws Error(input) for what the
/// user can correct, also for other models than those that the answer is about.
ExitStatus run_path_check(const PathAnswer& answer, const CheckArguments& arguments);

}  // namespace verisq::command_line
