/// The two forms of the summary.
#include "host/command_line/surface_summary.hpp"

#include <fmt/format.h>

#include "host/command_line/json_value.hpp"

namespace verisq::command_line {
namespace {

const char* name(SurfaceMethod method) {
  switch (method) {
    case SurfaceMethod::given: return "given mesh";
    case SurfaceMethod::wrap: return "alpha wrap";
    case SurfaceMethod::alpha_shape: break;
  }
  return "alpha shape";
}

std::string_view name(AnatomicalSpace space) {
  switch (space) {
    case AnatomicalSpace::lps: return "LPS";
    case AnatomicalSpace::ras: return "RAS";
    case AnatomicalSpace::unknown: break;
  }
  return "unknown";
}

const char* yes_or_no(bool fact) {
  return fact ? "yes" : "no";
}

/// How it was made: the name of what decided.
const char* method_of(const SurfaceReport& report) {
  if (report.wall) return "canal";
  return report.label != nullptr ? "label" : name(report.options.method);
}

std::string about_label(const LabelInput& input) {
  const auto& [x, y, z] = input.voxel_lengths;
  return fmt::format(
      "label              {}, {} voxels of {:.4g} x {:.4g} x {:.4g}: volume {:.6g}\n"
      "space              {}\n",
      input.label, input.surface.voxels, x, y, z, static_cast<double>(input.surface.voxels) * input.voxel_volume,
      name(input.space));
}

std::string how_made(const SurfaceReport& report) {
  std::string text = report.label != nullptr ? about_label(*report.label) : "";
  text += fmt::format("input points       {}\nmethod             {}", report.points, method_of(report));
  if (report.options.edge) text += fmt::format(", edges about {:.4g}", *report.options.edge);
  if (report.surface.alpha) text += fmt::format(", alpha {:.6g}", *report.surface.alpha);
  if (report.surface.offset) text += fmt::format(", offset {:.6g}", *report.surface.offset);
  text += "\n";
  if (report.options.fill_holes)
    text += fmt::format("holes filled       {} of {}\n", report.surface.holes_filled, report.surface.holes);
  if (report.options.smoothing_rounds > 0) {
    const double before = report.surface.volume_before_smoothing;
    const double after = report.surface.volume;
    text += fmt::format("smoothing          {} rounds, volume {:.6g} to {:.6g} ({:+.3g} %)\n",
                        report.options.smoothing_rounds, before, after, 100.0 * (after - before) / before);
  }
  return text;
}

JsonValue wall_of(const SurfaceReport& report) {
  if (!report.wall) return {};
  const auto& [least, mean, largest, error] = *report.wall;
  return JsonObject{{"least", least}, {"mean", mean}, {"largest", largest}, {"largest_error", error}};
}

const char* word(Facing facing) {
  return facing == Facing::inward ? "inward" : "outward";
}

}  // namespace

std::string readable(const SurfaceReport& report) {
  const MeshTopology& topology = report.check.topology;
  std::string text = how_made(report);
  text += fmt::format("vertices           {}\ntriangles          {}\n", topology.vertices, topology.triangles);
  text += fmt::format("closed             {}\nmanifold           {}\n", yes_or_no(topology.closed()),
                      yes_or_no(topology.manifold()));
  text +=
      fmt::format("oriented           {}, normals {}\n", yes_or_no(topology.oriented()), word(report.options.facing));
  text += fmt::format("self-intersections {}\n", yes_or_no(report.check.self_intersecting));
  text += fmt::format("components         {}\n", topology.components);
  if (report.check.rims > 0) text += fmt::format("rims               {}\n", report.check.rims);
  text += fmt::format("Euler character.   {}", topology.euler_characteristic());
  if (const auto genus = topology.genus()) text += fmt::format(", genus {}", *genus);
  text += topology.closed() ? fmt::format("\nvolume             {:.10g}\n", report.check.volume) : "\n";
  if (report.wall) {
    text +=
        fmt::format("wall               {:.4g} to {:.4g} thick, mean {:.4g}; at most {:.2g} off what is asked for\n",
                    report.wall->least, report.wall->largest, report.wall->mean, report.wall->largest_error);
  } else if (report.label == nullptr) {
    text += fmt::format("farthest point     {:.4g} from the surface\n", report.check.farthest_point);
  }
  text += fmt::format("time               {:.3g} s\nsurface            {}\n", report.seconds, report.output);
  return text;
}

std::string json(const SurfaceReport& report) {
  const MeshTopology& topology = report.check.topology;
  const LabelInput* const label = report.label;
  const bool is_of_points = label == nullptr && !report.wall;
  const JsonObject object{
      {"points", report.points},
      {"method", method_of(report)},
      {"label", label != nullptr ? JsonValue(label->label) : JsonValue()},
      {"space", label != nullptr ? JsonValue(name(label->space)) : JsonValue()},
      {"voxels", label != nullptr ? JsonValue(label->surface.voxels) : JsonValue()},
      {"voxels_at_border", label != nullptr ? JsonValue(label->surface.voxels_at_border) : JsonValue()},
      {"voxel_volume", label != nullptr ? JsonValue(label->voxel_volume) : JsonValue()},
      {"edge", report.options.edge},
      {"alpha", report.surface.alpha},
      {"offset", report.surface.offset},
      {"holes", report.surface.holes},
      {"holes_filled", report.surface.holes_filled},
      {"smoothing_rounds", report.options.smoothing_rounds},
      {"volume_before_smoothing", report.surface.volume_before_smoothing},
      {"facing", word(report.options.facing)},
      {"vertices", topology.vertices},
      {"edges", topology.edges},
      {"triangles", topology.triangles},
      {"closed", topology.closed()},
      {"rims", report.check.rims},
      {"manifold", topology.manifold()},
      {"oriented", topology.oriented()},
      {"boundary_edges", topology.boundary_edges},
      {"non_manifold_edges", topology.non_manifold_edges},
      {"non_manifold_vertices", topology.non_manifold_vertices},
      {"inconsistent_edges", topology.inconsistent_edges},
      {"self_intersecting", report.check.self_intersecting},
      {"components", topology.components},
      {"euler_characteristic", topology.euler_characteristic()},
      {"genus", topology.genus()},
      {"volume", topology.closed() ? JsonValue(report.check.volume) : JsonValue()},
      {"farthest_point", is_of_points ? JsonValue(report.check.farthest_point) : JsonValue()},
      {"wall", wall_of(report)},
      {"seconds", report.seconds},
      {"output", report.output},
  };
  return object.text() + "\n";
}

}  // namespace verisq::command_line
