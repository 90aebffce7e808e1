/// `verisq check --certificate` of areas in contact: proves each of them again.
#pragma once

#include <verisq/certificate_file.hpp>

#include "host/command_line/check_command.hpp"
#include "host/command_line/exit_status.hpp"

namespace verisq::command_line {

/// `verified` only when every claim is proved. Throws Error(input) for what the user can correct, also for another
/// model or mesh than the answer is about.
ExitStatus run_contact_check(const ContactAnswer& answer, const CheckArguments& arguments);

}  // namespace verisq::command_line
