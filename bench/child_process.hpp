/// Runs a program and reports what it took: the benchmark of scale measures whole processes.
#pragma once

#include <string>
#include <vector>

namespace verisq::bench {

struct ChildReport {
  int exit_status;
  double seconds;              ///< wall time from start to end
  double peak_resident_bytes;  ///< as the kernel counts it; at least that of the caller when it starts the program
  std::string output;          ///< what the program wrote to its standard output
};

/// `command` is a program's path and its arguments. Throws std::runtime_error when it cannot be started or is killed.
[[nodiscard]] ChildReport run_child(const std::vector<std::string>& command);

}  // namespace verisq::bench
