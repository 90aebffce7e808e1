/// Maps as CSV: a row "index,lo,hi,status", or of other columns, for each point, triangle or pose, and its certificate
/// when asked for, streamed to the disk.
#include <fmt/compile.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "host/files/cover_digits.hpp"
#include "host/files/csv_map_header.hpp"
#include "host/files/map_columns.hpp"
#include "host/files/map_format.hpp"
#include "host/files/shortest_digits.hpp"
#include "host/threads/parallel.hpp"
#include "host/threads/pieces.hpp"

namespace verisq {
namespace {

/// Rows that are worth a thread.
constexpr std::size_t fewest_rows = 4096;

/// Room for the longest field of a column, "-2.2250738585072014e-308" for instance, and the comma or line end after it.
constexpr std::size_t longest_field = 32;

// As a format of a number "{}" is the shortest text that gives back the same binary64.

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

}  // namespace verisq
