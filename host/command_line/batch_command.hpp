/// `verisq batch`: the cases of a cohort, one after the other or several at a time, resumable.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include <verisq/certificate_file.hpp>
#include <verisq/enclosure.hpp>

#include "host/command_line/options.hpp"
#include "host/command_line/run.hpp"

namespace verisq::command_line {

// The cases of a cohort, one in each row: the input of `verisq batch` (docs/formats.md §11).

/// A command line of this program.
struct BatchCase {
  std::string name;                    ///< a part of file names; differs from those of others
  std::string command;                 ///< "map"
  std::vector<std::string> arguments;  ///< as typed behind the command
  bool has_output = false;             ///< one of them is --output
};

/// CSV with a header: `case`, `command` (may be absent: map), and options by their long names without dashes. `a` and
/// `b` are the models of `distance` and `path`. Fields may stand in double quotes. Empty fields and `no` leave an
/// option out, `yes` gives it without a value. Throws Error(input) naming file and line for anything else, for invalid
/// names or names that appear twice, and for a manifest without cases.
[[nodiscard]] std::vector<BatchCase> read_manifest(const std::filesystem::path& path);

// The records of a cohort's cases: one file for each finished case, which a later run reuses.

enum class CaseOutcome : std::uint8_t {
  verified,  ///< exit status 0
  wide,      ///< 3: finished, but some requirement is not met
  failed,    ///< anything else
  not_run,   ///< the run was interrupted before
};

/// "verified", "wide", "failed", "not-run".
[[nodiscard]] std::string_view to_string(CaseOutcome outcome);

struct CaseResult {
  CaseOutcome outcome = CaseOutcome::not_run;
  std::string message = {};                ///< of a failure, one line
  std::optional<Enclosure> smallest = {};  ///< the proven minimum, where the command has one
  std::optional<std::uint64_t> rows = {};
  std::optional<std::uint64_t> wide_rows = {};
  std::string units = {};
  std::optional<double> largest_width = {};
  double seconds = 0.0;
};

/// The result that its command printed with --json. Throws Error(input) for text that is no JSON object.
[[nodiscard]] CaseResult result_of(std::string_view json, CaseOutcome outcome, std::string_view name);

/// The whole result, as one line that `result_from` can read.
[[nodiscard]] std::string text_of(const CaseResult& result);
/// Precondition: a text of `text_of`.
[[nodiscard]] CaseResult result_from(std::string_view text);

/// The files that a case reads: those that its arguments name, relative to the manifest's folder.
[[nodiscard]] std::vector<std::filesystem::path> inputs_of(const BatchCase& of, const std::filesystem::path& folder);

/// Writes the result of a finished case, and its identity: its arguments and the digests of its inputs. Throws
/// Error(failure).
void write_record(const std::filesystem::path& path, const BatchCase& of, const std::vector<SubjectFile>& inputs,
                  CaseOutcome outcome, double seconds, std::string_view json);

/// Nothing if there is no record, if it belongs to other arguments or inputs, or if it is not whole.
[[nodiscard]] std::optional<CaseResult> read_record(const std::filesystem::path& path, const BatchCase& of,
                                                    const std::vector<SubjectFile>& inputs);

// The tables of a cohort: one for programs, one with all results, and a page for people.

/// The number of cases of each outcome, and the least of all proven minima.
struct BatchTotals {
  std::size_t verified = 0;
  std::size_t wide = 0;
  std::size_t failed = 0;
  std::size_t not_run = 0;
  bool same_units = true;  ///< of all cases with a smallest distance: only then the minima are compared
  std::optional<std::size_t> nearest = {};  ///< the case with the smallest upper end
};

[[nodiscard]] BatchTotals totals_of(std::span<const CaseResult> results);

/// `case,command,outcome,lo,hi,rows,wide_rows,largest_width,units,message`: the same bytes whenever the answers are.
void write_csv_table(const std::filesystem::path& path, std::span<const BatchCase> cases,
                     std::span<const CaseResult> results);

/// The same results and times, as `verisq-batch/1`.
[[nodiscard]] std::string json_table(std::span<const BatchCase> cases, std::span<const CaseResult> results,
                                     bool interrupted);
void write_json_table(const std::filesystem::path& path, const std::string& json);

/// A single file that any browser opens without a network.
void write_page(const std::filesystem::path& path, const std::string& title, std::span<const BatchCase> cases,
                std::span<const CaseResult> results);

// Cases as processes of their own: a case that crashes or runs out of memory does not stop another.

/// `verisq`, started in a folder. Both of its outputs go to files.
class BatchProcess {
 public:
  /// Throws Error(failure) if it cannot be started. It ends with this process, however that ends (Linux).
  BatchProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
               const std::filesystem::path& folder, const std::filesystem::path& out, const std::filesystem::path& err);

  /// Its exit status, or 128 + the signal that ended it; nothing while it runs.
  [[nodiscard]] std::optional<int> status() const;
  void end() const;  ///< asks the process to end

 private:
  pid_t id_;
};

// Runs the cases of a cohort that are not done yet.

struct BatchFolders {
  std::filesystem::path manifest;  ///< the folder to which names of files are relative
  std::filesystem::path results;
};

struct BatchRun {
  std::vector<CaseResult> results;  ///< of each case; "not run" for those that `next` did not return
  std::size_t taken_over = 0;       ///< from an earlier run
  bool interrupted = false;
};

struct BatchOptions {
  std::size_t jobs = 1;                              ///< cases at a time
  std::filesystem::path program = "/proc/self/exe";  ///< the program that runs the commands of the cases
  /// Returns the places of the cases to be run, each once; nothing if there are no more. If it is empty: all cases, in
  /// order.
  std::function<std::optional<std::size_t>()> next = {};
  std::function<void(std::size_t)> progress = [](std::size_t) {};  ///< the number of cases that have ended
};

/// Throws Error(failure) if nothing can be written or started; an error of a case is its result.
[[nodiscard]] BatchRun run_batch(std::span<const BatchCase> cases, const BatchFolders& folders,
                                 const BatchOptions& options);

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

/// The folders of its cases and of their results.
[[nodiscard]] BatchFolders folders_of(const BatchArguments& arguments);

/// Writes the tables of the run, and prints their totals. Throws Error(failure).
ExitStatus conclude(const BatchArguments& arguments, const std::vector<BatchCase>& cases, const BatchRun& run);

/// `verified` if every case is; `unverified` if a case is wide or failed. Throws Error(input) for the manifest alone.
ExitStatus run_batch_command(const BatchArguments& arguments);

}  // namespace verisq::command_line
