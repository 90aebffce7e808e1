/// `verisq check --certificate` of a way in: the smallest distance of every vertex along it proved again.
#pragma once

#include <verisq/certificate_file.hpp>

#include "host/command_line/check_command.hpp"
#include "host/command_line/exit_status.hpp"

namespace verisq::command_line {

/// `verified` only when every distance is proved, and claimed on both sides. Throws Error(input) for what the user can
/// correct, also for another model or mesh than those that the answer is about.
ExitStatus run_insertion_check(const InsertionAnswer& answer, const CheckArguments& arguments);

}  // namespace verisq::command_line
