/// Checks certified maps that were accepted.
#include "tests/fuzz/map_promise.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>
#include <verisq/map_file.hpp>

#include "tests/fuzz/promise.hpp"

namespace verisq::fuzz {
namespace {

bool finite(std::span<const double> numbers) {
  return std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); });
}

void check_row(const CertifiedRow& row, MapElements elements) {
  const auto& [distance, status] = row.result;
  check(!std::isnan(distance.lo) && !std::isnan(distance.hi), "ends are not NaN");
  check(status == Status::device_verified || status == Status::host_verified || status == Status::wide,
        "a status is one of three");
  const auto& [normals, escape, weights, witness, cover] = row.certificate;
  for (const Normal& normal : normals) check(finite(normal.vector), "normals are finite");
  check(!escape || (finite(*escape) && elements == MapElements::vertices), "escapes are finite, and of points only");
  check(!witness || (finite(*witness) && elements == MapElements::vertices),
        "witnesses are finite, and of points only");
  check(cover.empty() || elements == MapElements::vertices, "covers are of points only");
  check(!weights || (finite(*weights) && elements == MapElements::triangles),
        "weights are finite, and of triangles only");
}

void read_to_the_end(MapReader map) {
  std::vector<CertifiedRow> chunk(3);  // small, so that chunks end inside the map; rows are reused
  std::size_t count = chunk.size();
  while (count == chunk.size()) {
    count = map.read(chunk);
    check(count <= chunk.size(), "no more rows are read than asked for");
    for (const CertifiedRow& row : std::span(chunk).first(count)) check_row(row, map.elements());
  }
  check(map.read(chunk) == 0, "nothing follows the end");
  const Mesh triangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  for (const Mesh& mesh : {Mesh{}, triangle}) {
    check(map.draws() || !map.difference_from(mesh), "only a picture differs from another");
  }
}

}  // namespace

void read_as_map(const MemoryFile& file, Bytes bytes) {
  file.write(bytes);
  read_or_refuse(file.path().string(), [&] { read_to_the_end(MapReader(file.path())); });
}

}  // namespace verisq::fuzz
