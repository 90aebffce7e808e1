/// Maps as PLY, binary little-endian: each vertex or each face carries dist_lo, dist_hi, dist_mid and status.
#include <fmt/format.h>

#include <array>
#include <bit>

#include "host/files/collected_map.hpp"
#include "host/files/finite_middle.hpp"
#include "host/files/map_format.hpp"

namespace verisq {
namespace {

class PlyMap final : public MapFormat {
 public:
  PlyMap(OutputFile& output, const MapKind& kind) : output_(output), map_(kind) {}

  void append(const MapChunk& chunk) override { map_.append(chunk.points, chunk.results); }

  void finish() override {
    map_.check_complete(output_);
    write_header();
    for (std::size_t k = 0; k < map_.vertices().size(); ++k) {
      output_.write_little_endian<double>(map_.vertices()[k]);
      if (map_.elements() == MapElements::vertices) write_result(k);
    }
    for (std::size_t k = 0; k < map_.triangles().size(); ++k) {
      output_.write(std::string_view("\3", 1));  // corners
      output_.write_little_endian<std::uint32_t>(map_.triangles()[k]);
      if (map_.elements() == MapElements::triangles) write_result(k);
    }
  }

 private:
  void write_header() {
    output_.write("ply\nformat binary_little_endian 1.0\ncomment verisq-map/1; status: 0 device-verified, ");
    output_.write("1 host-verified, 2 wide\n");
    output_.write(fmt::format("element vertex {}\n", map_.vertices().size()));
    output_.write("property double x\nproperty double y\nproperty double z\n");
    if (map_.elements() == MapElements::vertices) output_.write(result_properties);
    if (map_.elements() == MapElements::triangles || !map_.triangles().empty()) {
      output_.write(fmt::format("element face {}\nproperty list uchar uint vertex_indices\n", map_.triangles().size()));
    }
    if (map_.elements() == MapElements::triangles) output_.write(result_properties);
    output_.write("end_header\n");
  }

  void write_result(std::size_t k) {
    const double lo = map_.lo()[k];
    const double hi = map_.hi()[k];
    output_.write_little_endian<double>(std::array{lo, hi, finite_middle(lo, hi)});
    output_.write_little_endian(map_.statuses().subspan(k, 1));
  }

  static constexpr std::string_view result_properties =
      "property double dist_lo\nproperty double dist_hi\nproperty double dist_mid\nproperty uchar status\n";

  OutputFile& output_;
  CollectedMap map_;
};

}  // namespace

std::unique_ptr<MapFormat> make_ply_map(OutputFile& output, const MapKind& kind) {
  return std::make_unique<PlyMap>(output, kind);
}

}  // namespace verisq
