/// The cases of a cohort, a row each: what `verisq batch` reads (docs/formats.md §11).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace verisq::command_line {

/// A command line of this program.
struct BatchCase {
  std::string name;                    ///< a part of file names; differs from those of others
  std::string command;                 ///< "map"
  std::vector<std::string> arguments;  ///< as typed behind the command
  bool has_output = false;             ///< one of them is --output
};

/// CSV with a header: `case`, `command` (may be absent: map), and options by their long names without dashes; `a` and
/// `b` are the models of `distance` and `path`. Fields may stand in double quotes. Empty fields and `no` leave an
/// option out, `yes` gives it without a value. Throws Error(input) naming file and line for anything else, for names
/// that are none or appear twice, and for a manifest without cases.
[[nodiscard]] std::vector<BatchCase> read_manifest(const std::filesystem::path& path);

}  // namespace verisq::command_line
