/// Streams points from text (`.csv`) or a NumPy array (`.npy`), a chunk at a time, so that memory does not grow with
/// the file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <verisq/model.hpp>

namespace verisq {

/// Text has a point a line, `x,y,z`, separated by commas or by blanks; the first line tells. It may be a header: then
/// the coordinates are the columns named x, y and z, else the first three; other columns are passed over. An array,
/// which is known by its first bytes whatever its name, is one of shape (N, 3), float64 or float32. Throws Error(input)
/// naming file, line or byte and value for anything else, for coordinates that are not finite, and for a file without
/// points.
class PointFile {
 public:
  /// `-` is the standard input.
  explicit PointFile(const std::filesystem::path& path);
  ~PointFile();
  PointFile(PointFile&&) noexcept;
  PointFile& operator=(PointFile&&) noexcept;

  /// Fills `points` from the front; returns how many, fewer than asked only at the end of the file.
  std::size_t read(std::span<Point> points);

  /// Goes on at this point, counted from 0; an array at once, of text by reading on, or again from the beginning.
  /// Behind the last point nothing is left to read. Throws as above, and Error(input) where that is before what a pipe
  /// has delivered.
  void go_to(std::uint64_t point);

  /// How many points there are in all, where the file says so at its beginning.
  [[nodiscard]] std::optional<std::uint64_t> count() const;

  [[nodiscard]] std::uint64_t bytes_read() const;   ///< about, for progress
  [[nodiscard]] std::uint64_t bytes_total() const;  ///< 0 when unknown (a pipe)

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace verisq
