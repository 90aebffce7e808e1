/// `verisq check --certificate` of how good a fit can be at best: proves its bound again.
#pragma once

#include <verisq/certificate_file.hpp>

#include "host/command_line/check_command.hpp"
#include "host/command_line/exit_status.hpp"

namespace verisq::command_line {

/// `verified` only when the bound is proved. Throws Error(input) for what the user can correct, also for other models,
/// or another mesh, than those that the answer is about.
ExitStatus run_best_fit_check(const BestFitAnswer& answer, const CheckArguments& arguments);

}  // namespace verisq::command_line
