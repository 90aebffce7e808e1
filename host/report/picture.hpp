/// Pictures: colours of distances, and drawings of a map by cairo.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>
#include <verisq/report.hpp>

namespace verisq::report {

// Distances as colours: the same as those of the interactive page (report/src/colours.js).

/// Red, green, blue as sRGB stores them, in [0, 1].
using Colour = Eigen::Vector3d;

/// Diverging, with zero in the middle: warm inside the implant, cold outside. Readers who do not see red and green
/// apart see these apart.
class ColourScale {
 public:
  /// Precondition: positive, finite.
  explicit ColourScale(double range) : range_(range) {}

  /// The colours end at -range and range; values beyond have the last colour.
  [[nodiscard]] double range() const { return range_; }
  [[nodiscard]] Colour colour(double value) const;
  /// Round numbers from -range to range, zero among them.
  [[nodiscard]] std::vector<double> ticks() const;

 private:
  double range_;
};

/// The scale of `report.range`, or of the default one.
[[nodiscard]] ColourScale scale_of(const Report& report);

}  // namespace verisq::report

// A picture that is being drawn: pixels, rectangles and words, and at the end a file. Wraps cairo.

struct _cairo_surface;  // NOLINT(bugprone-reserved-identifier): cairo's name

namespace verisq::report {

class Drawing {
 public:
  /// White. Precondition: width, height in [1, 32767]. Throws Error(failure) without memory.
  Drawing(int width, int height);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }

  /// The pixels from (x, y) to the right. Precondition: within the picture.
  void set_row(int x, int y, std::span<const Colour> colours);
  void fill_rectangle(double x, double y, double width, double height, const Colour& colour);

  enum class Weight { normal, bold };
  struct Type {
    double size;  ///< size of the letters, in pixels
    Colour colour;
    Weight weight = Weight::normal;
  };

  /// Writes one line of UTF-8 (other bytes are replaced), its base line from (x, y); shortened by "..." if it would be
  /// wider than `room`. On a machine without fonts nothing appears.
  void write(double x, double y, double room, const std::string& text, const Type& type);

  /// The width that `write` would take of unlimited room; 0 without fonts.
  [[nodiscard]] double width_of(const std::string& text, const Type& type) const;

  /// Saves a .png; the file appears when it is complete. Throws Error(failure).
  void save(const std::filesystem::path& path) const;

 private:
  struct Release {
    void operator()(_cairo_surface* surface) const;
  };

  int width_, height_;
  std::unique_ptr<_cairo_surface, Release> surface_;
  unsigned char* pixels_;
  std::ptrdiff_t row_size_;  // bytes
};

}  // namespace verisq::report
