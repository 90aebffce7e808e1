/// Compares files, not names.
#include "host/command_line/overwriting.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <system_error>

#include "host/errors/refusal.hpp"

namespace verisq::command_line {

void refuse_to_overwrite(std::string_view option, const std::string& output, const std::vector<std::string>& inputs) {
  for (const std::string& input : inputs) {
    std::error_code missing;  // a file that does not exist is not overwritten
    if (!input.empty() && std::filesystem::equivalent(input, output, missing)) {
      refuse(fmt::format("{} {}: would overwrite an input", option, output));
    }
  }
}

}  // namespace verisq::command_line
