/// Nearest bone and nearest implant at each sample, shaded by a lamp at the viewer's eye.
#include "host/report/bone_panel.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "verisq/enclosure.hpp"

namespace verisq::report {
namespace {

constexpr int band_height = 64;  // pixels: the memory for samples does not grow with the picture's height

const Colour white(1.0, 1.0, 1.0);
const Colour metal(0.78, 0.79, 0.81);
const Colour metal_outline(0.13, 0.14, 0.17);

Colour mixed(const Colour& a, const Colour& b, double part_of_b) {
  return (1.0 - part_of_b) * a + part_of_b * b;
}

/// Darker where the surface turns away, which draws its outline, too.
double lit(double facing) {
  return 0.42 + 0.58 * std::pow(std::abs(facing), 0.8);
}

Colour bone_colour(const Sample& bone, const ColourScale& scale) {
  return lit(bone.facing) * scale.colour(bone.value * scale.range());
}

Colour metal_colour(const Sample& implant) {
  const double facing = std::abs(implant.facing);
  const double gleam = 0.25 * std::pow(facing, 30.0);
  return mixed((0.25 + 0.75 * facing) * metal, white, gleam);
}

/// A dark outline and a hint of its form: what lies on the bone stays legible.
Colour through_bone(const Colour& bone, const Sample& implant) {
  const double grazing = 1.0 - std::abs(implant.facing);
  return mixed(bone, metal_outline, 0.12 + 0.55 * grazing * grazing);
}

Colour seen(const Sample& bone, const Sample& implant, const ColourScale& scale) {
  if (implant.covered() && implant.depth >= bone.depth) return metal_colour(implant);
  if (!bone.covered()) return white;
  const Colour colour = bone_colour(bone, scale);
  return implant.covered() ? through_bone(colour, implant) : colour;
}

/// From the farthest to the nearest point, in the coordinates of the scene.
struct Depths {
  double farthest = infinity;
  double nearest = -infinity;

  [[nodiscard]] double at(double share) const { return farthest + share * (nearest - farthest); }
};

Depths depths_of(const ProjectedSurface& surface) {
  Depths depths;
  for (const Eigen::Vector3d& vertex : surface.vertices) {
    depths.nearest = std::max(depths.nearest, vertex[2]);
    depths.farthest = std::min(depths.farthest, vertex[2]);
  }
  return depths;
}

/// Through the middle of the implant, or as near to it as there is bone on both sides: a cut that shows none tells
/// nothing.
double depth_of_cut(const Scene& scene) {
  const Depths bone = depths_of(scene.bone);
  return std::clamp(depths_of(scene.implant).at(0.5), bone.at(0.25), bone.at(0.75));
}

}  // namespace

void draw_panel(const Scene& scene, BoneShown shown, const ColourScale& scale, int width, int height,
                const RowSink& sink) {
  constexpr int side = samples_a_pixel_side;
  const bool cuts_open = shown == BoneShown::cut && !scene.implant.vertices.empty() && !scene.bone.vertices.empty();
  const double nearest = cuts_open ? depth_of_cut(scene) : infinity;
  std::vector<Colour> colours(static_cast<std::size_t>(width));
  for (int top = 0; top < height; top += band_height) {
    const int rows = std::min(band_height, height - top);
    DepthBuffer bone(side * width, side * top, side * rows);
    DepthBuffer implant(side * width, side * top, side * rows);
    bone.draw(scene.bone, nearest);
    implant.draw(scene.implant);
    for (int row = top; row < top + rows; ++row) {
      for (int column = 0; column < width; ++column) {
        Colour sum = Colour::Zero();
        for (int k = 0; k < side * side; ++k) {
          const int x = side * column + k % side;
          const int y = side * row + k / side;
          sum += seen(bone.at(x, y), implant.at(x, y), scale);
        }
        colours[static_cast<std::size_t>(column)] = sum / (side * side);
      }
      sink(row, colours);
    }
  }
}

}  // namespace verisq::report
