/// `verisq check --certificate` of a fit: every distance proved, and then what they say together.
#pragma once

#include <verisq/certificate_file.hpp>

#include "host/command_line/check_command.hpp"
#include "host/command_line/exit_status.hpp"

namespace verisq::command_line {

/// `verified` only when every distance and every claim is proved. Throws Error(input) for what the user can correct,
/// also for another model or mesh than those that the answer is about.
ExitStatus run_fit_check(const FitAnswer& answer, const CheckArguments& arguments);

}  // namespace verisq::command_line
