/// Runs the cases of a cohort that are not done yet.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
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
  std::vector<CaseResult> results;  ///< of each case; "not run" of those that `next` did not give
  std::size_t taken_over = 0;       ///< from an earlier run
  bool interrupted = false;
};

struct BatchOptions {
  std::size_t jobs = 1;                              ///< cases at a time
  std::filesystem::path program = "/proc/self/exe";  ///< whose commands the cases are
  /// The places of the cases to be run, each once; nothing where there are no more. Where it is none: all, in order.
  std::function<std::optional<std::size_t>()> next = {};
  std::function<void(std::size_t)> progress = [](std::size_t) {};  ///< the number of cases that have ended
};

/// Throws Error(failure) where nothing can be written or started; what a case does wrong is its result.
[[nodiscard]] BatchRun run_batch(std::span<const BatchCase> cases, const BatchFolders& folders,
                                 const BatchOptions& options);

}  // namespace verisq::command_line
