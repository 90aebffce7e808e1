/// Maps as NumPy arrays (`.npy`): a row of named fields, little-endian and packed, for each point, triangle or pose.
#include <fmt/format.h>

#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "host/files/byte_order.hpp"
#include "host/files/map_columns.hpp"
#include "host/files/map_format.hpp"
#include "host/files/npy_header.hpp"
#include "host/threads/parallel.hpp"
#include "host/threads/pieces.hpp"

namespace verisq {
namespace {

/// Rows that are worth a thread.
constexpr std::size_t fewest_array_rows = 8192;

/// As NumPy names it; indices and numbers have eight bytes.
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
    // What is written on the way can be corrected later, or is right from the beginning.
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
