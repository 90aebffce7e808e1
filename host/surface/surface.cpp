/// The steps one after the other.
#include <utility>
#include <verisq/error.hpp>
#include <verisq/plane_cut.hpp>
#include <verisq/surface.hpp>

#include "host/surface/alpha_shape.hpp"
#include "host/surface/hole_filling.hpp"
#include "host/surface/largest_part.hpp"
#include "host/surface/orientation.hpp"
#include "host/surface/remeshing.hpp"
#include "host/surface/smoothing.hpp"
#include "host/surface/wrap_alpha.hpp"

namespace verisq {
namespace {

void begin(const SurfaceOptions& options, std::string_view step) {
  if (options.progress) options.progress(step);
}

PreparedSurface wrapped(const Mesh& input, const SurfaceOptions& options) {
  begin(options, "wrapping");
  surface::Wrap wrap = options.alpha ? surface::wrap(input, *options.alpha, options.offset)
                                     : surface::wrap_with_chosen_alpha(input, options.offset);
  return {.mesh = std::move(wrap.mesh), .alpha = wrap.alpha, .offset = wrap.offset};
}

PreparedSurface shaped(const Mesh& input, const SurfaceOptions& options) {
  begin(options, "alpha shape");
  surface::AlphaShape shape = surface::alpha_shape(input.vertices, options.alpha);
  return {.mesh = std::move(shape.mesh), .alpha = shape.alpha, .offset = std::nullopt};
}

PreparedSurface mended(const Mesh& input, const SurfaceOptions& options) {
  if (input.triangles.empty())
    throw Error(ErrorKind::input, "the mesh has no triangles: its points need a method, wrap or alpha");
  PreparedSurface result;
  if (options.fill_holes) {
    begin(options, "filling holes");
    surface::HoleFilling filling = surface::fill_holes(input);
    result.holes = filling.holes;
    result.holes_filled = filling.filled;
    result.mesh = std::move(filling.mesh);
  }
  begin(options, "orienting");
  result.mesh = surface::oriented_outward(options.fill_holes ? result.mesh : input);
  return result;
}

PreparedSurface made(const Mesh& input, const SurfaceOptions& options) {
  switch (options.method) {
    case SurfaceMethod::given: return mended(input, options);
    case SurfaceMethod::wrap: return wrapped(input, options);
    case SurfaceMethod::alpha_shape: break;
  }
  return shaped(input, options);
}

/// The cut leaves slivers, which remeshing mends.
void open(PreparedSurface& surface, const Plane& plane, const SurfaceOptions& options) {
  begin(options, "opening");
  surface::LargestPart part = surface::largest_part(cut_off(surface.mesh, plane).mesh);
  if (part.mesh.triangles.empty())
    throw Error(ErrorKind::input, "all of the surface lies beyond the plane where it is to be opened");
  surface.mesh = options.edge ? surface::remeshed(part.mesh, *options.edge) : std::move(part.mesh);
  surface.parts_left_out = part.parts_left_out;
}

}  // namespace

PreparedSurface prepare_surface(const Mesh& input, const SurfaceOptions& options) {
  PreparedSurface result = made(input, options);
  if (options.edge) {
    begin(options, "remeshing");
    result.mesh = surface::remeshed(result.mesh, *options.edge);
  }
  result.volume_before_smoothing = result.volume = signed_volume(result.mesh);
  if (options.smoothing_rounds > 0) {
    begin(options, "smoothing");
    result.mesh = surface::smoothed(std::move(result.mesh), options.smoothing_rounds);
    result.volume = signed_volume(result.mesh);
  }
  if (options.opening) open(result, *options.opening, options);
  if (options.facing == Facing::inward) result.mesh = surface::reversed(std::move(result.mesh));
  return result;
}

}  // namespace verisq
