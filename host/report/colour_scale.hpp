/// Distances as colours: the same as those of the interactive page (report/src/colours.js).
#pragma once

#include <Eigen/Core>
#include <vector>
#include <verisq/report.hpp>

namespace verisq::report {

/// Red, green, blue as sRGB stores them, in [0, 1].
using Colour = Eigen::Vector3d;

/// Diverging, with zero in the middle: warm inside the implant, cold outside. Readers who do not see red and green
/// apart see these apart.
class ColourScale {
 public:
  /// Precondition: positive, finite.
  explicit ColourScale(double range) : range_(range) {}

  /// The colours end at -range and range; what is beyond has the last one.
  [[nodiscard]] double range() const { return range_; }
  [[nodiscard]] Colour colour(double value) const;
  /// Round numbers from -range to range, zero among them.
  [[nodiscard]] std::vector<double> ticks() const;

 private:
  double range_;
};

/// Of `report.range`, or of the default one.
[[nodiscard]] ColourScale scale_of(const Report& report);

}  // namespace verisq::report
