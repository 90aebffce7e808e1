/// `verisq-mpi batch`: the cases of a cohort by all ranks of an MPI job.
#pragma once

#include "host/command_line/batch_command.hpp"
#include "host/command_line/exit_status.hpp"
#include "host/mpi/communicator.hpp"

namespace verisq::command_line {

void declare_shared_batch(Options& options, BatchArguments& arguments);

/// Called by all ranks. Throws Error(input) for the manifest alone.
ExitStatus run_shared_batch(const BatchArguments& arguments, const mpi::Session& session);

}  // namespace verisq::command_line
