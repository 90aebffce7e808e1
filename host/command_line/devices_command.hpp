/// `verisq devices`: every OpenCL device, with the outcome of its self-test; `--report` measures their accuracy.
#pragma once

#include "host/command_line/exit_status.hpp"

namespace CLI {
class App;
}

namespace verisq::command_line {

struct DevicesArguments {
  bool report = false;
};

/// Declares the command; parsing fills `arguments`, which must live as long.
void declare_devices(CLI::App& program, DevicesArguments& arguments);
[[nodiscard]] ExitStatus run_devices(const DevicesArguments& arguments);

}  // namespace verisq::command_line
