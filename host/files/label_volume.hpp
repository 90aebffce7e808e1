/// Volumes of labels: their formats, and voxels of any type read as labels.
#pragma once

#include <zlib.h>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>
#include <verisq/files.hpp>

#include "host/files/input_file.hpp"

namespace verisq {

// The bytes of a file from where it stands, as they are or unpacked by zlib.

class ByteStream {
 public:
  enum class Packing { none, gzip };

  /// `file`, which must outlive the stream, has a known size.
  ByteStream(InputFile& file, Packing packing);
  ~ByteStream();
  ByteStream(const ByteStream&) = delete;
  ByteStream& operator=(const ByteStream&) = delete;

  /// The largest size to which the file can unpack: a wrong header must not request all memory.
  [[nodiscard]] std::uint64_t most_bytes() const;

  /// Fills `bytes`. Throws Error(input) if the file ends before, inside `what`, or cannot be unpacked.
  void read(std::span<char> bytes, std::string_view what);

  /// Throws Error(input) if there are more bytes.
  void expect_end(std::string_view what);

 private:
  /// Fills as many bytes as there are, at most `bytes.size()`.
  std::size_t unpack(std::span<char> bytes);
  void next_member();

  InputFile& file_;
  Packing packing_;
  std::uint64_t packed_size_;
  z_stream zlib_{};
  bool between_members_ = true;
};

// The readers of single volume formats.

/// Nearly Raw Raster Data (teem): a header of text, a blank line, the voxels. In LPS, unless its space is unknown.
[[nodiscard]] LabelVolume read_nrrd(InputFile& file);

/// NIfTI-1 in one file, packed or not: 348 bytes, then the voxels. In LPS, unless its space is unknown.
[[nodiscard]] LabelVolume read_nifti(InputFile& file);

/// x and y of LPS and RAS are each other's negatives.
void turn_about_z(LabelVolume& volume);

/// Fails unless the axes of the volume span one.
void check_axes(const InputFile& file, const LabelVolume& volume);

// Voxels of any type of number, read as labels.

/// The number of voxels. Fails where there are none along an axis, or more than `stream` can hold.
[[nodiscard]] std::size_t voxel_count(const InputFile& file, const ByteStream& stream,
                                      const std::array<std::int64_t, 3>& counts, NumberType type);

/// The next `count` voxels. Fails at a value that is no integer from 0 to 65535, whatever its type.
[[nodiscard]] std::vector<std::uint16_t> read_voxels(const InputFile& file, ByteStream& stream, std::size_t count,
                                                     NumberType type, std::endian order);

}  // namespace verisq
