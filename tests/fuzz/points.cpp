/// Fuzz targets of PointFile: text and arrays.
#include <array>
#include <cmath>
#include <optional>
#include <verisq/files.hpp>

#include "tests/fuzz/memory_file.hpp"
#include "tests/fuzz/promise.hpp"

namespace verisq::fuzz {
namespace {

void check_points(std::span<const Point> points) {
  for (const Point& point : points) {
    for (const double coordinate : point) check(std::isfinite(coordinate), "coordinates are finite");
  }
}

void read_to_the_end(PointFile file) {
  const std::optional<std::uint64_t> promised = file.count();
  std::array<Point, 5> chunk{};  // small, so that chunks end inside the file
  std::size_t count = chunk.size();
  std::size_t total = 0;
  while (count == chunk.size()) {
    count = file.read(chunk);
    check(count <= chunk.size(), "no more points are read than asked for");
    check_points(std::span(chunk).first(count));
    total += count;
    check(file.bytes_read() <= file.bytes_total(), "no more bytes are read than the file has");
  }
  check(total > 0, "a file has points");
  check(!promised || *promised == total, "a file has as many points as it says");
  check(file.read(chunk) == 0, "nothing follows the end");
}

void read_points(const MemoryFile& memory, Bytes bytes) {
  memory.write(bytes);
  read_or_refuse(memory.path().string(), [&] { read_to_the_end(PointFile(memory.path())); });
}

}  // namespace

void points(Bytes bytes) {
  static const MemoryFile memory(".csv");
  read_points(memory, bytes);
}

void points_npy(Bytes bytes) {
  static const MemoryFile memory(".npy");
  read_points(memory, bytes);
}

}  // namespace verisq::fuzz
