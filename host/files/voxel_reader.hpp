/// Voxels of any type of number, read as labels.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/files/byte_stream.hpp"

namespace verisq {

enum class VoxelType { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

[[nodiscard]] std::size_t size_of(VoxelType type);

/// The number of voxels. Fails where there are none along an axis, or more than `stream` can hold.
[[nodiscard]] std::size_t voxel_count(const InputFile& file, const ByteStream& stream,
                                      const std::array<std::int64_t, 3>& counts, VoxelType type);

/// The next `count` voxels. Fails at a value that is no integer from 0 to 65535, whatever its type.
[[nodiscard]] std::vector<std::uint16_t> read_voxels(const InputFile& file, ByteStream& stream, std::size_t count,
                                                     VoxelType type, std::endian order);

}  // namespace verisq
