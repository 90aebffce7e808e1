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

const char* yes_or_no(bool fact) {
  return fact ? "yes" : "no";
}

std::string how_made(const SurfaceReport& report) {
  std::string text =
      fmt::format("input points       {}\nmethod             {}", report.points, name(report.options.method));
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
  text += fmt::format("Euler character.   {}", topology.euler_characteristic());
  if (const auto genus = topology.genus()) text += fmt::format(", genus {}", *genus);
  text += fmt::format("\nvolume             {:.10g}\n", report.check.volume);
  text += fmt::format("farthest point     {:.4g} from the surface\n", report.check.farthest_point);
  text += fmt::format("time               {:.3g} s\nsurface            {}\n", report.seconds, report.output);
  return text;
}

std::string json(const SurfaceReport& report) {
  const MeshTopology& topology = report.check.topology;
  const JsonObject object{
      {"points", report.points},
      {"method", name(report.options.method)},
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
      {"volume", report.check.volume},
      {"farthest_point", report.check.farthest_point},
      {"seconds", report.seconds},
      {"output", report.output},
  };
  return object.text() + "\n";
}

}  // namespace verisq::command_line
