/// Streams points from CSV.
#include <verisq/point_file.hpp>

#include "host/files/number_rows.hpp"

namespace verisq {

struct PointFile::State {
  NumberRows rows;
};

PointFile::PointFile(const std::filesystem::path& path)
    : state_(new State{{path, {.item = "point", .count = "three", .header = "x,y,z"}}}) {}
PointFile::~PointFile() = default;
PointFile::PointFile(PointFile&&) noexcept = default;
PointFile& PointFile::operator=(PointFile&&) noexcept = default;

std::size_t PointFile::read(std::span<Point> points) {
  std::size_t count = 0;
  while (count < points.size() && state_->rows.next(points[count])) ++count;
  return count;
}

std::uint64_t PointFile::bytes_read() const {
  return state_->rows.bytes_read();
}
std::uint64_t PointFile::bytes_total() const {
  return state_->rows.bytes_total();
}

}  // namespace verisq
