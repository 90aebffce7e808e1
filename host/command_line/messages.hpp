/// What a running command tells its user on the standard error.
#pragma once

#include <string>
#include <string_view>

namespace verisq::command_line {

/// One line.
void tell(std::string_view message);

/// Why another device, or none, did the work; empty: nothing to tell.
void tell_notice(const std::string& notice);

}  // namespace verisq::command_line
