/// Runs the cases of a cohort that are not done yet.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "host/command_line/batch_manifest.hpp"
#include "host/command_line/batch_record.hpp"

namespace verisq::command_line {

struct BatchFolders {
  std::filesystem::path manifest;  ///< in which the names of files are meant
  std::filesystem::path results;
};

struct BatchRun {
  std::vector<CaseResult> results;  ///< of each case
  std::size_t taken_over = 0;       ///< from an earlier run
  bool interrupted = false;
};

/// `jobs` at a time. `progress` is called with the number of cases that have ended. Throws Error(failure) where nothing
/// can be written or started; what a case does wrong is its result.
[[nodiscard]] BatchRun run_batch(std::span<const BatchCase> cases, const BatchFolders& folders, std::size_t jobs,
                                 const std::function<void(std::size_t)>& progress);

}  // namespace verisq::command_line
