/// One drawing of bone and implant: the pixels without words.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <span>

#include "host/report/colour_scale.hpp"
#include "host/report/depth_buffer.hpp"

namespace verisq::report {

/// Bone and implant in the samples of a panel, of which a pixel has 2 x 2.
struct Scene {
  ProjectedSurface bone;     ///< values: the bone's lower bounds in ranges of the scale; not a number: none
  ProjectedSurface implant;  ///< no values
};

enum class BoneShown {
  whole,  ///< the implant shows through
  cut,    ///< what is nearer to the viewer than the implant's middle is cut away
};

constexpr int samples_a_pixel_side = 2;

/// Receives each row of the panel, from the top.
using RowSink = std::function<void(int row, std::span<const Colour> colours)>;

/// Draws a panel of width x height pixels on a white ground.
void draw_panel(const Scene& scene, BoneShown shown, const ColourScale& scale, int width, int height,
                const RowSink& sink);

}  // namespace verisq::report
