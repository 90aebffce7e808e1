/// What `verisq-mpi map` and `insert` have in common: whose device a rank takes, how a shared map goes on and ends.
#pragma once

#include <string>
#include <vector>

#include "host/command_line/exit_status.hpp"
#include "host/command_line/options.hpp"
#include "host/mpi/communicator.hpp"
#include "host/mpi/shared_map.hpp"

namespace verisq::command_line {

struct SharedRowsArguments {
  std::string device = "auto";
  bool device_of_rank = false;
  std::string output;
  bool resume = false;
  bool json = false;
};

/// Adds --device, --device-of-rank, -o, --resume, --json.
void declare_shared_rows(Options& options, SharedRowsArguments& arguments);

/// What this rank computes on.
[[nodiscard]] std::string device_of(const SharedRowsArguments& arguments, const mpi::Session& session);

/// "tolerance" and "format".
[[nodiscard]] std::vector<PartSetting> settings_of(const SharedRowsArguments& arguments, double tolerance);

/// Has all ranks make the rows; rank 0 prints what they say. As `mpi::shared_map`.
ExitStatus share_rows(const SharedRowsArguments& arguments, const mpi::SharedMapRequest& request, double tolerance,
                      const mpi::Session& session, const mpi::RangeMap& map);

}  // namespace verisq::command_line
