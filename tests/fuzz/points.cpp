/// Fuzz target of PointFile.
#include <array>
#include <cmath>
#include <verisq/point_file.hpp>

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
  check(file.read(chunk) == 0, "nothing follows the end");
}

}  // namespace

void points(Bytes bytes) {
  static const MemoryFile memory(".csv");
  memory.write(bytes);
  read_or_refuse(memory.path().string(), [] { read_to_the_end(PointFile(memory.path())); });
}

}  // namespace verisq::fuzz
