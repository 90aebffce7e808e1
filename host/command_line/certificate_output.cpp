/// Tries to write where nothing is to be written yet.
#include "host/command_line/certificate_output.hpp"

#include <fmt/core.h>

#include <filesystem>

#include "host/command_line/overwriting.hpp"
#include "host/errors/refusal.hpp"
#include "host/files/output_file.hpp"

namespace verisq::command_line {

void check_certificate_file(const std::string& file, const std::vector<std::string>& inputs, const char* option) {
  if (file.empty()) return;
  if (std::filesystem::path(file).extension() != ".json") refuse(fmt::format("{} {}: is a .json", option, file));
  refuse_to_overwrite(option, file, inputs);
  const OutputFile trial(file);  // leaves nothing behind
}

}  // namespace verisq::command_line
