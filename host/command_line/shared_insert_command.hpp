/// `verisq-mpi insert`: how deep an implant cuts into the bone on its way in, by all ranks of an MPI job.
#pragma once

#include "host/command_line/exit_status.hpp"
#include "host/command_line/insertion_inputs.hpp"
#include "host/command_line/shared_rows.hpp"

namespace verisq::command_line {

/// As typed.
struct SharedInsertArguments {
  InsertionInputs inputs;
  SharedRowsArguments rows;
};

void declare_shared_insert(Options& options, SharedInsertArguments& arguments);

/// Called by all ranks. Throws Error as `verisq insert`.
ExitStatus run_shared_insert(const SharedInsertArguments& arguments, const mpi::Session& session);

}  // namespace verisq::command_line
