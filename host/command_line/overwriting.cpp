/// Compares files, not names.
#include "host/command_line/overwriting.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "host/errors/refusal.hpp"
#include "host/files/through_links.hpp"

namespace verisq::command_line {

void refuse_to_overwrite(std::string_view option, const std::string& output, const std::vector<std::string>& inputs) {
  for (const std::string& input : inputs) {
    std::error_code missing;  // a file that does not exist is not overwritten
    if (!input.empty() && std::filesystem::equivalent(input, output, missing)) {
      refuse(fmt::format("{} {}: would overwrite an input", option, output));
    }
  }
}

void refuse_one_file_twice(const std::vector<std::string>& outputs) {
  std::vector<std::filesystem::path> files;
  for (const std::string& output : outputs) {
    if (output.empty()) continue;
    files.push_back(std::filesystem::weakly_canonical(std::filesystem::absolute(through_links(output))));
    if (std::ranges::count(files, files.back()) > 1) refuse(fmt::format("{}: is the name of two outputs", output));
  }
}

}  // namespace verisq::command_line
