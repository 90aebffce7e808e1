/// Pictures: views, the surface that lies in front, colours of distances, and drawings by cairo.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include <verisq/distance.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>
#include <verisq/report.hpp>

#include "verisq/enclosure.hpp"

// Pictures: colours of distances, and drawings of a map by cairo.

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

// The viewpoint of a picture, and the pixels of bone and implant seen from there.

// The viewpoint of a picture.

/// Turns, moves and scales points: x to the right, y up, z towards the viewer; bone and implant within [-1, 1]^3 (and
/// somewhat more, where turned).
struct View {
  Eigen::Matrix3d axes;  ///< rows: right, up, towards the viewer; a rotation
  Point centre;
  double half_size;

  [[nodiscard]] Eigen::Vector3d operator()(const Point& point) const {
    const Eigen::Vector3d moved(point[0] - centre[0], point[1] - centre[1], point[2] - centre[2]);
    return axes * (moved / half_size);
  }
};

/// A vector of length 1: `asked`, or the bone's long axis, towards the implant's end. An implant in the middle third
/// has no end: then the axis points as positive as possible, as scanners place bodies.
[[nodiscard]] Eigen::Vector3d upright(const Mesh& bone, const Mesh& implant, const std::optional<Point>& asked);

/// The view with `up` on top, from the side where the bone is broadest. Precondition: `up` of length 1.
[[nodiscard]] View broad_view(const Mesh& bone, const Mesh& implant, const Eigen::Vector3d& up);

// The part of a surface that is nearest to the viewer at each sample of a raster.

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

// From a mesh in model units to the raster of a panel.

/// Where the plane of the view lies in the raster: x -> scale (x - x0), y -> scale (y0 - y).
struct RasterTransform {
  double scale;  ///< samples for one unit of the view
  double left;   ///< x0
  double top;    ///< y0
};

/// The largest transform that places all of both meshes in the middle of width x height samples, `margin` off the
/// edges.
[[nodiscard]] RasterTransform fitted(const View& view, const Mesh& bone, const Mesh& implant, double width,
                                     double height, double margin);

/// `values`: one a vertex, or none.
[[nodiscard]] ProjectedSurface projected(const Mesh& mesh, std::vector<float> values, const View& view,
                                         const RasterTransform& raster);

// One drawing of bone and implant: the pixels without words.

/// Bone and implant in the samples of a panel; a pixel has 2 x 2 samples.
struct Scene {
  ProjectedSurface bone;     ///< values: the bone's lower bounds in ranges of the scale; not a number: none
  ProjectedSurface implant;  ///< no values
};

enum class BoneShown {
  whole,  ///< the implant shows through
  cut,    ///< everything nearer to the viewer than the implant's middle is cut away
};

constexpr int samples_a_pixel_side = 2;

/// Receives each row of the panel, from the top.
using RowSink = std::function<void(int row, std::span<const Colour> colours)>;

/// Draws a panel of width x height pixels on a white ground.
void draw_panel(const Scene& scene, BoneShown shown, const ColourScale& scale, int width, int height,
                const RowSink& sink);

// Triangles for drawing a model, also at the end of an implant's way. For display alone: nothing about them is proven.

// Triangles for drawing a model. For display alone: binary64 to nearest, nothing about them is proven.

/// The boundary of the model's solid, outward by the right-hand rule; every vertex lies on the surface of a primitive
/// but for rounding. One primitive alone gives a closed surface. Where primitives meet, whole small triangles are kept
/// or left out, with no gaps between them: the edges of cuts are ragged by a fraction of a triangle.
[[nodiscard]] Mesh model_surface(const Model& model);

// The implant of a report at the end of its way.

[[nodiscard]] inline Mesh seated_surface(const Report& report) {
  return model_surface(report.path.empty() ? report.implant : posed(report.implant, report.path.back()));
}

}  // namespace verisq::report
