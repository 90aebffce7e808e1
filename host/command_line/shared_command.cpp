/// Errors of one rank, and of all.
#include "host/command_line/shared_command.hpp"

#include <fmt/core.h>

#include <chrono>
#include <cstdio>
#include <thread>
#include <verisq/error.hpp>

namespace verisq::command_line {

ExitStatus run_guarded(const mpi::Session& session, const std::function<ExitStatus()>& run) {
  try {
    return run();
  } catch (const Error& error) {
    const auto status = static_cast<int>(error.kind() == ErrorKind::input ? ExitStatus::bad_input : ExitStatus::failed);
    // What is wrong with the input all ranks find out; rank 0 says it, unless another one alone has.
    constexpr auto patience = std::chrono::seconds(2);
    if (session.rank() != 0) std::this_thread::sleep_for(patience);
    fmt::print(stderr, "verisq-mpi: {}\n", error.what());
    std::fflush(stderr);
    session.abort(status);
  }
}

}  // namespace verisq::command_line
