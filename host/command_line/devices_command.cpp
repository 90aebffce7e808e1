/// Prints one block a device.
#include "host/command_line/devices_command.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <verisq/device.hpp>

namespace verisq::command_line {
namespace {

constexpr const char* closing_words =
    "The self-test runs the device's arithmetic against the host's, rounding error by rounding error. `--device` of\n"
    "`verisq map` takes the index or a part of the name of a device that passed; `--device host` needs none.";

void print(const DeviceReport& device) {
  fmt::print("{}  {}\n", device.index, device.name);
  fmt::print("   platform   {}\n   driver     {}\n   width      {} doubles a work-item\n", device.platform,
             device.driver, device.vector_width);
  if (device.passed) {
    fmt::print("   self-test  passed\n");
  } else {
    fmt::print("   self-test  FAILED: {}\n", device.failure);
  }
}

}  // namespace

void declare_devices(CLI::App& program) {
  program.add_subcommand("devices", "List every OpenCL device and the outcome of its self-test")->footer(closing_words);
}

ExitStatus run_devices() {
  const auto devices = test_devices();
  if (devices.empty()) fmt::print("no OpenCL device; verisq map --device host works without one\n");
  for (const auto& device : devices) print(device);
  return ExitStatus::verified;
}

}  // namespace verisq::command_line
