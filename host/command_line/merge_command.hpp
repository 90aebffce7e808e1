/// `verisq merge`: the whole of a map whose parts several processes made.
#pragma once

#include <string>
#include <vector>

#include "host/command_line/exit_status.hpp"
#include "host/command_line/options.hpp"

namespace verisq::command_line {

struct MergeArguments {
  std::vector<std::string> parts;
  std::string output;
  bool mixed_devices = false;
  bool json = false;
};

void declare_merge(Options& options, MergeArguments& arguments);

/// The status of the whole map. Throws Error(input) for parts that do not belong together.
ExitStatus run_merge(const MergeArguments& arguments);

}  // namespace verisq::command_line
