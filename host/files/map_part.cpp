/// Parts of maps: the format `verisq-part/1` beside them (docs/formats.md §10), and the whole made of all.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <verisq/error.hpp>
#include <verisq/map_file.hpp>

#include "host/errors/refusal.hpp"
#include "host/files/certificate_archive.hpp"
#include "host/files/input_file.hpp"
#include "host/files/json_document.hpp"
#include "host/files/npy_header.hpp"
#include "host/files/output_file.hpp"
#include "host/files/words.hpp"

namespace verisq {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr std::string_view part_format = "verisq-part/1";

/// The same limit as for a model file.
constexpr std::size_t largest_part_file = std::size_t{1} << 26;

std::string_view word_of(MapElements elements) {
  switch (elements) {
    case MapElements::vertices: return "points";
    case MapElements::triangles: return "triangles";
    case MapElements::poses: break;
  }
  return "poses";
}

/// The smallest distance of no rows is infinite, and so is the width of unbounded rows.
OrderedJson json_of_number(double number) {
  if (std::isfinite(number)) return number;
  return number > 0.0 ? "inf" : "-inf";
}

OrderedJson json_of_summary(const MapPart& part) {
  const MapSummary& summary = part.summary;
  OrderedJson json{{"device", summary.device},
                   {"device_verified", summary.device_verified},
                   {"host_verified", summary.host_verified},
                   {"wide", summary.wide},
                   {"wide_inside", summary.wide_inside},
                   {"smallest_lo", json_of_number(summary.minimum_lo)},
                   {"smallest_hi", json_of_number(summary.minimum_hi)},
                   {"largest_width", json_of_number(summary.largest_width)},
                   {"device_seconds", summary.device_seconds},
                   {"host_seconds", summary.host_seconds}};
  if (part.closest) {
    json["unique_closest_points"] = part.closest->unique;
    json["widest_closest_point"] = json_of_number(part.closest->widest_point);
    json["widest_normal"] = json_of_number(part.closest->widest_normal);
  }
  return json;
}

std::uint64_t whole_number(const JsonValue& value) {
  if (!value.json().is_number_unsigned()) value.fail("must be a whole number");
  return value.json().get<std::uint64_t>();
}

MapElements read_elements(const JsonValue& value) {
  const std::string word = value.text();
  for (const MapElements elements : {MapElements::vertices, MapElements::triangles, MapElements::poses}) {
    if (word == word_of(elements)) return elements;
  }
  value.fail("must be \"points\", \"triangles\" or \"poses\"");
}

std::vector<PartSetting> read_settings(const JsonValue& value) {
  if (!value.json().is_object()) value.fail("must be an object");
  std::vector<PartSetting> settings;
  for (const auto& [name, unused] : value.json().items()) settings.push_back({name, value.at(name).text()});
  return settings;
}

void read_summary(const JsonValue& value, MapPart& part) {
  value.check_keys({"device", "device_verified", "host_verified", "wide", "wide_inside", "smallest_lo", "smallest_hi",
                    "largest_width", "device_seconds", "host_seconds", "unique_closest_points", "widest_closest_point",
                    "widest_normal"});
  MapSummary& summary = part.summary;
  summary.device = value.at("device").text();
  summary.points = part.rows.count;
  summary.device_verified = whole_number(value.at("device_verified"));
  summary.host_verified = whole_number(value.at("host_verified"));
  summary.wide = whole_number(value.at("wide"));
  summary.wide_inside = whole_number(value.at("wide_inside"));
  summary.minimum_lo = value.at("smallest_lo").number_or_infinity();
  summary.minimum_hi = value.at("smallest_hi").number_or_infinity();
  summary.largest_width = value.at("largest_width").number_or_infinity();
  summary.device_seconds = value.at("device_seconds").number();
  summary.host_seconds = value.at("host_seconds").number();
  if (summary.device_verified + summary.host_verified + summary.wide != part.rows.count) {
    value.at("wide").fail("the counts must add up to the rows");
  }
  if (const auto unique = value.find("unique_closest_points")) {
    part.closest = ClosestPointSummary{.points = part.rows.count,
                                       .unique = whole_number(*unique),
                                       .widest_point = value.at("widest_closest_point").number_or_infinity(),
                                       .widest_normal = value.at("widest_normal").number_or_infinity()};
  }
}

MapPart parse_map_part(std::string_view text, std::string_view name) {
  const nlohmann::json document = parse_json(text, name);
  const JsonValue root(document, name);
  if (!root.json().is_object()) root.fail("must be an object");
  if (const JsonValue format = root.at("format"); format.text() != part_format) {
    format.fail(fmt::format("must be \"{}\"", part_format));
  }
  root.check_keys(
      {"format", "version", "part", "parts", "rows", "map", "models", "elements", "input", "settings", "summary"});
  MapPart part;
  part.version = root.at("version").text();
  part.part = whole_number(root.at("part"));
  part.parts = whole_number(root.at("parts"));
  if (part.part == 0 || part.part > part.parts) root.at("part").fail("must be from 1 to the number of parts");
  const JsonValue rows = root.at("rows");
  rows.check_keys({"first", "count", "in_all"});
  part.rows = {whole_number(rows.at("first")), whole_number(rows.at("count"))};
  part.rows_in_all = whole_number(rows.at("in_all"));
  if (part.rows != rows_of_part(part.part, part.parts, part.rows_in_all)) {
    rows.at("first").fail(fmt::format("these are not the rows of part {} of {}", part.part, part.parts));
  }
  describe(certificates::ReadingArchive(root.at("map")), part.map);
  describe(certificates::ReadingArchive(root.at("models")), part.models);
  part.elements = read_elements(root.at("elements"));
  describe(certificates::ReadingArchive(root.at("input")), part.input);
  part.settings = read_settings(root.at("settings"));
  read_summary(root.at("summary"), part);
  return part;
}

}  // namespace

RowRange rows_of_part(std::uint64_t part, std::uint64_t parts, std::uint64_t rows) {
  const std::uint64_t blocks = rows / rows_per_block + (rows % rows_per_block != 0 ? 1 : 0);
  const std::uint64_t each = blocks / parts;
  const std::uint64_t more = blocks % parts;  // so many parts have one more
  const auto start = [&](std::uint64_t before) {
    return std::min((before * each + std::min(before, more)) * rows_per_block, rows);
  };
  return {start(part - 1), start(part) - start(part - 1)};
}

std::filesystem::path part_file_of(const std::filesystem::path& map) {
  std::filesystem::path path = map;
  path += ".part.json";
  return path;
}

SubjectFile digest_of_file(const std::filesystem::path& path) {
  if (!std::filesystem::is_regular_file(path)) {
    InputFile(path).fail_whole("no regular file, which parts of a map must be of");
  }
  return subject_file(path);
}

void write_map_part(const std::filesystem::path& map, const MapPart& part) {
  OrderedJson document{{"format", part_format}, {"version", part.version}, {"part", part.part}, {"parts", part.parts}};
  document["rows"] = {{"first", part.rows.first}, {"count", part.rows.count}, {"in_all", part.rows_in_all}};
  describe(certificates::WritingArchive(document["map"]), part.map);
  describe(certificates::WritingArchive(document["models"]), part.models);
  document["elements"] = word_of(part.elements);
  describe(certificates::WritingArchive(document["input"]), part.input);
  document["settings"] = OrderedJson::object();
  for (const auto& [name, value] : part.settings) document["settings"][name] = value;
  document["summary"] = json_of_summary(part);
  OutputFile file(part_file_of(map));
  file.write(document.dump(2, ' ', false, OrderedJson::error_handler_t::replace) + "\n");
  file.finish();
}

MapPart read_map_part(const std::filesystem::path& map) {
  const std::filesystem::path description = part_file_of(map);
  std::error_code none;
  if (std::filesystem::exists(map, none) && !std::filesystem::exists(description, none)) {
    throw Error(ErrorKind::input, fmt::format("{}: no such file: {} is no part of a map, as `part` writes them",
                                              description.string(), map.string()));
  }
  InputFile file(description);
  const std::string_view text = file.peek_text(largest_part_file + 1);
  if (text.size() > largest_part_file) {
    file.fail_whole(fmt::format("larger than {} bytes: not what stands beside a part", largest_part_file));
  }
  return parse_map_part(text, file.name());
}

namespace {

std::string in_attribute(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&': escaped += "&amp;"; break;
      case '<': escaped += "&lt;"; break;
      case '"': escaped += "&quot;"; break;
      case '\t':
      case '\n':
      case '\r': escaped += fmt::format("&#{};", static_cast<int>(c)); break;  // else a blank to the reader
      default: escaped += c;
    }
  }
  return escaped;
}

std::string array(std::string_view type, std::string_view name, int components) {
  return fmt::format("      <PDataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\"/>\n", type, name, components);
}

std::string results(bool closest_points) {
  std::string text;
  for (const char* const name : {"dist_lo", "dist_hi", "dist_mid"}) text += array("Float64", name, 1);
  text += array("UInt8", "status", 1);
  if (!closest_points) return text;
  text += array("UInt8", "unique", 1);
  for (const char* const name : {"closest_lo", "closest_hi", "normal_lo", "normal_hi", "normal"})
    text += array("Float64", name, 3);
  return text + array("Int32", "primitive", 1);
}

/// The whole file. `sources` are the pieces, relative to it; `closest_points`: whether they have closest points.
std::string pvtp_document(std::span<const std::string> sources, bool closest_points) {
  std::string text =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"PPolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      "  <PPolyData GhostLevel=\"0\">\n";
  text += fmt::format("    <PPointData Scalars=\"dist_mid\"{}>\n{}    </PPointData>\n",
                      closest_points ? " Vectors=\"normal\"" : "", results(closest_points));
  text += fmt::format("    <PPoints>\n{}    </PPoints>\n", array("Float64", "Points", 3));
  for (const std::string& source : sources) text += fmt::format("    <Piece Source=\"{}\"/>\n", in_attribute(source));
  return text + "  </PPolyData>\n</VTKFile>\n";
}

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
  return fmt::format("{} (SHA-256 {})", quotation(file.name), file.sha256);
}

/// Compares the files by their bytes: a file may have had another name.
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
  // A part without rows has none of a device.
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

/// The header before the first row, and the form of the rows: a class for each format.
class PartForm {
 public:
  PartForm() = default;
  PartForm(const PartForm&) = delete;
  PartForm& operator=(const PartForm&) = delete;
  virtual ~PartForm() = default;

  /// Takes the header from the front of `file`; refuses a file that is no such part, or has another header than the
  /// parts before.
  virtual std::string take_header(InputFile& file, const MapPart& part) = 0;
  /// The header of the whole map.
  [[nodiscard]] virtual std::string header(std::uint64_t rows) const = 0;
  /// Counts the rows in the next bytes of the part.
  virtual void count(std::string_view bytes) = 0;
  /// Refuses a number of rows other than the part's; resets the count.
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
