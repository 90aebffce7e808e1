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

// The cases of a cohort, a row each: what `verisq batch` reads (docs/formats.md §11).

/// A command line of this program.
struct BatchCase {
  std::string name;                    ///< a part of file names; differs from those of others
  std::string command;                 ///< "map"
  std::vector<std::string> arguments;  ///< as typed behind the command
  bool has_output = false;             ///< one of them is --output
};

/// CSV with a header: `case`, `command` (may be absent: map), and options by their long names without dashes; `a` and
/// `b` are the models of `distance` and `path`. Fields may stand in double quotes. Empty fields and `no` leave an
/// option out, `yes` gives it without a value. Throws Error(input) naming file and line for anything else, for names
/// that are none or appear twice, and for a manifest without cases.
[[nodiscard]] std::vector<BatchCase> read_manifest(const std::filesystem::path& path);

// What is known of the cases of a cohort: one file for each that is done, which a later run takes over.

enum class CaseOutcome : std::uint8_t {
  verified,  ///< exit status 0
  wide,      ///< 3: finished, and not all as asked
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

/// What its command printed with --json. Throws Error(input) for what is no JSON object.
[[nodiscard]] CaseResult result_of(std::string_view json, CaseOutcome outcome, std::string_view name);

/// All that is known of it, as one line that `result_from` reads again.
[[nodiscard]] std::string text_of(const CaseResult& result);
/// Precondition: a text of `text_of`.
[[nodiscard]] CaseResult result_from(std::string_view text);

/// Which files a case reads: those that its arguments name, from the manifest's folder.
[[nodiscard]] std::vector<std::filesystem::path> inputs_of(const BatchCase& of, const std::filesystem::path& folder);

/// Writes what a finished case said, and what it was: its arguments and the digests of its inputs. Throws
/// Error(failure).
void write_record(const std::filesystem::path& path, const BatchCase& of, const std::vector<SubjectFile>& inputs,
                  CaseOutcome outcome, double seconds, std::string_view json);

/// Nothing where there is none, or it is of other arguments or inputs, or not whole.
[[nodiscard]] std::optional<CaseResult> read_record(const std::filesystem::path& path, const BatchCase& of,
                                                    const std::vector<SubjectFile>& inputs);

// The tables of a cohort: one for programs, one with all that is known, and a page for people.

/// How many cases there are of each outcome, and the least of all proven minima.
struct BatchTotals {
  std::size_t verified = 0;
  std::size_t wide = 0;
  std::size_t failed = 0;
  std::size_t not_run = 0;
  bool same_units = true;                   ///< of all cases with a smallest distance: only then they are compared
  std::optional<std::size_t> nearest = {};  ///< the case with the smallest upper end
};

[[nodiscard]] BatchTotals totals_of(std::span<const CaseResult> results);

/// `case,command,outcome,lo,hi,rows,wide_rows,largest_width,units,message`: the same bytes whenever the answers are.
void write_csv_table(const std::filesystem::path& path, std::span<const BatchCase> cases,
                     std::span<const CaseResult> results);

/// The same and times, as `verisq-batch/1`.
[[nodiscard]] std::string json_table(std::span<const BatchCase> cases, std::span<const CaseResult> results,
                                     bool interrupted);
void write_json_table(const std::filesystem::path& path, const std::string& json);

/// One file that any browser opens without a network.
void write_page(const std::filesystem::path& path, const std::string& title, std::span<const BatchCase> cases,
                std::span<const CaseResult> results);

// Cases as processes of their own: what crashes or runs out of memory takes no other with it.

/// `verisq`, started in a folder. Both of its outputs go to files.
class BatchProcess {
 public:
  /// Throws Error(failure) when it cannot be started. It ends with this one, however that ends (Linux).
  BatchProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
               const std::filesystem::path& folder, const std::filesystem::path& out, const std::filesystem::path& err);

  /// Its exit status, or 128 + the signal that ended it; nothing while it runs.
  [[nodiscard]] std::optional<int> status() const;
  void end() const;  ///< asks it to

 private:
  pid_t id_;
};

// Runs the cases of a cohort that are not done yet.

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

// `verisq batch`: the cases of a cohort, one after the other or several at a time, resumable.

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
