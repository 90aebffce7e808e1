/// This file implements label_volume.hpp.
#include "host/files/label_volume.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <new>
#include <verisq/files.hpp>

#include "host/files/input_file.hpp"
#include "host/files/words.hpp"
#include "host/prepare/mesh_geometry.hpp"

namespace verisq {
namespace {

constexpr std::size_t block = std::size_t{1} << 16;
constexpr int gzip_only = 16 + MAX_WBITS;

}  // namespace

ByteStream::ByteStream(InputFile& file, Packing packing)
    : file_(file), packing_(packing), packed_size_(file.remaining()) {
  if (packing_ == Packing::gzip && inflateInit2(&zlib_, gzip_only) != Z_OK) throw std::bad_alloc();
}

ByteStream::~ByteStream() {
  if (packing_ == Packing::gzip) inflateEnd(&zlib_);
}

std::uint64_t ByteStream::most_bytes() const {
  return packing_ == Packing::none ? packed_size_ : most_unpacked_of_one * packed_size_;
}

void ByteStream::next_member() {
  if (inflateReset(&zlib_) != Z_OK) file_.fail_whole("cannot be unpacked");
  between_members_ = false;
}

std::size_t ByteStream::unpack(std::span<char> bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const std::string_view packed = file_.peek(block);
    if (packed.empty()) {
      if (!between_members_) file_.fail_whole("truncated: the file ends inside its gzip data");
      break;
    }
    if (between_members_) next_member();
    const std::size_t room = std::min(bytes.size() - done, block);
    // zlib reads through a pointer that is not const, and does not write there.
    zlib_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
    zlib_.avail_in = static_cast<uInt>(packed.size());
    zlib_.next_out = reinterpret_cast<Bytef*>(bytes.data() + done);
    zlib_.avail_out = static_cast<uInt>(room);
    const int outcome = inflate(&zlib_, Z_NO_FLUSH);
    if (outcome != Z_OK && outcome != Z_STREAM_END) {
      const char* why = zlib_.msg != nullptr ? zlib_.msg : "data are missing";
      file_.fail_whole(fmt::format("gzip data near byte {}: {}", file_.position(), printable(why)));
    }
    between_members_ = outcome == Z_STREAM_END;
    (void)file_.take(packed.size() - zlib_.avail_in, "gzip data");
    done += room - zlib_.avail_out;
  }
  return done;
}

void ByteStream::read(std::span<char> bytes, std::string_view what) {
  if (packing_ == Packing::none) {
    for (std::size_t done = 0; done < bytes.size(); done += std::min(block, bytes.size() - done)) {
      const auto part = bytes.subspan(done, std::min(block, bytes.size() - done));
      std::ranges::copy(file_.take(part.size(), what), part.begin());
    }
    return;
  }
  const std::size_t unpacked = unpack(bytes);
  if (unpacked < bytes.size())
    file_.fail_whole(
        fmt::format("truncated: its gzip data end {} bytes early, inside {}", bytes.size() - unpacked, what));
}

void ByteStream::expect_end(std::string_view what) {
  const bool more = packing_ == Packing::none ? !file_.peek(1).empty() : [&] {
    char byte = 0;
    return unpack({&byte, 1}) > 0;
  }();
  if (more) file_.fail_whole(fmt::format("there are more bytes after {}", what));
}

namespace {

LabelVolume read(InputFile& file, const std::string& name) {
  if (name.ends_with(".nrrd")) return read_nrrd(file);
  if (name.ends_with(".nii") || name.ends_with(".nii.gz")) return read_nifti(file);
  file.fail_whole("volumes are read from .nrrd, .nii and .nii.gz");
}

}  // namespace

LabelVolume read_label_volume(const std::filesystem::path& path) {
  InputFile file(path);
  if (file.size() == 0) file.fail_whole("volumes are read from regular files only");
  try {
    return read(file, lower_case(path.filename().string()));
  } catch (const std::bad_alloc&) {
    file.fail_whole("the volume does not fit into memory");
  }
}

void turn_about_z(LabelVolume& volume) {
  const auto turn = [](Point& x) { x = {0.0 - x[0], 0.0 - x[1], x[2]}; };  // 0 stays 0
  turn(volume.origin);
  for (Point& step : volume.steps) turn(step);
}

void check_axes(const InputFile& file, const LabelVolume& volume) {
  // Scanners make no such voxels, and their surfaces overflow or have no end.
  constexpr double finest = 1e-9;
  constexpr double farthest = 1e9;
  constexpr double most_elongated = 100.0;
  constexpr double flattest = 0.01;  // of a box with the same edges
  std::array<double, 3> lengths{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Point& step = volume.steps[axis];
    lengths[axis] = std::hypot(step[0], step[1], step[2]);
    if (!(lengths[axis] >= finest && lengths[axis] <= farthest)) {
      file.fail_whole(
          fmt::format("a voxel is {} long along axis {}: must be {} to {}", lengths[axis], axis, finest, farthest));
    }
    if (!(std::abs(volume.origin[axis]) <= farthest))
      file.fail_whole(fmt::format("its origin {} is more than {} away", volume.origin[axis], farthest));
  }
  const auto [shortest, longest] = std::ranges::minmax(lengths);
  if (longest > most_elongated * shortest) {
    file.fail_whole(fmt::format("its voxels are {} times as long as wide: at most {} is supported", longest / shortest,
                                most_elongated));
  }
  const double size = voxel_volume(volume);
  if (!(size >= flattest * lengths[0] * lengths[1] * lengths[2]))
    file.fail_whole(fmt::format("its axes span no volume: the size of a voxel is {}", size));
}

std::vector<LabelCount> labels_of(const LabelVolume& volume) {
  std::vector<std::uint64_t> voxels(std::size_t{std::numeric_limits<std::uint16_t>::max()} + 1, 0);
  for (const std::uint16_t label : volume.labels) ++voxels[label];
  std::vector<LabelCount> result;
  for (std::size_t label = 1; label < voxels.size(); ++label)
    if (voxels[label] > 0) result.push_back({static_cast<std::uint16_t>(label), voxels[label]});
  return result;
}

LabelVolume in_space(LabelVolume volume, AnatomicalSpace space) {
  if (volume.space != space) turn_about_z(volume);
  volume.space = space;
  return volume;
}

double voxel_volume(const LabelVolume& volume) {
  return std::abs(determinant(volume.steps));
}

namespace {

constexpr std::size_t voxels_of_block = std::size_t{1} << 16;

template <class Value>
void append_labels(const InputFile& file, std::span<const char> bytes, std::endian order,
                   std::vector<std::uint16_t>& labels) {
  constexpr auto largest = static_cast<Value>(std::min<std::uint64_t>(
      std::numeric_limits<std::uint16_t>::max(),
      std::numeric_limits<Value>::is_integer ? static_cast<std::uint64_t>(std::numeric_limits<Value>::max()) : 65535));
  for (std::size_t at = 0; at < bytes.size(); at += sizeof(Value)) {
    const auto value = number_from<Value>(bytes.data() + at, order);
    // NaN fails the first comparison.
    if (!(value >= Value{0} && value <= largest) || static_cast<Value>(static_cast<std::uint16_t>(value)) != value) {
      file.fail_whole(
          fmt::format("voxel {} (from 0) is {}: labels are integers from 0 to 65535", labels.size(), +value));
    }
    labels.push_back(static_cast<std::uint16_t>(value));
  }
}

void append_labels(const InputFile& file, std::span<const char> bytes, NumberType type, std::endian order,
                   std::vector<std::uint16_t>& labels) {
  switch (type) {
    case NumberType::int8: return append_labels<std::int8_t>(file, bytes, order, labels);
    case NumberType::uint8: return append_labels<std::uint8_t>(file, bytes, order, labels);
    case NumberType::int16: return append_labels<std::int16_t>(file, bytes, order, labels);
    case NumberType::uint16: return append_labels<std::uint16_t>(file, bytes, order, labels);
    case NumberType::int32: return append_labels<std::int32_t>(file, bytes, order, labels);
    case NumberType::uint32: return append_labels<std::uint32_t>(file, bytes, order, labels);
    case NumberType::int64: return append_labels<std::int64_t>(file, bytes, order, labels);
    case NumberType::uint64: return append_labels<std::uint64_t>(file, bytes, order, labels);
    case NumberType::float32: return append_labels<float>(file, bytes, order, labels);
    case NumberType::float64: return append_labels<double>(file, bytes, order, labels);
  }
}

}  // namespace

std::size_t voxel_count(const InputFile& file, const ByteStream& stream, const std::array<std::int64_t, 3>& counts,
                        NumberType type) {
  const std::uint64_t most = stream.most_bytes() / size_of(type);
  std::uint64_t voxels = 1;
  for (const std::int64_t count : counts) {
    if (count < 1) file.fail_whole(fmt::format("{} voxels along an axis: must be positive", count));
    if (static_cast<std::uint64_t>(count) > most / voxels) {
      file.fail_whole(fmt::format("{} x {} x {} voxels of {} bytes: more than a file of {} bytes can hold", counts[0],
                                  counts[1], counts[2], size_of(type), file.size()));
    }
    voxels *= static_cast<std::uint64_t>(count);
  }
  return voxels;
}

std::vector<std::uint16_t> read_voxels(const InputFile& file, ByteStream& stream, std::size_t count, NumberType type,
                                       std::endian order) {
  std::vector<std::uint16_t> labels;
  labels.reserve(count);
  std::vector<char> bytes;
  while (labels.size() < count) {
    bytes.resize(size_of(type) * std::min(voxels_of_block, count - labels.size()));
    stream.read(bytes, "the voxels");
    append_labels(file, bytes, type, order, labels);
  }
  stream.expect_end("the last voxel");
  return labels;
}

}  // namespace verisq
