/// What is written must not be what is read.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace verisq::command_line {

/// Throws Error(input) if `output`, the value of `option`, is one of the files `inputs`, whose empty names are none.
void refuse_to_overwrite(std::string_view option, const std::string& output, const std::vector<std::string>& inputs);

/// Throws Error(input) where two of these outputs, whose empty names are none, would be one file: by links, too.
void refuse_one_file_twice(const std::vector<std::string>& outputs);

}  // namespace verisq::command_line
