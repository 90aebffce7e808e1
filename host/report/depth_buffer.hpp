/// What of a surface is nearest to the viewer at each sample of a raster.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "verisq/enclosure.hpp"

namespace verisq::report {

/// Triangles in the coordinates of the raster: x to the right and y down in samples, z towards the viewer.
struct ProjectedSurface {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<float> facing;  ///< of each vertex: cosine of the angle between its normal and the line of sight
  std::vector<float> values;  ///< of each vertex; empty where there are none
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

struct Sample {
  float depth = -std::numeric_limits<float>::infinity();  ///< z; minus infinity: nothing there
  float facing = 0.0F;
  float value = 0.0F;

  [[nodiscard]] bool covered() const { return depth > -std::numeric_limits<float>::infinity(); }
};

/// Rows [top, top + height) of a raster. Sample (x, y) stands for the point (x + 1/2, y + 1/2).
class DepthBuffer {
 public:
  DepthBuffer(int width, int top, int height)
      : width_(width), top_(top), height_(height), samples_(static_cast<std::size_t>(width) * height) {}

  /// Draws what is not nearer to the viewer than `nearest`: the rest is cut away.
  void draw(const ProjectedSurface& surface, double nearest = infinity);

  /// Precondition: top <= y < top + height.
  [[nodiscard]] const Sample& at(int x, int y) const { return samples_[index(x, y)]; }

 private:
  void draw(const ProjectedSurface& surface, const std::array<std::uint32_t, 3>& triangle, double nearest);
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - top_) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }

  int width_, top_, height_;
  std::vector<Sample> samples_;
};

}  // namespace verisq::report
