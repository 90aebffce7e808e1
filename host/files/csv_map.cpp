/// Maps as CSV: a row "index,lo,hi,status" for each point, and its certificate when asked for, streamed to the disk.
#include <fmt/compile.h>
#include <fmt/format.h>

#include <iterator>

#include "host/files/csv_map_header.hpp"
#include "host/files/map_format.hpp"

namespace verisq {
namespace {

/// The certificate's fields, each after a comma. "{}" is the shortest text that gives back the same binary64.
void append_certificate(fmt::memory_buffer& text, const Certificate& certificate) {
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
  if (const std::optional<Point>& escape = certificate.escape) {
    fmt::format_to(end, FMT_COMPILE(",{},{},{}"), (*escape)[0], (*escape)[1], (*escape)[2]);
  } else {
    fmt::format_to(end, FMT_COMPILE(",,,"));
  }
}

class CsvMap final : public MapFormat {
 public:
  CsvMap(OutputFile& output, MapContents contents) : output_(output), certified_(contents == MapContents::certified) {
    output_.write(certified_ ? csv_certified_map_header : csv_map_header);
    output_.write("\n");
  }

  void append(std::span<const Point> /*not in this format*/, std::span<const MapResult> results,
              std::span<const Certificate> certificates) override {
    rows_.clear();
    for (std::size_t k = 0; k < results.size(); ++k) {
      const auto& [distance, status] = results[k];
      // 17 significant digits give back the same binary64; infinities are "inf" and "-inf".
      fmt::format_to(std::back_inserter(rows_), FMT_COMPILE("{},{:.17g},{:.17g},{}"), index_++, distance.lo,
                     distance.hi, to_string(status));
      if (certified_) append_certificate(rows_, certificates[k]);
      rows_.push_back('\n');
    }
    output_.write({rows_.data(), rows_.size()});
  }

  void finish() override {}
  [[nodiscard]] bool valid_after_any_row() const override { return true; }

 private:
  OutputFile& output_;
  bool certified_;
  std::uint64_t index_ = 0;
  fmt::memory_buffer rows_;  // of one call
};

}  // namespace

std::unique_ptr<MapFormat> make_csv_map(OutputFile& output, const Mesh* /*not in this format*/, MapContents contents) {
  return std::make_unique<CsvMap>(output, contents);
}

}  // namespace verisq
