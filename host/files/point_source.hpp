/// The forms of points that are streamed: one class and one source file each.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <verisq/model.hpp>

#include "host/files/input_file.hpp"

namespace verisq {

/// Members are those of `PointFile`.
class PointSource {
 public:
  PointSource() = default;
  PointSource(const PointSource&) = delete;
  PointSource& operator=(const PointSource&) = delete;
  virtual ~PointSource() = default;

  virtual std::size_t read(std::span<Point> points) = 0;
  /// Whether `go_to` may be called.
  [[nodiscard]] virtual bool can_go_to() const { return false; }
  /// Goes on at this point, which is at most the count. Precondition: `can_go_to`.
  virtual void go_to(std::uint64_t /*point*/) {}
  [[nodiscard]] virtual std::uint64_t bytes_read() const = 0;
  [[nodiscard]] virtual std::uint64_t bytes_total() const = 0;
  [[nodiscard]] virtual std::optional<std::uint64_t> count() const { return std::nullopt; }
};

[[nodiscard]] std::unique_ptr<PointSource> text_points(InputFile file);

/// `path` is that of the file; empty for the standard input.
[[nodiscard]] std::unique_ptr<PointSource> npy_points(InputFile file, const std::filesystem::path& path);

}  // namespace verisq
