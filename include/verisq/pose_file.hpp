/// Streams poses from a CSV file `tx,ty,tz,qw,qx,qy,qz`, a chunk at a time, so that memory does not grow with the file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>
#include <verisq/model.hpp>

namespace verisq {

/// A line is a translation in model units and a quaternion of any length but zero. A header line is optional. Throws
/// Error(input) naming file, line and value for anything but seven finite numbers a line, for a zero quaternion, and
/// for a file without poses.
class PoseFile {
 public:
  explicit PoseFile(const std::filesystem::path& path);
  ~PoseFile();
  PoseFile(PoseFile&&) noexcept;
  PoseFile& operator=(PoseFile&&) noexcept;

  /// Fills `poses` from the front; returns how many, fewer than asked only at the end of the file.
  std::size_t read(std::span<Pose> poses);

  /// Goes on at this pose, counted from 0: by reading on, or again from the beginning. Behind the last one nothing is
  /// left to read.
  void go_to(std::uint64_t pose);

  [[nodiscard]] std::uint64_t bytes_read() const;  ///< for progress
  [[nodiscard]] std::uint64_t bytes_total() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// All poses of a file, in its order. Throws as PoseFile.
[[nodiscard]] std::vector<Pose> read_poses(const std::filesystem::path& path);

}  // namespace verisq
