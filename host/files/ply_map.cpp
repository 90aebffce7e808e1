/// Maps as PLY, binary little-endian: each vertex carries dist_lo, dist_hi, dist_mid and status.
#include <fmt/format.h>

#include <array>
#include <bit>

#include "host/files/collected_map.hpp"
#include "host/files/map_format.hpp"

namespace verisq {
namespace {

class PlyMap final : public MapFormat {
 public:
  PlyMap(OutputFile& output, const Mesh* mesh) : output_(output), map_(mesh) {}

  void append(std::span<const Point> points, std::span<const MapResult> results,
              std::span<const Certificate> /*not in this format*/) override {
    map_.append(points, results);
  }

  void finish() override {
    map_.check_complete(output_);
    write_header();
    for (std::size_t k = 0; k < map_.vertices().size(); ++k) write_vertex(k);
    for (const auto& triangle : map_.triangles()) {
      output_.write(std::string_view("\3", 1));  // corners
      output_.write_little_endian<std::uint32_t>(triangle);
    }
  }

 private:
  void write_header() {
    output_.write("ply\nformat binary_little_endian 1.0\ncomment verisq-map/1; status: 0 device-verified, ");
    output_.write("1 host-verified, 2 wide\n");
    output_.write(fmt::format("element vertex {}\n", map_.vertices().size()));
    for (const char* name : {"x", "y", "z", "dist_lo", "dist_hi", "dist_mid"}) {
      output_.write(fmt::format("property double {}\n", name));
    }
    output_.write("property uchar status\n");
    if (!map_.triangles().empty()) {
      output_.write(fmt::format("element face {}\nproperty list uchar uint vertex_indices\n", map_.triangles().size()));
    }
    output_.write("end_header\n");
  }

  void write_vertex(std::size_t k) {
    const auto [x, y, z] = map_.vertices()[k];
    const double lo = map_.lo()[k];
    const double hi = map_.hi()[k];
    output_.write_little_endian<double>(std::array{x, y, z, lo, hi, finite_middle(lo, hi)});
    output_.write_little_endian(map_.statuses().subspan(k, 1));
  }

  OutputFile& output_;
  CollectedMap map_;
};

}  // namespace

std::unique_ptr<MapFormat> make_ply_map(OutputFile& output, const Mesh* mesh, MapContents /*enclosures*/) {
  return std::make_unique<PlyMap>(output, mesh);
}

}  // namespace verisq
