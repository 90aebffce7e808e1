/// `verisq devices`: every OpenCL device, with the outcome of its self-test; `--report` measures their accuracy.
#pragma once

#include "host/command_line/exit_status.hpp"
#include "host/command_line/options.hpp"

namespace verisq::command_line {

struct DevicesArguments {
  bool report = false;
};

void declare_devices(Options& options, DevicesArguments& arguments);
[[nodiscard]] ExitStatus run_devices(const DevicesArguments& arguments);

}  // namespace verisq::command_line
