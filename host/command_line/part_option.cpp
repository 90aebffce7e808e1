/// Parses i/n, and has digests made by threads of their own.
#include "host/command_line/part_option.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <verisq/version.hpp>

#include "host/command_line/whole_number.hpp"
#include "host/errors/refusal.hpp"
#include "host/files/words.hpp"

namespace verisq::command_line {
namespace {

constexpr std::uint64_t most_parts = 1'000'000;

std::string extension_of_part(const std::string& output, const std::optional<std::string>& format) {
  if (output == "-" || output.empty()) refuse("--part: give the file that holds it: -o");
  return lower_case(format ? *format : std::filesystem::path(output).extension().string());
}

std::future<SubjectFile> digest_begun(const std::string& file) {
  if (!std::filesystem::is_regular_file(file)) {
    refuse(fmt::format("--part: {}: is no regular file, and parts must tell which it is", file));
  }
  return std::async(std::launch::async, [file] { return digest_of_file(file); });
}

}  // namespace

PartOption parse_part(std::string_view option, const std::string& text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos) refuse(fmt::format("{}: {}: give i/n, part i (from 1) of n", option, text));
  const std::uint64_t parts = parse_whole_number(option, text.substr(slash + 1), 1, most_parts);
  return {parse_whole_number(option, text.substr(0, slash), 1, parts), parts};
}

void add_part(Options& options, std::optional<PartOption>& part) {
  options.add(
      "--part", part, parse_part, "I/N",
      fmt::format(
          "Map part I (from 1) of N alone, whole blocks of {} rows, into a .csv or .npy of its own, points\n"
          "also into a .vtp; beside it OUT.part.json says what it is a part of. `verisq merge` makes the whole\n"
          "of all parts",
          rows_per_block));
}

std::string format_of_part(const std::string& output, const std::optional<std::string>& format) {
  const std::string extension = extension_of_part(output, format);
  if (extension != ".csv" && extension != ".npy") refuse("--part: parts are written to .csv and .npy only");
  return extension;
}

std::string format_of_drawn_part(const std::string& output, const std::optional<std::string>& format) {
  const std::string extension = extension_of_part(output, format);
  return extension == ".vtp" ? extension : format_of_part(output, format);
}

std::string text_of(const PoseUncertainty& bounds) {
  const auto& [t, rotation, c] = bounds;
  return fmt::format("{},{},{} {} {},{},{}", t[0], t[1], t[2], rotation, c[0], c[1], c[2]);
}

PartRecord::PartRecord(MapPart part, const std::vector<std::string>& models, const std::string& input)
    : part_(std::move(part)) {
  for (const std::string& model : models) models_.push_back(digest_begun(model));
  input_ = digest_begun(input);
}

void PartRecord::write(const std::string& output, const MapSummary& summary,
                       const std::optional<ClosestPointSummary>& closest) {
  part_.version = VERISQ_VERSION;
  for (std::future<SubjectFile>& model : models_) part_.models.push_back(model.get());
  part_.input = input_.get();
  part_.map = digest_of_file(output);
  part_.summary = summary;
  part_.closest = closest;
  write_map_part(output, part_);
}

}  // namespace verisq::command_line
