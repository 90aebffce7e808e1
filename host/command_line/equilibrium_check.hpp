/// `verisq check --certificate` of where a body stands still: proves it once more, at 127 bits.
#pragma once

#include <verisq/certificate_file.hpp>

#include "host/command_line/check_command.hpp"
#include "host/command_line/exit_status.hpp"

namespace verisq::command_line {

/// Throws Error(input) for what the user can correct, also for another model than the one that the answer is about.
ExitStatus run_equilibrium_check(const EquilibriumAnswer& answer, const CheckArguments& arguments);

}  // namespace verisq::command_line
