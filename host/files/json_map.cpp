/// Maps as JSON: {"format": "verisq-map/1", "results": [{"index", "lo", "hi", "status"}, ...]}, streamed to the disk. A
/// map of triangles or poses says so by "elements": "triangles" or "poses".
#include <fmt/compile.h>
#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "host/files/map_format.hpp"

namespace verisq {
namespace {

/// JSON has no infinities: an infinite end is the string "inf" or "-inf", never null, which would say "no answer".
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

}  // namespace verisq
