/// Maps as CSV: a row "index,lo,hi,status" for each point, triangle or pose, and its certificate when asked for,
/// streamed to the disk.
#include <fmt/compile.h>
#include <fmt/format.h>

#include <array>
#include <iterator>
#include <optional>

#include "host/files/csv_map_header.hpp"
#include "host/files/map_format.hpp"

namespace verisq {
namespace {

/// A field for each number, each after a comma; empty ones where there are none. "{}" is the shortest text that gives
/// back the same binary64.
template <std::size_t N>
void append_fields(fmt::memory_buffer& text, const std::optional<std::array<double, N>>& numbers) {
  for (std::size_t k = 0; k < N; ++k) {
    text.push_back(',');
    if (numbers) fmt::format_to(std::back_inserter(text), FMT_COMPILE("{}"), (*numbers)[k]);
  }
}

/// The certificate's fields, each after a comma.
void append_certificate(fmt::memory_buffer& text, const Certificate& certificate, MapElements elements) {
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
  if (elements == MapElements::vertices) {
    append_fields(text, certificate.escape);
  } else {
    append_fields(text, certificate.weights);
  }
}

std::string_view header(const MapKind& kind) {
  if (kind.contents == MapContents::enclosures) return csv_map_header;
  return kind.elements == MapElements::vertices ? csv_certified_map_header : csv_certified_triangle_map_header;
}

class CsvMap final : public MapFormat {
 public:
  CsvMap(OutputFile& output, const MapKind& kind) : output_(output), kind_(kind) {
    output_.write(header(kind));
    output_.write("\n");
    output_.flush();
  }

  void append(std::span<const Point> /*not in this format*/, std::span<const MapResult> results,
              std::span<const Certificate> certificates) override {
    rows_.clear();
    for (std::size_t k = 0; k < results.size(); ++k) {
      const auto& [distance, status] = results[k];
      // 17 significant digits give back the same binary64; infinities are "inf" and "-inf".
      fmt::format_to(std::back_inserter(rows_), FMT_COMPILE("{},{:.17g},{:.17g},{}"), index_++, distance.lo,
                     distance.hi, to_string(status));
      if (kind_.contents == MapContents::certified) append_certificate(rows_, certificates[k], kind_.elements);
      rows_.push_back('\n');
    }
    output_.write({rows_.data(), rows_.size()});
    output_.flush();  // a killed run leaves all rows that are finished
  }

  void finish() override {}
  [[nodiscard]] bool valid_after_any_row() const override { return true; }

 private:
  OutputFile& output_;
  MapKind kind_;
  std::uint64_t index_ = 0;
  fmt::memory_buffer rows_;  // of one call
};

}  // namespace

std::unique_ptr<MapFormat> make_csv_map(OutputFile& output, const MapKind& kind) {
  return std::make_unique<CsvMap>(output, kind);
}

}  // namespace verisq
