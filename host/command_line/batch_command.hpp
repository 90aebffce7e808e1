/// `verisq batch`: the cases of a cohort, one after the other or several at a time, resumable.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host/command_line/batch_manifest.hpp"
#include "host/command_line/batch_run.hpp"
#include "host/command_line/exit_status.hpp"
#include "host/command_line/options.hpp"

namespace verisq::command_line {

struct BatchArguments {
  std::string manifest;
  std::string output;  ///< a folder
  std::size_t jobs = 1;
  bool json = false;
  bool no_progress = false;
};

void declare_batch(Options& options, BatchArguments& arguments);

/// Adds the manifest, -o, --json and --no-progress.
void declare_cohort(Options& options, BatchArguments& arguments);

/// Where its cases are, and their results.
[[nodiscard]] BatchFolders folders_of(const BatchArguments& arguments);

/// Writes the tables of what was run, and prints what they say in all. Throws Error(failure).
ExitStatus conclude(const BatchArguments& arguments, const std::vector<BatchCase>& cases, const BatchRun& run);

/// `verified` when every case is; `unverified` when a case is wide or failed. Throws Error(input) for the manifest
/// alone.
ExitStatus run_batch_command(const BatchArguments& arguments);

}  // namespace verisq::command_line
