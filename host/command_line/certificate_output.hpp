/// The option --certificate-file, and others like it.
#pragma once

#include <string>
#include <vector>

namespace verisq::command_line {

/// Its value, empty where it is not given: throws Error(input) unless it is a .json that is none of the inputs,
/// Error(failure) where it cannot be written: known before all the work, not after it.
void check_certificate_file(const std::string& file, const std::vector<std::string>& inputs,
                            const char* option = "--certificate-file");

}  // namespace verisq::command_line
