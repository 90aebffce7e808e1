/// Prints one block a device, or one table of measured accuracy.
#include "host/command_line/devices_command.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>
#include <utility>
#include <vector>
#include <verisq/device.hpp>

namespace verisq::command_line {
namespace {

constexpr const char* closing_words =
    "The self-test runs the device's arithmetic against the host's, rounding error by rounding error. `--device` of\n"
    "`verisq map` takes the index or a part of the name of a device that passed; `--device host` needs none.\n"
    "`--report` prints a Markdown table; the samples are the same at every run. Exit status 1 when a bound is unsound.";

constexpr std::size_t report_samples = 100'000;

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

// ---------------------------------------------------------------- the report

/// One column of the table.
struct Measured {
  std::string name;
  std::vector<FunctionAccuracy> rows;
};

/// A percentage on the terminal's standard error, for what takes more than a second.
class Percentage {
 public:
  explicit Percentage(std::string what) : what_(std::move(what)) {}
  ~Percentage() {
    if (drawn_) fmt::print(stderr, "\r\x1b[K");
  }
  Percentage(const Percentage&) = delete;
  Percentage& operator=(const Percentage&) = delete;

  void operator()(double part) {
    if (isatty(STDERR_FILENO) == 0 || Clock::now() - start_ < std::chrono::seconds(1)) return;
    fmt::print(stderr, "\r\x1b[Kmeasuring {}: {:.0f} %", what_, 100.0 * part);
    std::fflush(stderr);
    drawn_ = true;
  }

 private:
  using Clock = std::chrono::steady_clock;

  std::string what_;
  Clock::time_point start_ = Clock::now();
  bool drawn_ = false;
};

std::vector<Measured> measure(const std::vector<DeviceReport>& devices) {
  std::vector<Measured> measured;
  {
    Percentage percentage("the host");
    measured.push_back({"host", host_accuracy(report_samples, std::ref(percentage))});
  }
  for (const DeviceReport& device : devices) {
    if (!device.passed) continue;
    Percentage percentage(device.name);
    measured.push_back(
        {fmt::format("device {}", device.index), device_accuracy(device.index, report_samples, std::ref(percentage))});
  }
  return measured;
}

std::string units(double worst) {
  if (std::isnan(worst)) return "";
  return fmt::format("{:.{}f}", worst, worst < 100.0 ? 2 : 0);
}

void print_line(const std::string& first, const std::vector<std::string>& cells) {
  fmt::print("| {:<35} |", first);
  for (const std::string& cell : cells) fmt::print(" {:>13} |", cell);
  fmt::print("\n");
}

void print_table(const std::vector<Measured>& measured) {
  std::vector<std::string> header;
  std::vector<std::string> rule;
  for (const Measured& column : measured) {
    header.push_back(column.name + " down");
    header.push_back(column.name + " up");
    rule.insert(rule.end(), 2, "------------:");
  }
  print_line("operation", header);
  print_line("-----------------------------------", rule);
  for (std::size_t row = 0; row < measured.front().rows.size(); ++row) {
    std::vector<std::string> cells;
    for (const Measured& column : measured) {
      cells.push_back(units(column.rows[row].down));
      cells.push_back(units(column.rows[row].up));
    }
    print_line(measured.front().rows[row].function, cells);
  }
}

std::uint64_t unsound(const std::vector<Measured>& measured) {
  std::uint64_t count = 0;
  for (const Measured& column : measured) {
    for (const FunctionAccuracy& row : column.rows) count += row.unsound;
  }
  return count;
}

ExitStatus print_report(const std::vector<DeviceReport>& devices) {
  const std::vector<Measured> measured = measure(devices);
  fmt::print(
      "Largest distance of a bound from the tightest binary64 bound, in units of the exact value's last place (at\n"
      "least 2^-1022), over {} operands a row.\n\n",
      report_samples);
  for (const DeviceReport& device : devices) {
    fmt::print("- device {}: {}, {}, driver {}, {} doubles a work-item{}\n", device.index, device.name, device.platform,
               device.driver, device.vector_width, device.passed ? "" : ": FAILED its self-test, not measured");
  }
  fmt::print("\n");
  print_table(measured);
  const std::uint64_t count = unsound(measured);
  fmt::print("\nUnsound bounds: {}.\n", count);
  return count == 0 ? ExitStatus::verified : ExitStatus::failed;
}

}  // namespace

void declare_devices(Options& options, DevicesArguments& arguments) {
  options.explain(closing_words);
  options.add_flag("--report", arguments.report, "Measure instead how tight every directed operation is, in ulp");
}

ExitStatus run_devices(const DevicesArguments& arguments) {
  const auto devices = test_devices();
  if (arguments.report) return print_report(devices);
  if (devices.empty()) fmt::print("no OpenCL device; verisq map --device host works without one\n");
  for (const auto& device : devices) print(device);
  return ExitStatus::verified;
}

}  // namespace verisq::command_line
