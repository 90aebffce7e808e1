/// A command of a program, as a row of its table.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "host/command_line/exit_status.hpp"
#include "host/command_line/options.hpp"

namespace verisq::command_line {

/// Runs a command whose options are parsed.
using Action = std::function<ExitStatus()>;

struct Command {
  std::string name;
  std::string description;  ///< one line
  /// Declares the options, whose values live in the action that it returns.
  std::function<Action(Options&)> declare;
};

/// `declare` binds the options to fields of `Arguments`, which `run` reads.
template <class Arguments>
[[nodiscard]] Command command(const std::string& name, const std::string& description,
                              void (*declare)(Options&, Arguments&), ExitStatus (*run)(const Arguments&)) {
  return {name, description, [declare, run](Options& options) -> Action {
            const auto arguments = std::make_shared<Arguments>();
            declare(options, *arguments);
            return [arguments, run] { return run(*arguments); };
          }};
}

}  // namespace verisq::command_line
