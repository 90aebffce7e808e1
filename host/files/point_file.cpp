/// Picks the reader of points by their first bytes.
#include <algorithm>
#include <span>
#include <vector>
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
  std::filesystem::path path;
  std::unique_ptr<PointSource> source;
  std::uint64_t next = 0;  // point to be read
};

PointFile::PointFile(const std::filesystem::path& path) : state_(new State{path, open_points(path)}) {}
PointFile::~PointFile() = default;
PointFile::PointFile(PointFile&&) noexcept = default;
PointFile& PointFile::operator=(PointFile&&) noexcept = default;

std::size_t PointFile::read(std::span<Point> points) {
  const std::size_t count = state_->source->read(points);
  state_->next += count;
  return count;
}

void PointFile::go_to(std::uint64_t point) {
  if (state_->source->can_go_to()) {
    state_->source->go_to(point);
    state_->next = point;
    return;
  }
  if (point < state_->next) {
    if (!std::filesystem::is_regular_file(state_->path)) refuse_file(state_->path.string(), "cannot be read again");
    *state_ = State{state_->path, open_points(state_->path)};
  }
  std::vector<Point> passed(std::size_t{1} << 14U);
  while (state_->next < point) {
    const std::uint64_t most = std::min<std::uint64_t>(passed.size(), point - state_->next);
    if (read(std::span(passed).first(static_cast<std::size_t>(most))) == 0) break;
  }
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
