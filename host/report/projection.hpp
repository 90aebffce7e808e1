/// From a mesh in model units to the raster of a panel.
#pragma once

#include <span>
#include <verisq/mesh.hpp>

#include "host/report/depth_buffer.hpp"
#include "host/report/view.hpp"

namespace verisq::report {

/// Where the plane of the view lies in the raster: x -> scale (x - x0), y -> scale (y0 - y).
struct RasterTransform {
  double scale;  ///< samples for one unit of the view
  double left;   ///< x0
  double top;    ///< y0
};

/// The largest in which all of both meshes lies in the middle of width x height samples, `margin` off the edges.
[[nodiscard]] RasterTransform fitted(const View& view, const Mesh& bone, const Mesh& implant, double width,
                                     double height, double margin);

/// `values`: one a vertex, or none.
[[nodiscard]] ProjectedSurface projected(const Mesh& mesh, std::vector<float> values, const View& view,
                                         const RasterTransform& raster);

}  // namespace verisq::report
