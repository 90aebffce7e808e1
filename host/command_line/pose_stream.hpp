/// The poses of a file, a chunk at a time: what `distance --poses` encloses the distances of.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <verisq/pose_file.hpp>

#include "host/command_line/file_fraction.hpp"

namespace verisq::command_line {

/// As PointStream.
class PoseStream {
 public:
  using Element = Pose;

  explicit PoseStream(const std::string& path) : file_(path) {}

  std::size_t read(std::span<Pose> poses) {
    const std::size_t count = file_.read(poses);
    poses_read_ += count;
    return count;
  }

  void go_to(std::uint64_t pose) {
    file_.go_to(pose);
    poses_read_ = pose;
  }

  /// Not known before the last one.
  [[nodiscard]] static std::optional<std::uint64_t> count() { return std::nullopt; }

  [[nodiscard]] double fraction(std::uint64_t done) const { return file_fraction(file_, poses_read_, done); }

 private:
  PoseFile file_;
  std::uint64_t poses_read_ = 0;
};

}  // namespace verisq::command_line
