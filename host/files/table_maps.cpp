/// Maps as tables: CSV, JSON and NumPy arrays, streamed to the disk.
#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "host/files/input_file.hpp"
#include "host/files/map_file.hpp"
#include "host/files/map_layout.hpp"
#include "host/files/npy_header.hpp"
#include "host/threads/parallel.hpp"

namespace verisq {
namespace {

/// Rows that are worth a thread.
constexpr std::size_t fewest_rows = 4096;

/// Room for the longest field of a column, "-2.2250738585072014e-308" for instance, and the comma or line end after it.
constexpr std::size_t longest_field = 32;

// As a format of a number, "{}" gives the shortest text that reads back as the same binary64.

/// A field for each number, each after a comma; empty ones where there are none.
template <std::size_t N>
void append_fields(fmt::memory_buffer& text, const std::optional<std::array<double, N>>& numbers) {
  for (std::size_t k = 0; k < N; ++k) {
    text.push_back(',');
    if (numbers) fmt::format_to(std::back_inserter(text), FMT_COMPILE("{}"), (*numbers)[k]);
  }
}

/// The certificate's fields, each after a comma.
void append_certificate(fmt::memory_buffer& text, const Certificate& certificate, const MapKind& kind) {
  const auto end = std::back_inserter(text);
  if (certificate.normals.empty()) {
    fmt::format_to(end, FMT_COMPILE(",,,,,"));
  } else {
    const auto& [primitive, vector] = certificate.normals.front();
    fmt::format_to(end, FMT_COMPILE(",{},{},{},{},"), primitive, vector[0], vector[1], vector[2]);
  }
  for (std::size_t k = 1; k < certificate.normals.size(); ++k) {
    const auto& [primitive, vector] = certificate.normals[k];
    fmt::format_to(end, FMT_COMPILE("{}{}:{}:{}:{}"), k == 1 ? "" : " ", primitive, vector[0], vector[1], vector[2]);
  }
  if (kind.elements == MapElements::vertices) {
    append_fields(text, certificate.escape);
  } else {
    append_fields(text, certificate.weights);
  }
  if (kind.contents != MapContents::covered) return;
  append_fields(text, certificate.witness);
  fmt::format_to(end, FMT_COMPILE(",{}"), digits_of_cover(certificate.cover));
}

std::vector<MapColumn> columns_of(const MapKind& kind) {
  if (!kind.columns.empty()) return kind.columns;
  std::vector<MapColumn> columns{MapColumn::index, MapColumn::lo, MapColumn::hi, MapColumn::status};
  if (kind.contents == MapContents::closest_points) {
    for (const MapColumn column : columns_of_closest_points(kind.elements)) columns.push_back(column);
  }
  return columns;
}

std::string header(const MapKind& kind) {
  if (has_certificates(kind.contents)) {
    return std::string(csv_certified_header(kind.elements, kind.contents == MapContents::covered));
  }
  std::string names;
  for (const MapColumn column : columns_of(kind))
    names += fmt::format("{}{}", names.empty() ? "" : ",", to_string(column));
  return names;
}

char* put(std::string_view text, char* at) {
  return std::copy(text.begin(), text.end(), at);
}

char* put_field(MapColumn column, const MapRow& row, char* at) {
  switch (column) {
    case MapColumn::index: return fmt::format_to(at, FMT_COMPILE("{}"), row.index);
    case MapColumn::status: return put(to_string(row.result.status), at);
    case MapColumn::unique: return put(is_unique(row) ? "1" : "0", at);
    case MapColumn::primitive: return fmt::format_to(at, FMT_COMPILE("{}"), primitive_in(*row.closest));
    default: return put_shortest_digits(number_in(column, row), at);
  }
}

class CsvMap final : public MapFormat {
 public:
  CsvMap(OutputFile& output, const MapKind& kind) : output_(output), kind_(kind) {
    output_.write(header(kind));
    output_.write("\n");
    output_.flush();
    kind_.columns = columns_of(kind);
  }

  void append(const MapChunk& chunk) override {
    const AppendedRows rows(kind_.mesh, kind_.elements, kind_.first_row + count_, chunk);
    const std::vector<Piece> pieces = pieces_of(rows.size(), fewest_rows);
    if (texts_.size() < pieces.size()) texts_.resize(pieces.size());
    in_parallel(pieces.size(), [&](std::size_t p) {
      texts_[p].clear();
      for (std::size_t k = pieces[p].first; k < pieces[p].first + pieces[p].count; ++k) {
        append_row(texts_[p], rows[k]);
        if (has_certificates(kind_.contents)) append_certificate(texts_[p], chunk.certificates[k], kind_);
        texts_[p].push_back('\n');
      }
    });
    for (const fmt::memory_buffer& text : std::span(texts_).first(pieces.size())) {
      output_.write({text.data(), text.size()});
    }
    count_ += rows.size();
    output_.flush();  // a killed run leaves all rows that are finished
  }

  void finish() override {}
  [[nodiscard]] bool valid_after_any_row() const override { return true; }

 private:
  void append_row(fmt::memory_buffer& text, const MapRow& row) const {
    const std::size_t before = text.size();
    text.resize(before + kind_.columns.size() * longest_field);
    char* at = text.data() + before;
    for (const MapColumn column : kind_.columns) {
      at = put_field(column, row, at);
      *at++ = ',';
    }
    text.resize(static_cast<std::size_t>(at - text.data()) - 1);  // no comma after the last
  }

  OutputFile& output_;
  MapKind kind_;
  std::uint64_t count_ = 0;
  std::vector<fmt::memory_buffer> texts_;  // of the pieces of one call, and some of earlier ones: room for the next
};

}  // namespace

std::unique_ptr<MapFormat> make_csv_map(OutputFile& output, const MapKind& kind) {
  return std::make_unique<CsvMap>(output, kind);
}

namespace {

/// JSON has no infinities: an infinite end is the string "inf" or "-inf", never null, which would mean "no answer".
void append_end(fmt::memory_buffer& text, double value) {
  if (std::isfinite(value)) {
    fmt::format_to(std::back_inserter(text), FMT_COMPILE("{}"), value);
  } else {
    fmt::format_to(std::back_inserter(text), FMT_COMPILE("\"{}\""), value);
  }
}

class JsonMap final : public MapFormat {
 public:
  JsonMap(OutputFile& output, MapElements elements) : output_(output) {
    output_.write("{\"format\": \"verisq-map/1\",\n ");
    if (elements == MapElements::triangles) output_.write("\"elements\": \"triangles\",\n ");
    if (elements == MapElements::poses) output_.write("\"elements\": \"poses\",\n ");
    output_.write("\"results\": [");
  }

  void append(const MapChunk& chunk) override {
    rows_.clear();
    for (const MapResult& result : chunk.results) {
      fmt::format_to(std::back_inserter(rows_), FMT_COMPILE("{}\n  {{\"index\": {}, \"lo\": "), index_ == 0 ? "" : ",",
                     index_);
      append_end(rows_, result.distance.lo);
      fmt::format_to(std::back_inserter(rows_), FMT_COMPILE(", \"hi\": "));
      append_end(rows_, result.distance.hi);
      fmt::format_to(std::back_inserter(rows_), FMT_COMPILE(", \"status\": \"{}\"}}"), to_string(result.status));
      ++index_;
    }
    output_.write({rows_.data(), rows_.size()});
  }

  void finish() override { output_.write("\n ]}\n"); }

 private:
  OutputFile& output_;
  std::uint64_t index_ = 0;
  fmt::memory_buffer rows_;  // of one call
};

}  // namespace

std::unique_ptr<MapFormat> make_json_map(OutputFile& output, const MapKind& kind) {
  return std::make_unique<JsonMap>(output, kind.elements);
}

namespace {

/// Rows that are worth a thread.
constexpr std::size_t fewest_array_rows = 8192;

/// NumPy's name of the type; indices and numbers have eight bytes.
std::string_view type_of(MapColumn column) {
  if (column == MapColumn::status || column == MapColumn::unique) return "|u1";
  if (column == MapColumn::primitive) return "<i4";
  return column == MapColumn::index ? "<u8" : "<f8";
}

std::size_t bytes_of(MapColumn column) {
  if (column == MapColumn::status || column == MapColumn::unique) return 1;
  return column == MapColumn::primitive ? 4 : 8;
}

std::string descr_of(std::span<const MapColumn> columns) {
  std::string descr;
  for (const MapColumn column : columns) {
    descr += fmt::format("{}('{}', '{}')", descr.empty() ? "" : ", ", to_string(column), type_of(column));
  }
  return "[" + descr + "]";
}

std::vector<MapColumn> usual_columns(const MapKind& kind) {
  std::vector<MapColumn> columns{MapColumn::lo, MapColumn::hi, MapColumn::status};
  if (kind.contents == MapContents::closest_points) {
    for (const MapColumn column : columns_of_closest_points(kind.elements)) columns.push_back(column);
  }
  return columns;
}

char* put(auto number, char* at) {
  const auto stored = in_little_endian(number);
  std::memcpy(at, &stored, sizeof stored);
  return at + sizeof stored;
}

class NpyMap final : public MapFormat {
 public:
  NpyMap(OutputFile& output, const MapKind& kind) : output_(output), kind_(kind) {
    if (kind_.columns.empty()) kind_.columns = usual_columns(kind);
    for (const MapColumn column : kind_.columns) row_bytes_ += bytes_of(column);
    descr_ = descr_of(kind_.columns);
    // The header can be corrected later, or is right from the beginning.
    output_.write(npy_header(descr_, output_.can_be_rewritten() ? 0 : kind_.rows.value_or(0)));
  }

  void append(const MapChunk& chunk) override {
    const AppendedRows rows(kind_.mesh, kind_.elements, kind_.first_row + count_, chunk);
    bytes_.resize(rows.size() * row_bytes_);
    const std::vector<Piece> pieces = pieces_of(rows.size(), fewest_array_rows);
    in_parallel(pieces.size(), [&](std::size_t p) {
      char* at = bytes_.data() + pieces[p].first * row_bytes_;
      for (std::size_t k = 0; k < pieces[p].count; ++k) at = put_row(rows[pieces[p].first + k], at);
    });
    output_.write({bytes_.data(), bytes_.size()});
    count_ += rows.size();
    if (!output_.can_be_rewritten()) return;
    output_.flush();  // a killed run leaves an array of all rows that are finished
    output_.write_at(0, npy_header(descr_, count_));
  }

  void finish() override {
    if (output_.can_be_rewritten() || count_ == kind_.rows) return;
    output_.fail(fmt::format("{} rows, and the header promised {}", count_, kind_.rows.value_or(0)));
  }
  [[nodiscard]] bool valid_after_any_row() const override { return output_.can_be_rewritten(); }

 private:
  char* put_row(const MapRow& row, char* at) const {
    for (const MapColumn column : kind_.columns) {
      switch (column) {
        case MapColumn::index: at = put(row.index, at); break;
        case MapColumn::status: at = put(static_cast<std::uint8_t>(row.result.status), at); break;
        case MapColumn::unique: at = put(static_cast<std::uint8_t>(is_unique(row)), at); break;
        case MapColumn::primitive: at = put(primitive_in(*row.closest), at); break;
        default: at = put(number_in(column, row), at);
      }
    }
    return at;
  }

  OutputFile& output_;
  MapKind kind_;
  std::string descr_;
  std::size_t row_bytes_ = 0;
  std::uint64_t count_ = 0;
  std::vector<char> bytes_;  // of one call
};

}  // namespace

std::unique_ptr<MapFormat> make_npy_map(OutputFile& output, const MapKind& kind) {
  return std::make_unique<NpyMap>(output, kind);
}

}  // namespace verisq
