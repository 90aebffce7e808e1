/// Runs a program and reports what it took and said.
#pragma once

#include <string>
#include <vector>

namespace verisq::bench {

struct ChildReport {
  int exit_status;
  double seconds;              ///< wall time from start to end
  double peak_resident_bytes;  ///< as the kernel counts it; at least that of the caller when it starts the program
  std::string output;          ///< what the program wrote
};

/// What of a program's words is reported; the rest goes where the caller's goes.
enum class Captured { output, output_and_errors };

/// `command` is a program's path and its arguments. Throws std::runtime_error when it cannot be started or is killed.
[[nodiscard]] ChildReport run_child(const std::vector<std::string>& command, Captured captured = Captured::output);

}  // namespace verisq::bench
