/// Streams points from a CSV file `x,y,z`, a chunk at a time, so that memory does not grow with the file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <verisq/model.hpp>

namespace verisq {

/// A header line is optional. Throws Error(input) naming file, line and value for anything but three finite numbers
/// a line, and for a file without points.
class PointFile {
 public:
  explicit PointFile(const std::filesystem::path& path);
  ~PointFile();
  PointFile(PointFile&&) noexcept;
  PointFile& operator=(PointFile&&) noexcept;

  /// Fills `points` from the front; returns how many, fewer than asked only at the end of the file.
  std::size_t read(std::span<Point> points);

  [[nodiscard]] std::uint64_t bytes_read() const;  ///< for progress
  [[nodiscard]] std::uint64_t bytes_total() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace verisq
