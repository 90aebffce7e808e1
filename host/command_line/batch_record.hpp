/// What is known of the cases of a cohort: one file for each that is done, which a later run takes over.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>
#include <verisq/certificate_file.hpp>
#include <verisq/enclosure.hpp>

#include "host/command_line/batch_manifest.hpp"

namespace verisq::command_line {

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

}  // namespace verisq::command_line
