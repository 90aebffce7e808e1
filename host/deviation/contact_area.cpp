/// Hands mesh and model to the searches of `verify/deviation`.
#include "verisq/contact_area.hpp"

#include <fmt/core.h>

#include <cmath>
#include <functional>

#include "host/deviation/contact_tolerance.hpp"
#include "host/deviation/deviation_check.hpp"
#include "host/deviation/mapped_distances.hpp"
#include "host/errors/refusal.hpp"
#include "host/threads/parallel.hpp"
#include "verify/deviation/mesh_distances.hpp"
#include "verify/deviation/model_distances.hpp"
#include "verify/deviation/triangle_tree.hpp"

namespace verisq {
namespace {

void check_options(const Model& model, const ContactAreaOptions& options) {
  if (!(options.distance >= 0.0 && std::isfinite(options.distance)))
    refuse(fmt::format("the distance {} is not 0 or more", options.distance));
  if (!(options.share_width > 0.0)) refuse(fmt::format("the width {} is not above 0", options.share_width));
  if (!options.counted.empty() && options.counted.size() != model.primitives.size())
    refuse(fmt::format("{} primitives count or do not, of {}", options.counted.size(), model.primitives.size()));
}

verify::DeviationSearch search_of(const Model& model, const MappedDistances& to_model,
                                  const ContactAreaOptions& options) {
  verify::DeviationSearch search{.to_model = to_model,
                                 .convex = model.primitives.size() == 1 && is_union_of_convex(model),
                                 .allowed = [](double) { return 0.0; },  // shares have a width of their own
                                 .in_parallel = in_parallel<std::function<void(std::size_t)>>,
                                 .ended = options.interrupted,
                                 .progress = [](double) {},
                                 .most_samples = options.most_samples};
  if (model.primitives.size() == 1 && !model.csg) return search;
  const MapOptions of_primitives{
      .tolerance = contact_tolerance(model), .device = options.device, .interrupted = options.interrupted};
  for (const Primitive& primitive : model.primitives)
    search.to_each_primitive.emplace_back(MappedDistances({model.units, {primitive}, {}}, of_primitives));
  if (is_union_of_convex(model)) search.to_primitives = search.to_each_primitive;
  return search;
}

}  // namespace

ContactAreas contact_areas(const Model& model, const Mesh& mesh, const ContactAreaOptions& options) {
  check_mesh(mesh);
  if (mesh.triangles.empty()) refuse("the mesh has no triangles");
  check_regions(mesh, options.region_of, options.regions);
  check_options(model, options);
  const MappedDistances to_model(
      model, {.tolerance = contact_tolerance(model), .device = options.device, .interrupted = options.interrupted});
  std::vector<Enclosure> at_vertices(mesh.vertices.size(), {-infinity, infinity});
  // What an interrupted map leaves is not specified.
  if (!to_model(mesh.vertices, at_vertices)) at_vertices.assign(mesh.vertices.size(), {-infinity, infinity});
  const verify::DeviationSearch search = search_of(model, to_model, options);
  verify::MeshSearch of_mesh(mesh, at_vertices, search, {options.region_of, options.regions});
  of_mesh.search_within(options.distance, options.share_width);
  ContactAreas found{.of_mesh = of_mesh.within(options.distance), .by_region = {}, .of_model = {}};
  found.samples = mesh.vertices.size() + of_mesh.found().samples;
  if (options.regions > 0) found.by_region = of_mesh.within_by_region(options.distance);
  if (options.of_model) {
    const verify::ModelWithin of_model =
        verify::model_within(model, verify::TriangleTree(verify::triangles_of(mesh)), options.counted, options.distance,
                             options.share_width, search);
    found.of_model = of_model.within;
    found.samples += of_model.samples;
  }
  found.interrupted = options.interrupted();
  return found;
}

}  // namespace verisq
