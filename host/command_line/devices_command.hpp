/// `verisq devices`: every OpenCL device, with the outcome of its self-test.
#pragma once

#include "host/command_line/exit_status.hpp"

namespace CLI {
class App;
}

namespace verisq::command_line {

void declare_devices(CLI::App& program);
ExitStatus run_devices();

}  // namespace verisq::command_line
