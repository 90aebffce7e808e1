/// One line for each kind of failure.
#include "host/command_line/run_program.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/version.hpp>

#include "host/command_line/interruption.hpp"
#include "host/command_line/spelling.hpp"
#include "host/errors/refusal.hpp"

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

void refuse_unless_known(const std::string& command, std::span<const Command> commands) {
  std::vector<std::string> names;
  for (const Command& known : commands) names.push_back(known.name);
  if (std::ranges::find(names, command) != names.end()) return;
  const std::optional<std::string> near = nearest_word(command, names);
  refuse(fmt::format("help: there is no command {}{}", command, near ? "; did you mean " + *near + "?" : ""));
}

/// `help` and `help COMMAND` become what they stand for: `--help` and `COMMAND --help`.
std::vector<char*> without_help(std::vector<char*> words, std::span<const Command> commands, std::string& help_option) {
  if (words.size() < 2 || words[1] != std::string_view("help")) return words;
  if (words.size() > 3) refuse("help: name one command");
  if (words.size() == 3 && !std::string_view(words[2]).starts_with("-")) refuse_unless_known(words[2], commands);
  words.erase(words.begin() + 1);
  words.push_back(help_option.data());
  return words;
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
    // For the list of commands: it never runs.
    static_cast<void>(options.command("help", "Explain a command: help COMMAND"));
    std::string help_option = "--help";
    std::vector<char*> words = without_help({argv, argv + argc}, commands, help_option);
    if (!options.parse(static_cast<int>(words.size()), words.data())) return std::nullopt;
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
