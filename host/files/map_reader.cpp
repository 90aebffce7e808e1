/// The rows of maps of map_layout.hpp: in CSV, and in any format by the extension of the file.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <new>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>
#include <verisq/error.hpp>
#include <verisq/map_file.hpp>

#include "host/files/input_file.hpp"
#include "host/files/map_layout.hpp"
#include "host/files/words.hpp"
#include "verisq/enclosure.hpp"

namespace verisq {
namespace {

/// The digits that distinguish the unfinished files of runs, with the dot before them: see OutputFile.
bool is_of_a_run(std::string_view extension) {
  return extension.size() == 9 && extension.find_first_not_of("0123456789abcdef", 1) == std::string_view::npos;
}

/// The name of a map: OUT, or the rest that an interrupted run left, OUT.partial, or a killed one,
/// OUT.1a2b3c4d.partial.
struct MapName {
  explicit MapName(std::filesystem::path name) {
    std::string last = lower_case(name.extension().string());
    if (last == ".partial") {
      extent = MapExtent::part;
      name = name.stem();
      killed = is_of_a_run(name.extension().string());
      if (killed) name = name.stem();
      last = lower_case(name.extension().string());
    }
    format = last;
  }

  std::string format;  ///< ".csv"
  MapExtent extent = MapExtent::whole;
  bool killed = false;
};

std::unique_ptr<MapRows> open_map(const std::filesystem::path& path) {
  const auto refuse = [&](std::string_view why) {
    throw Error(ErrorKind::input, fmt::format("{}: {}", path.string(), why));
  };
  const MapName name(path);
  if (name.format == ".csv") return open_csv_map(path, name.extent);
  if (name.format == ".vtp") {
    if (name.extent == MapExtent::whole) return open_vtp_map(path);
    if (name.killed) refuse("what a killed run left of a .vtp, which is written when all is known: map again");
  }
  refuse(fmt::format("a map as {}: check reads .csv and .vtp", in_quotes(lower_case(path.extension().string()))));
  return {};
}

}  // namespace

class MapReader::Format {
 public:
  explicit Format(const std::filesystem::path& path)
      : partial_(MapName(path).extent == MapExtent::part), rows_(open_map(path)) {}
  [[nodiscard]] bool partial() const { return partial_; }
  [[nodiscard]] MapRows& rows() const { return *rows_; }

 private:
  bool partial_;
  std::unique_ptr<MapRows> rows_;
};

MapReader::MapReader(const std::filesystem::path& path) try : format_(hidden<Format>(path)) {
} catch (const std::bad_alloc&) {
  throw Error(ErrorKind::failure, fmt::format("{}: not enough memory for this map", path.string()));
}

MapElements MapReader::elements() const {
  return format_->rows().elements();
}

bool MapReader::partial() const {
  return format_->partial();
}

std::size_t MapReader::read(std::span<CertifiedRow> rows) {
  return format_->rows().read(rows);
}

bool MapReader::draws() const {
  return format_->rows().draws();
}

std::optional<MapDifference> MapReader::difference_from(const Mesh& mesh) const {
  return format_->rows().difference_from(mesh);
}

namespace {

constexpr std::size_t fields_of(std::string_view line) {
  return static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')) + 1;
}

/// The last part is the text after the first N - 1 separators. Precondition: the text has that many.
template <std::size_t N>
std::array<std::string_view, N> split(std::string_view text, char separator) {
  std::array<std::string_view, N> parts;
  for (std::size_t k = 0; k < N - 1; ++k) {
    const std::size_t length = text.find(separator);
    parts[k] = text.substr(0, length);
    text.remove_prefix(length + 1);
  }
  parts.back() = text;
  return parts;
}

class CsvRows final : public MapRows {
 public:
  CsvRows(const std::filesystem::path& path, MapExtent extent)
      : file_(path), extent_(extent), elements_(read_header()) {}

  [[nodiscard]] MapElements elements() const override { return elements_; }

  std::size_t read(std::span<CertifiedRow> rows) override {
    std::size_t count = 0;
    while (count < rows.size()) {
      const std::optional<std::string_view> line = file_.next_line();
      if (!line || was_being_written()) break;
      read_row(*line, rows[count++]);
    }
    return count;
  }

 private:
  /// Returns whether the run was killed within the line read last.
  [[nodiscard]] bool was_being_written() const { return extent_ == MapExtent::part && !file_.line_has_end(); }

  MapElements read_header() {
    const std::string_view header = file_.next_line().value_or("");
    covered_ = header == csv_covered_map_header || header == csv_covered_triangle_map_header;
    if (header == csv_certified_header(MapElements::vertices, covered_)) return MapElements::vertices;
    if (header == csv_certified_header(MapElements::triangles, covered_)) return MapElements::triangles;
    if (header == csv_map_header) file_.fail(without_certificates);
    file_.fail(fmt::format("{}: not the header of a map: expected {}; of triangles {}", in_quotes(header),
                           csv_certified_map_header, csv_certified_triangle_map_header));
  }

  /// A last line that was cut short has too few fields, or a shorter number in the last one: its enclosure is whole.
  void read_row(std::string_view line, CertifiedRow& row) {
    check_fields(line);
    const auto [index, lo, hi, status, primitive, normal_x, normal_y, normal_z, further_normals, rest] =
        split<10>(line, ',');
    check_index(index);
    row.result = {{end(lo, "lo"), end(hi, "hi")}, status_of(status)};
    row.certificate = {};
    std::vector<Normal>& normals = row.certificate.normals;
    if (const auto vector = optional_numbers<3>({normal_x, normal_y, normal_z}, {"normal_x", "normal_y", "normal_z"})) {
      normals.push_back({primitive_of(primitive), *vector});
      read_further_normals(further_normals, normals);
    } else {
      expect_none(primitive, "primitive");
      expect_none(further_normals, "further_normals");
    }
    if (elements_ == MapElements::vertices) {
      const auto [x, y, z, further] = split<4>(rest, ',');
      row.certificate.escape = optional_numbers<3>({x, y, z}, {"escape_x", "escape_y", "escape_z"});
      if (covered_) read_cover(further, row.certificate);
    } else {
      const auto [first, second, further] = split<3>(rest, ',');
      row.certificate.weights = optional_numbers<2>({first, second}, {"weight_1", "weight_2"});
      if (covered_) read_cover(further, row.certificate);
    }
  }

  /// Witness and cover.
  void read_cover(std::string_view text, Certificate& certificate) const {
    const auto [x, y, z, digits] = split<4>(text, ',');
    certificate.witness = optional_numbers<3>({x, y, z}, {"witness_x", "witness_y", "witness_z"});
    if (digits.empty()) return;
    std::optional<std::vector<bool>> cover = cover_from(digits);
    if (!cover) file_.fail(fmt::format("cover = {}: not the digits of a whole cover", in_quotes(digits)));
    certificate.cover = *std::move(cover);
  }

  void check_fields(std::string_view line) const {
    const std::size_t fields = fields_of(line);
    const std::size_t expected = fields_of(csv_certified_header(elements_, covered_));
    if (fields == expected) return;
    file_.fail(fmt::format("{}: {} fields, expected {}", in_quotes(line), fields, expected));
  }

  void check_index(std::string_view word) {
    const std::int64_t index = integer(file_, word, "index");
    if (index != next_index_) file_.fail(fmt::format("index = {}: expected {}", in_quotes(word), next_index_));
    ++next_index_;
  }

  [[nodiscard]] double end(std::string_view word, std::string_view what) const {
    if (word == "inf") return infinity;
    if (word == "-inf") return -infinity;
    return finite_number(file_, word, what);
  }

  [[nodiscard]] Status status_of(std::string_view word) const {
    for (const Status status : {Status::device_verified, Status::host_verified, Status::wide}) {
      if (word == to_string(status)) return status;
    }
    file_.fail(fmt::format("status = {}: not one of device-verified, host-verified, wide", in_quotes(word)));
  }

  [[nodiscard]] std::uint32_t primitive_of(std::string_view word) const {
    const std::int64_t index = integer(file_, word, "primitive");
    if (0 <= index && index <= std::numeric_limits<std::uint32_t>::max()) return static_cast<std::uint32_t>(index);
    file_.fail(fmt::format("primitive = {}: not an index of a primitive", in_quotes(word)));
  }

  /// Nothing if all words are empty.
  template <std::size_t N>
  [[nodiscard]] std::optional<std::array<double, N>> optional_numbers(
      const std::array<std::string_view, N>& words, const std::array<std::string_view, N>& names) const {
    if (std::all_of(words.begin(), words.end(), [](std::string_view word) { return word.empty(); })) {
      return std::nullopt;
    }
    return numbers<N>(words, names);
  }

  template <std::size_t N>
  [[nodiscard]] std::array<double, N> numbers(const std::array<std::string_view, N>& words,
                                              const std::array<std::string_view, N>& names) const {
    std::array<double, N> result{};
    for (std::size_t k = 0; k < N; ++k) result[k] = finite_number(file_, words[k], names[k]);
    return result;
  }

  void read_further_normals(std::string_view text, std::vector<Normal>& normals) const {
    for (Words words(text); !words.empty();) {
      const std::string_view word = words.next();
      if (std::count(word.begin(), word.end(), ':') != 3) {
        file_.fail(fmt::format("further_normals: {}: expected primitive:x:y:z", in_quotes(word)));
      }
      const auto [primitive, x, y, z] = split<4>(word, ':');
      normals.push_back({primitive_of(primitive), numbers<3>({x, y, z}, {"x", "y", "z"})});
    }
  }

  void expect_none(std::string_view word, std::string_view what) const {
    if (!word.empty()) file_.fail(fmt::format("{} = {}: without a first normal", what, in_quotes(word)));
  }

  InputFile file_;
  MapExtent extent_;
  bool covered_ = false;  ///< set by reading the header: declared before
  MapElements elements_;
  std::int64_t next_index_ = 0;
};

}  // namespace

std::unique_ptr<MapRows> open_csv_map(const std::filesystem::path& path, MapExtent extent) {
  return std::make_unique<CsvRows>(path, extent);
}

}  // namespace verisq
