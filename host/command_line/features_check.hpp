/// `verisq check --certificate` of a femur's features: encloses them once more, at 127 bits.
#pragma once

#include <verisq/certificate_file.hpp>

#include "host/command_line/check_command.hpp"
#include "host/command_line/exit_status.hpp"

namespace verisq::command_line {

/// Throws Error(input) for what the user can correct, also for other files than those that the answer is about, where
/// some are given.
ExitStatus run_features_check(const FeaturesAnswer& answer, const CheckArguments& arguments);

}  // namespace verisq::command_line
