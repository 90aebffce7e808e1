/// One line for each kind of failure.
#include "host/command_line/run_program.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <new>
#include <string_view>
#include <verisq/error.hpp>

#include "host/command_line/interruption.hpp"

namespace verisq::command_line {

int run_program(CLI::App& program, int argc, char** argv, const std::function<ExitStatus()>& command) {
  const auto report = [&](std::string_view message, ExitStatus status) {
    fmt::print(stderr, "{}: {}\n", program.get_name(), message);
    return static_cast<int>(status);
  };
  try {
    program.parse(argc, argv);
    const ExitStatus status = command();
    if (std::fflush(stdout) != 0) return report("cannot write to the standard output", ExitStatus::failed);
    return status == ExitStatus::interrupted ? status_of_interruption() : static_cast<int>(status);
  } catch (const CLI::ParseError& error) {
    // `--help` and `--version` arrive as errors of status 0, whose text CLI11 prints.
    if (error.get_exit_code() == 0) return program.exit(error);
    return report(fmt::format("{} (see {} --help)", error.what(), program.get_name()), ExitStatus::bad_input);
  } catch (const Error& error) {
    return report(error.what(), error.kind() == ErrorKind::input ? ExitStatus::bad_input : ExitStatus::failed);
  } catch (const std::bad_alloc&) {
    return report("out of memory", ExitStatus::failed);
  } catch (const std::exception& error) {
    return report(error.what(), ExitStatus::failed);
  }
}

}  // namespace verisq::command_line
