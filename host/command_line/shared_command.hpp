/// A command that all ranks of an MPI job run together.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "host/command_line/command.hpp"
#include "host/mpi/communicator.hpp"

namespace verisq::command_line {

/// Runs it. Where a rank fails, one message is printed for all, and the others are ended, which would wait for it.
ExitStatus run_guarded(const mpi::Session& session, const std::function<ExitStatus()>& run);

/// As `command`. `session` must outlive the command.
template <class Arguments>
[[nodiscard]] Command shared_command(const std::string& name, const std::string& description,
                                     const mpi::Session& session, void (*declare)(Options&, Arguments&),
                                     ExitStatus (*run)(const Arguments&, const mpi::Session&)) {
  return {name, description, [&session, declare, run](Options& options) -> Action {
            const auto arguments = std::make_shared<Arguments>();
            declare(options, *arguments);
            return
                [&session, arguments, run] { return run_guarded(session, [&] { return run(*arguments, session); }); };
          }};
}

}  // namespace verisq::command_line
