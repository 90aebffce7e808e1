/// One line for each kind of failure.
#include "host/command_line/run_program.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>
#include <string_view>
#include <vector>
#include <verisq/version.hpp>

#include "host/command_line/interruption.hpp"
#include "host/command_line/refusal.hpp"

namespace verisq::command_line {
namespace {

int status_of(ExitStatus status) {
  return status == ExitStatus::interrupted ? status_of_interruption() : static_cast<int>(status);
}

/// `parse_and_run` returns nothing where --help or --version was all that was asked.
int answer(const std::string& name, const std::function<std::optional<ExitStatus>()>& parse_and_run) {
  const auto report = [&](std::string_view message, ExitStatus status) {
    fmt::print(stderr, "{}: {}\n", name, message);
    return static_cast<int>(status);
  };
  try {
    const std::optional<ExitStatus> status = parse_and_run();
    if (std::fflush(stdout) != 0) return report("cannot write to the standard output", ExitStatus::failed);
    return status ? status_of(*status) : 0;
  } catch (const Error& error) {
    return report(error.what(), error.kind() == ErrorKind::input ? ExitStatus::bad_input : ExitStatus::failed);
  } catch (const std::bad_alloc&) {
    return report("out of memory", ExitStatus::failed);
  } catch (const std::exception& error) {
    return report(error.what(), ExitStatus::failed);
  }
}

}  // namespace

int run_program(const Program& program, std::span<const Command> commands, int argc, char** argv) {
  return answer(program.name, [&]() -> std::optional<ExitStatus> {
    Options options(program.name, program.description, VERISQ_VERSION);
    options.explain(program.closing_words);
    std::vector<std::pair<Options, Action>> declared;
    for (const auto& [name, description, declare] : commands) {
      Options of_command = options.command(name, description);
      Action run = declare(of_command);
      declared.emplace_back(std::move(of_command), std::move(run));
    }
    if (!options.parse(argc, argv)) return std::nullopt;
    const auto given = [](const auto& command) { return command.first.given(); };
    const auto asked = std::ranges::find_if(declared, given);
    if (asked == declared.end()) refuse(fmt::format("give a command (see {} --help)", program.name));
    const auto other = std::find_if(asked + 1, declared.end(), given);
    if (other != declared.end())
      refuse(fmt::format("give one command, not both {} and {}", asked->first.name(), other->first.name()));
    return asked->second();
  });
}

int run_program(const Program& program, const Command& command, int argc, char** argv) {
  return answer(program.name, [&]() -> std::optional<ExitStatus> {
    Options options(program.name, program.description, VERISQ_VERSION);
    const Action run = command.declare(options);
    if (!options.parse(argc, argv)) return std::nullopt;
    return run();
  });
}

}  // namespace verisq::command_line
