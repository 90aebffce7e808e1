/// How far a streamed file is worked off, for progress.
#pragma once

#include <cstdint>

namespace verisq::command_line {

/// The part of all items of `file` that `done` finished ones of the `read` ones make up, about: how many there are is
/// unknown until the end, and reading runs ahead of `done` by a few chunks. 0 when unknown. `File` is PointFile or
/// PoseFile.
template <class File>
[[nodiscard]] double file_fraction(const File& file, std::uint64_t read, std::uint64_t done) {
  const auto bytes = static_cast<double>(file.bytes_total());  // 0 for a pipe
  if (read == 0 || bytes == 0.0) return 0.0;
  return static_cast<double>(file.bytes_read()) / bytes * (static_cast<double>(done) / static_cast<double>(read));
}

}  // namespace verisq::command_line
