/// Picks the reader of points by their first bytes.
#include <verisq/point_file.hpp>

#include "host/files/npy_header.hpp"
#include "host/files/point_source.hpp"
#include "host/files/words.hpp"

namespace verisq {
namespace {

std::unique_ptr<PointSource> open_points(const std::filesystem::path& path) {
  const bool from_standard_input = path == "-";
  InputFile file = from_standard_input ? InputFile::standard_input() : InputFile(path);
  const bool is_array = lower_case(path.extension().string()) == ".npy" || file.peek(npy_magic.size()) == npy_magic;
  if (!is_array) return text_points(std::move(file));
  return npy_points(std::move(file), from_standard_input ? std::filesystem::path() : path);
}

}  // namespace

struct PointFile::State {
  std::unique_ptr<PointSource> source;
};

PointFile::PointFile(const std::filesystem::path& path) : state_(new State{open_points(path)}) {}
PointFile::~PointFile() = default;
PointFile::PointFile(PointFile&&) noexcept = default;
PointFile& PointFile::operator=(PointFile&&) noexcept = default;

std::size_t PointFile::read(std::span<Point> points) {
  return state_->source->read(points);
}

std::optional<std::uint64_t> PointFile::count() const {
  return state_->source->count();
}

std::uint64_t PointFile::bytes_read() const {
  return state_->source->bytes_read();
}
std::uint64_t PointFile::bytes_total() const {
  return state_->source->bytes_total();
}

}  // namespace verisq
