/// Maps as CSV: a row "index,lo,hi,status" for each point, streamed to the disk.
#include <fmt/compile.h>
#include <fmt/format.h>

#include <iterator>

#include "host/files/map_format.hpp"

namespace verisq {
namespace {

class CsvMap final : public MapFormat {
 public:
  explicit CsvMap(OutputFile& output) : output_(output) { output_.write("index,lo,hi,status\n"); }

  void append(std::span<const Point> /*not in this format*/, std::span<const MapResult> results) override {
    rows_.clear();
    for (const MapResult& result : results) {
      // 17 significant digits give back the same binary64; infinities are "inf" and "-inf".
      fmt::format_to(std::back_inserter(rows_), FMT_COMPILE("{},{:.17g},{:.17g},{}\n"), index_++, result.distance.lo,
                     result.distance.hi, to_string(result.status));
    }
    output_.write({rows_.data(), rows_.size()});
  }

  void finish() override {}
  [[nodiscard]] bool valid_after_any_row() const override { return true; }

 private:
  OutputFile& output_;
  std::uint64_t index_ = 0;
  fmt::memory_buffer rows_;  // of one call
};

}  // namespace

std::unique_ptr<MapFormat> make_csv_map(OutputFile& output, const Mesh* /*not in this format*/) {
  return std::make_unique<CsvMap>(output);
}

}  // namespace verisq
