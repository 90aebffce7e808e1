/// What is written must not be what is read.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace verisq::command_line {

/// Throws Error(input) if `output`, the value of `option`, is one of the files `inputs`, whose empty names are none.
void refuse_to_overwrite(std::string_view option, const std::string& output, const std::vector<std::string>& inputs);

}  // namespace verisq::command_line
