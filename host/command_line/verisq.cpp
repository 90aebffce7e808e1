/// The program `verisq`: the table of all commands, one of which it runs; the output of `devices` about drivers; the
/// handling of a driver's crash; and the start of `verisq-surface`.
#include <fmt/core.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>
#include <verisq/device.hpp>
#include <verisq/error.hpp>

#include "host/command_line/options.hpp"
#include "host/command_line/run.hpp"
#include "host/device/opencl_library.hpp"
#include "host/errors/refusal.hpp"
#include "host/threads/background_work.hpp"

namespace verisq::command_line {
namespace {

// `verisq devices`: every OpenCL device, with the outcome of its self-test; `--report` measures their accuracy.

struct DevicesArguments {
  bool report = false;
};

// An OpenCL driver that ends the process: the command starts again without OpenCL devices.

/// PoCL aborts, or reads beyond a file's end, if its cache of kernels is damaged, and calls `exit` if the disk is full.
/// Once OpenCL is in use, the fatal signals SIGABRT, SIGBUS, SIGSEGV and SIGILL, and any `exit` while this lives, are
/// reported on the standard error. Then the command starts again, with no OpenCL driver to be found: a named device is
/// refused then, and `auto` computes on the host.
///
/// A command whose input or output may be a pipe ends instead: what it has read or written cannot be undone. Signals
/// that have a handler now keep it, like those of sanitizers. Precondition: made once, with `main`'s `argv`.
class DriverCrashWatch {
 public:
  DriverCrashWatch(int argc, char** argv);
  ~DriverCrashWatch();
  DriverCrashWatch(const DriverCrashWatch&) = delete;
  DriverCrashWatch& operator=(const DriverCrashWatch&) = delete;
};

// `verisq surface` of the program `verisq`: it starts `verisq-surface`, which is a program of its own because of the
// licence of a library that it links.

struct SurfaceProgramArguments {
  std::vector<std::string> all;  ///< the words after the command
};

constexpr const char* closing_words_of_devices =
    "The self-test runs the device's arithmetic against the host's, rounding error by rounding error. `--device` of\n"
    "`verisq map` takes the index or a part of the name of a device that passed; `--device host` needs none.\n"
    "`--report` prints a Markdown table; the samples are the same at every run. Exit status 1 when a bound is unsound.";

constexpr std::size_t report_samples = 100'000;

void print(const DeviceReport& device) {
  fmt::print("{}  {}\n", device.index, quotation(device.name));
  fmt::print("   platform   {}\n   driver     {}\n   width      {} doubles a work-item\n", quotation(device.platform),
             quotation(device.driver), device.vector_width);
  if (device.passed) {
    fmt::print("   self-test  passed\n");
  } else {
    fmt::print("   self-test  FAILED: {}\n", on_one_line(device.failure));
  }
}

// ---------------------------------------------------------------- the report

/// One column of the table.
struct Measured {
  std::string name;
  std::vector<FunctionAccuracy> rows;
};

/// A percentage on the terminal's standard error, for work that takes more than a second.
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
    Percentage percentage(quotation(device.name));
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
    fmt::print("- device {}: {} doubles a work-item, {}, {}, driver {}{}\n", device.index, device.vector_width,
               quotation(device.name), quotation(device.platform), quotation(device.driver),
               device.passed ? "" : ": FAILED its self-test, not measured");
  }
  fmt::print("\n");
  print_table(measured);
  const std::uint64_t count = unsound(measured);
  fmt::print("\nUnsound bounds: {}.\n", count);
  return count == 0 ? ExitStatus::verified : ExitStatus::failed;
}

void declare_devices(Options& options, DevicesArguments& arguments) {
  options.explain(closing_words_of_devices);
  options.add_flag("--report", arguments.report, "Measure instead how tight every directed operation is, in ulp");
}

ExitStatus run_devices(const DevicesArguments& arguments) {
  const auto devices = test_devices();
  if (arguments.report) return print_report(devices);
  if (devices.empty()) fmt::print("no OpenCL device; verisq map --device host works without one\n");
  for (const auto& device : devices) print(device);
  return ExitStatus::verified;
}

Command devices_command() {
  return command("devices", "List every OpenCL device and the outcome of its self-test", declare_devices, run_devices);
}

// The loaders of OpenCL look for drivers in this folder; this file holds none.
constexpr std::string_view drivers = "OCL_ICD_VENDORS=";
constexpr const char* no_drivers = "OCL_ICD_VENDORS=/dev/null";

/// Prepared before: a handler cannot allocate.
struct Restart {
  std::vector<char*> arguments;    // ends with a null pointer
  std::vector<char*> environment;  // likewise
  std::vector<int> signals;
  std::string sentences = {};
  bool is_possible = false;
};

// A signal handler reaches nothing but static storage.
// NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables): for that reason
const Restart* prepared = nullptr;
// NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables): handlers of exits have no arguments, either
std::atomic<bool> main_runs{false};

/// Returns where it cannot start again.
void start_again() {
  // If this fails, nothing else can be done.
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, prepared->sentences.data(), prepared->sentences.size());
  if (!prepared->is_possible) return;
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);  // the program that follows would inherit the blocked signal
  execve("/proc/self/exe", prepared->arguments.data(), prepared->environment.data());
}

void handle(int signal) {
  start_again();
  raise(signal);  // with SA_RESETHAND: ends as it would have
}

/// Only a driver calls `exit` while `main` runs; this program never does.
void handle_exit() {
  if (main_runs) start_again();
}

/// False for "-", and for an existing path that is neither a file nor a folder.
bool is_no_pipe(std::string_view name) {
  if (name == "-") return false;
  struct stat status = {};
  return stat(std::string(name).c_str(), &status) != 0 || S_ISREG(status.st_mode) || S_ISDIR(status.st_mode);
}

/// "map.csv", "--output=map.csv", "-omap.csv".
bool can_be_opened_again(std::string_view word) {
  if (!word.starts_with("-") || word == "-") return is_no_pipe(word);
  if (!word.starts_with("--")) return is_no_pipe(word.substr(2));
  const std::size_t equals = word.find('=');
  return equals == std::string_view::npos || is_no_pipe(word.substr(equals + 1));
}

std::vector<int> signals_without_handler() {
  std::vector<int> signals;
  for (const int signal : {SIGABRT, SIGBUS, SIGSEGV, SIGILL}) {
    struct sigaction action = {};
    sigaction(signal, nullptr, &action);
    if (action.sa_handler == SIG_DFL) signals.push_back(signal);
  }
  return signals;
}

/// The folder as PoCL determines it.
std::string folder_of_pocl() {
  const auto value = [](const char* name) { return std::string_view(std::getenv(name) ? std::getenv(name) : ""); };
  if (const auto folder = value("POCL_CACHE_DIR"); !folder.empty()) return std::string(folder);
  if (const auto folder = value("XDG_CACHE_HOME"); !folder.empty()) return std::string(folder).append("/pocl");
  return std::string(value("HOME")).append("/.cache/pocl");
}

Restart restart(int argc, char** argv) {
  Restart made{.arguments = {argv, argv + argc}, .environment = {}, .signals = signals_without_handler()};
  made.is_possible = std::all_of(made.arguments.begin() + 1, made.arguments.end(), can_be_opened_again);
  made.arguments.push_back(nullptr);
  for (char** variable = environ; *variable != nullptr; ++variable) {
    if (std::string_view(*variable) == no_drivers) made.is_possible = false;  // a second time would change nothing
    if (!std::string_view(*variable).starts_with(drivers)) made.environment.push_back(*variable);
  }
  made.sentences = fmt::format(
      "verisq: the OpenCL driver ended this run, as PoCL does where its cache is damaged or the disk is "
      "full; delete {}{}\n",
      quotation(folder_of_pocl()),
      made.is_possible ? "\nverisq: starting again without OpenCL devices" : ", or give --device host");
  static std::string without(no_drivers);
  made.environment.push_back(without.data());
  made.environment.push_back(nullptr);
  return made;
}

/// Replaces LLVM's handlers, which PoCL brings along: they let the process end.
void take_signals() {
  for (const int signal : prepared->signals) {
    struct sigaction action = {};
    action.sa_handler = handle;
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    sigaction(signal, &action, nullptr);
  }
}

void take_signals_and_exits() {
  take_signals();
  // Registered after the driver's own, hence called before them.
  [[maybe_unused]] static const int registered = std::atexit(handle_exit);
}

DriverCrashWatch::DriverCrashWatch(int argc, char** argv) {
  static const Restart made = restart(argc, argv);
  prepared = &made;
  main_runs = true;
  device::before_each_context(take_signals_and_exits);
}

DriverCrashWatch::~DriverCrashWatch() {
  main_runs = false;
}

void declare_surface_program(Options& options, SurfaceProgramArguments& arguments) {
  options.take_all(arguments.all);
}

/// Never returns: the process becomes the other program. Throws Error(input) where that does not lie in the folder of
/// the running program, Error(failure) where it does not start.
ExitStatus run_surface_program(const SurfaceProgramArguments& arguments) {
  const auto program = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "verisq-surface";
  std::vector<std::string> words{name_of_caller, "surface"};
  words.insert(words.end(), arguments.all.begin(), arguments.all.end());
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  execv(program.c_str(), argv.data());
  if (errno == ENOENT) {
    refuse(fmt::format("surface: {} is not there; it is built where CGAL is (Debian: libcgal-dev)", program.string()));
  }
  throw Error(ErrorKind::failure,
              fmt::format("{}: cannot start: {}", program.string(), std::generic_category().message(errno)));
}

Command surface_command() {
  return command("surface", surface_description, declare_surface_program, run_surface_program);
}

constexpr const char* closing_words_of_program =
    R"(Exit status: 0 every enclosure verified (check: proved), 1 the program failed, 2 bad usage or input, 3 finished,
some enclosures wide (check: not proved), 130 interrupted by Ctrl-C, 143 by SIGTERM, 129 by SIGHUP. These three
keep what is finished; a run that is killed leaves the finished rows of a .csv under OUT.*.partial.
`verisq COMMAND --help` explains a command.)";

/// The demo's program has those that map, and is linked with nothing that the others need; `verisq` has all.
std::vector<Command> commands() {
  if constexpr (VERISQ_ALL_COMMANDS) {
    return {map_command(),       batch_command(),    check_command(),   distance_command(),
            deviation_command(), features_command(), fit_command(),     insert_command(),
            merge_command(),     mesh_command(),     octree_command(),  path_command(),
            recover_command(),   stance_command(),   surface_command(), devices_command()};
  }
  return {map_command(), merge_command(), devices_command()};
}

}  // namespace
}  // namespace verisq::command_line

int main(int argc, char** argv) {
  using namespace verisq::command_line;
  const DriverCrashWatch watch(argc, argv);
  const Program program{.name = "verisq",
                        .description =
                            "verisq: guaranteed distances for whole meshes.\n"
                            "Every answer is an interval of binary64 numbers that contains the exact result.",
                        .closing_words = closing_words_of_program};
  const int status = run_program(program, commands(), argc, argv);
  verisq::GivenUpThreads::leave_unless_none(status);
  return status;
}
