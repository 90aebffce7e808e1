/// The two forms of the summary.
#include "host/command_line/mesh_summary.hpp"

#include <fmt/core.h>

#include "host/command_line/directed_digits.hpp"
#include "host/command_line/json_value.hpp"

namespace verisq::command_line {

std::string readable(const MeshReport& report) {
  const std::string units = report.units.empty() ? "" : " " + report.units;
  const std::string cubic_units = report.units.empty() ? "" : units + "^3";
  const MeshTopology& topology = report.topology;
  std::string text;
  const std::string deviation = report.proven
                                    ? fmt::format("{}{}, proven both ways", outward_digits(*report.proven), units)
                                    : fmt::format("{:.3g}{}, estimated at {} points of the mesh, not proven",
                                                  report.found.estimated_deviation, units, report.found.samples);
  text += fmt::format("deviation          {}; wanted {:g}{}\n", deviation, report.deviation, units);
  text += fmt::format("triangles          {}\n", topology.triangles);
  text += fmt::format("vertices           {}\n", topology.vertices);
  text += fmt::format("surface            closed, manifold, outward; {} of genus {}\n",
                      topology.components == 1 ? "one component" : fmt::format("{} components", topology.components),
                      topology.genus().value_or(0));
  text += fmt::format("volume             {:.6g}{}\n", report.volume, cubic_units);
  text += fmt::format("time               {:.3g} s\n", report.seconds);
  text += fmt::format("mesh               {}\n", report.output);
  return text;
}

std::string json(const MeshReport& report) {
  const MeshTopology& topology = report.topology;
  const JsonObject object{
      {"proven_deviation", report.proven}, {"deviation", report.deviation}, {"units", report.units},
      {"triangles", topology.triangles},   {"vertices", topology.vertices}, {"components", topology.components},
      {"genus", topology.genus()},         {"closed", topology.closed()},   {"manifold", topology.manifold()},
      {"oriented", topology.oriented()},   {"volume", report.volume},       {"seconds", report.seconds},
      {"output", report.output},
  };
  return object.text() + "\n";
}

}  // namespace verisq::command_line
