/// Blocks of bytes become numbers in the machine's order, then labels.
#include "host/files/voxel_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "host/files/byte_order.hpp"

namespace verisq {
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
    // Not a number fails the first comparison.
    if (!(value >= Value{0} && value <= largest) || static_cast<Value>(static_cast<std::uint16_t>(value)) != value) {
      file.fail_whole(
          fmt::format("voxel {} (from 0) is {}: labels are integers from 0 to 65535", labels.size(), +value));
    }
    labels.push_back(static_cast<std::uint16_t>(value));
  }
}

void append_labels(const InputFile& file, std::span<const char> bytes, VoxelType type, std::endian order,
                   std::vector<std::uint16_t>& labels) {
  switch (type) {
    case VoxelType::int8: return append_labels<std::int8_t>(file, bytes, order, labels);
    case VoxelType::uint8: return append_labels<std::uint8_t>(file, bytes, order, labels);
    case VoxelType::int16: return append_labels<std::int16_t>(file, bytes, order, labels);
    case VoxelType::uint16: return append_labels<std::uint16_t>(file, bytes, order, labels);
    case VoxelType::int32: return append_labels<std::int32_t>(file, bytes, order, labels);
    case VoxelType::uint32: return append_labels<std::uint32_t>(file, bytes, order, labels);
    case VoxelType::int64: return append_labels<std::int64_t>(file, bytes, order, labels);
    case VoxelType::uint64: return append_labels<std::uint64_t>(file, bytes, order, labels);
    case VoxelType::float32: return append_labels<float>(file, bytes, order, labels);
    case VoxelType::float64: return append_labels<double>(file, bytes, order, labels);
  }
}

}  // namespace

std::size_t size_of(VoxelType type) {
  switch (type) {
    case VoxelType::int8:
    case VoxelType::uint8: return 1;
    case VoxelType::int16:
    case VoxelType::uint16: return 2;
    case VoxelType::int32:
    case VoxelType::uint32:
    case VoxelType::float32: return 4;
    case VoxelType::int64:
    case VoxelType::uint64:
    case VoxelType::float64: break;
  }
  return 8;
}

std::size_t voxel_count(const InputFile& file, const ByteStream& stream, const std::array<std::int64_t, 3>& counts,
                        VoxelType type) {
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

std::vector<std::uint16_t> read_voxels(const InputFile& file, ByteStream& stream, std::size_t count, VoxelType type,
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
