/// Parts of a map are compared with each other, then copied one behind the other; those that are drawn are named.
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <set>
#include <system_error>
#include <utility>
#include <verisq/error.hpp>
#include <verisq/map_part.hpp>

#include "host/files/input_file.hpp"
#include "host/files/npy_header.hpp"
#include "host/files/output_file.hpp"
#include "host/files/pvtp_document.hpp"
#include "host/files/sha256.hpp"
#include "host/files/words.hpp"

namespace verisq {
namespace {

struct GivenPart {
  std::filesystem::path path;
  MapPart part;
};

std::vector<GivenPart> read_parts(std::span<const std::filesystem::path> paths) {
  if (paths.empty()) throw Error(ErrorKind::input, "no parts to merge");
  std::vector<GivenPart> parts;
  parts.reserve(paths.size());
  for (const std::filesystem::path& path : paths) parts.push_back({path, read_map_part(path)});
  std::ranges::stable_sort(parts, {}, [](const GivenPart& given) { return given.part.part; });
  return parts;
}

void refuse_difference(const GivenPart& given, std::string_view what, std::string_view value, const GivenPart& first,
                       std::string_view value_of_first) {
  if (value == value_of_first) return;
  refuse_file(given.path.string(),
              fmt::format("{} is {}, but {} in {}", what, value.empty() ? "nothing" : value,
                          value_of_first.empty() ? "nothing" : value_of_first, first.path.string()));
}

std::string text_of(const SubjectFile& file) {
  return fmt::format("{} (SHA-256 {})", file.name, file.sha256);
}

/// By its bytes: a file may have been called otherwise.
void refuse_other_subject(const GivenPart& given, std::string_view what, const SubjectFile& subject,
                          const GivenPart& first, const SubjectFile& of_first) {
  if (subject.sha256 == of_first.sha256) return;
  refuse_difference(given, what, text_of(subject), first, text_of(of_first));
}

std::string setting(const MapPart& part, std::string_view name) {
  const auto found = std::ranges::find(part.settings, name, &PartSetting::name);
  return found == part.settings.end() ? std::string() : found->value;
}

void refuse_other_settings(const GivenPart& given, const GivenPart& first) {
  std::set<std::string> names;
  for (const GivenPart* const of : {&first, &given}) {
    for (const PartSetting& setting : of->part.settings) names.insert(setting.name);
  }
  for (const std::string& name : names) {
    refuse_difference(given, name, setting(given.part, name), first, setting(first.part, name));
  }
}

void refuse_other_work(const GivenPart& given, const GivenPart& first, const MergeOptions& options) {
  refuse_difference(given, "the version of verisq", given.part.version, first, first.part.version);
  refuse_difference(given, "the number of models", std::to_string(given.part.models.size()), first,
                    std::to_string(first.part.models.size()));
  for (std::size_t i = 0; i < given.part.models.size(); ++i) {
    refuse_other_subject(given, "the model", given.part.models[i], first, first.part.models[i]);
  }
  refuse_other_subject(given, "the input", given.part.input, first, first.part.input);
  const auto elements = [](const GivenPart& of) { return std::to_string(static_cast<int>(of.part.elements)); };
  refuse_difference(given, "what rows are of", elements(given), first, elements(first));
  refuse_other_settings(given, first);
  refuse_difference(given, "the number of rows in all", std::to_string(given.part.rows_in_all), first,
                    std::to_string(first.part.rows_in_all));
  refuse_difference(given, "the number of parts", std::to_string(given.part.parts), first,
                    std::to_string(first.part.parts));
  // What has no rows has none of a device.
  if (options.mixed_devices || given.part.rows.count == 0 || first.part.rows.count == 0) return;
  refuse_difference(given, "the device", given.part.summary.device, first, first.part.summary.device);
}

/// Precondition: sorted.
void refuse_gaps_and_overlaps(const std::vector<GivenPart>& parts) {
  const std::uint64_t count = parts.front().part.parts;
  std::uint64_t next = 1;
  const GivenPart* before = nullptr;
  for (const GivenPart& given : parts) {
    if (given.part.part < next) {
      refuse_file(given.path.string(),
                  fmt::format("is part {} of {}, as {} is", given.part.part, count, before->path.string()));
    }
    if (given.part.part > next) break;
    before = &given;
    ++next;
  }
  if (next <= count) throw Error(ErrorKind::input, fmt::format("part {} of {} is missing", next, count));
}

/// What stands before the first row, and how its rows follow: a class for each format.
class PartForm {
 public:
  PartForm() = default;
  PartForm(const PartForm&) = delete;
  PartForm& operator=(const PartForm&) = delete;
  virtual ~PartForm() = default;

  /// Takes it from the front of `file`; refuses what is no such part, or another than those before.
  virtual std::string take_header(InputFile& file, const MapPart& part) = 0;
  /// That of the whole.
  [[nodiscard]] virtual std::string header(std::uint64_t rows) const = 0;
  /// Of the next bytes of the part.
  virtual void count(std::string_view bytes) = 0;
  /// Refuses another number of rows than the part says; forgets them.
  virtual void check_rows(const InputFile& file, const MapPart& part) = 0;
};

class CsvForm final : public PartForm {
 public:
  std::string take_header(InputFile& file, const MapPart& /*part*/) override {
    const std::string_view beginning = file.peek(longest_header);
    const std::size_t end = beginning.find('\n');
    if (end == std::string_view::npos) file.fail_whole("has no header");
    std::string line(file.take(end + 1, "the header"));
    if (header_.empty()) header_ = line;
    if (line != header_) file.fail_whole(fmt::format("has another header than the parts before: {}", in_quotes(line)));
    return line;
  }
  [[nodiscard]] std::string header(std::uint64_t /*rows*/) const override { return header_; }
  void count(std::string_view bytes) override {
    lines_ += static_cast<std::uint64_t>(std::ranges::count(bytes, '\n'));
    if (!bytes.empty()) ends_line_ = bytes.back() == '\n';
  }
  void check_rows(const InputFile& file, const MapPart& part) override {
    const std::uint64_t lines = std::exchange(lines_, 0);
    if (lines == part.rows.count && std::exchange(ends_line_, true)) return;
    file.fail_whole(fmt::format("has {} rows, and should have {}", lines, part.rows.count));
  }

 private:
  static constexpr std::size_t longest_header = 4096;
  std::string header_;
  std::uint64_t lines_ = 0;
  bool ends_line_ = true;
};

class NpyForm final : public PartForm {
 public:
  std::string take_header(InputFile& file, const MapPart& part) override {
    constexpr std::size_t longest_header = 8192;
    const std::string_view beginning = file.peek(longest_header);
    const std::size_t start = beginning.find(before_descr);
    const std::size_t end = beginning.find(after_descr);
    if (start == std::string_view::npos || end == std::string_view::npos || end < start) {
      file.fail_whole("has no header of an array of fields");
    }
    const std::string descr(beginning.substr(start + before_descr.size(), end - start - before_descr.size()));
    if (descr_.empty()) descr_ = descr;
    if (descr != descr_) file.fail_whole(fmt::format("has other fields than the parts before: {}", in_quotes(descr)));
    std::string expected = npy_header(descr_, part.rows.count);
    if (!beginning.starts_with(expected)) {
      file.fail_whole(fmt::format("is no array of {} rows, which it should have", part.rows.count));
    }
    return std::string(file.take(expected.size(), "the header"));
  }
  [[nodiscard]] std::string header(std::uint64_t rows) const override { return npy_header(descr_, rows); }
  void count(std::string_view bytes) override { bytes_ += bytes.size(); }
  void check_rows(const InputFile& file, const MapPart& part) override {
    const std::uint64_t bytes = std::exchange(bytes_, 0);
    if (part.rows.count > 0 && row_bytes_ == 0) row_bytes_ = bytes / part.rows.count;
    if (bytes == row_bytes_ * part.rows.count) return;
    file.fail_whole(fmt::format("its rows have {} bytes, and should have {}", bytes, row_bytes_ * part.rows.count));
  }

 private:
  static constexpr std::string_view before_descr = "'descr': ";
  static constexpr std::string_view after_descr = ", 'fortran_order'";
  std::string descr_;
  std::uint64_t bytes_ = 0;
  std::uint64_t row_bytes_ = 0;
};

std::unique_ptr<PartForm> form_of(const GivenPart& given) {
  const std::string name = setting(given.part, "format");
  if (name == ".csv") return std::make_unique<CsvForm>();
  if (name == ".npy") return std::make_unique<NpyForm>();
  refuse_file(given.path.string(), fmt::format("format is {}: parts are .csv, .npy or .vtp", in_quotes(name)));
}

void refuse_other_bytes(const GivenPart& given, std::string_view digest) {
  if (digest == given.part.map.sha256) return;
  refuse_file(given.path.string(),
              fmt::format("is not the file that was written: its SHA-256 is {}, and {} says {}", digest,
                          part_file_of(given.path).filename().string(), given.part.map.sha256));
}

/// The parts stay where they are.
void name_drawn_parts(const std::vector<GivenPart>& parts, const std::filesystem::path& output) {
  if (lower_case(output.extension().string()) != ".pvtp") {
    refuse_file(output.string(), "the whole of .vtp parts is a .pvtp, which names them");
  }
  std::vector<std::string> sources;
  for (const GivenPart& given : parts) {
    refuse_other_bytes(given, digest_of_file(given.path).sha256);
    sources.push_back(std::filesystem::proximate(given.path, std::filesystem::absolute(output).parent_path()).string());
  }
  OutputFile file(output);
  file.write(pvtp_document(sources, setting(parts.front().part, "closest_points") == "yes"));
  file.finish();
}

/// A damaged part is found out before the whole has a name.
void copy_rows(const GivenPart& given, PartForm& form, OutputFile& output, bool first, std::uint64_t rows_in_all) {
  constexpr std::size_t block = std::size_t{1} << 16U;
  InputFile file(given.path);
  Sha256 hash;
  const std::string header = form.take_header(file, given.part);
  hash.add(std::as_bytes(std::span(header)));
  if (first) output.write(form.header(rows_in_all));
  for (;;) {
    const std::string_view bytes = file.peek(block);
    if (bytes.empty()) break;
    hash.add(std::as_bytes(std::span(bytes)));
    form.count(bytes);
    output.write(bytes);
    (void)file.take(bytes.size(), "the rows");
  }
  form.check_rows(file, given.part);
  refuse_other_bytes(given, hash.digest());
}

void copy_parts(const std::vector<GivenPart>& parts, const std::filesystem::path& output) {
  const std::unique_ptr<PartForm> form = form_of(parts.front());
  if (lower_case(output.extension().string()) == ".pvtp") refuse_file(output.string(), "is of .vtp parts alone");
  OutputFile file(output);
  for (const GivenPart& given : parts) copy_rows(given, *form, file, &given == &parts.front(), given.part.rows_in_all);
  file.finish();
}

void add_to(MapPart& whole, const MapPart& part) {
  MapSummary& sum = whole.summary;
  const MapSummary& more = part.summary;
  sum.points += more.points;
  sum.device_verified += more.device_verified;
  sum.host_verified += more.host_verified;
  sum.wide += more.wide;
  sum.wide_inside += more.wide_inside;
  sum.minimum_lo = std::min(sum.minimum_lo, more.minimum_lo);
  sum.minimum_hi = std::min(sum.minimum_hi, more.minimum_hi);
  sum.largest_width = std::max(sum.largest_width, more.largest_width);
  sum.device_seconds += more.device_seconds;
  sum.host_seconds += more.host_seconds;
  if (!part.closest) return;
  ClosestPointSummary closest = whole.closest.value_or(ClosestPointSummary{});
  closest.points += part.closest->points;
  closest.unique += part.closest->unique;
  closest.widest_point = std::max(closest.widest_point, part.closest->widest_point);
  closest.widest_normal = std::max(closest.widest_normal, part.closest->widest_normal);
  whole.closest = closest;
}

MergedMap summed_up(const std::vector<GivenPart>& parts) {
  MergedMap merged{parts.front().part, {}};
  MapPart& whole = merged.whole;
  whole.part = whole.parts = 1;
  whole.rows = {0, whole.rows_in_all};
  whole.summary = {};
  whole.summary.minimum_lo = whole.summary.minimum_hi = infinity;
  whole.closest.reset();
  for (const GivenPart& given : parts) {
    add_to(whole, given.part);
    const std::string& device = given.part.summary.device;
    if (given.part.rows.count > 0 && std::ranges::find(merged.devices, device) == merged.devices.end()) {
      merged.devices.push_back(device);
    }
  }
  whole.summary.device = merged.devices.empty() ? std::string() : fmt::format("{}", fmt::join(merged.devices, ", "));
  return merged;
}

void refuse_to_replace_a_part(std::span<const std::filesystem::path> parts, const std::filesystem::path& output) {
  for (const std::filesystem::path& part : parts) {
    std::error_code missing;  // what does not exist is not replaced
    if (std::filesystem::equivalent(part, output, missing)) refuse_file(output.string(), "is a part itself");
  }
}

}  // namespace

MergedMap merge_maps(std::span<const std::filesystem::path> paths, const std::filesystem::path& output,
                     const MergeOptions& options) {
  refuse_to_replace_a_part(paths, output);
  const std::vector<GivenPart> parts = read_parts(paths);
  const auto* with_rows = &parts.front();
  for (const GivenPart& given : parts) {
    if (with_rows->part.rows.count == 0) with_rows = &given;
  }
  for (const GivenPart& given : parts) refuse_other_work(given, *with_rows, options);
  refuse_gaps_and_overlaps(parts);
  if (setting(parts.front().part, "format") == ".vtp") {
    name_drawn_parts(parts, output);
  } else {
    copy_parts(parts, output);
  }
  MergedMap merged = summed_up(parts);
  merged.whole.map = {output.filename().string(), std::string()};
  return merged;
}

}  // namespace verisq
