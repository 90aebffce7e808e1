/// Ranges of points or triangles from a file that every rank reads for itself.
#include "host/command_line/shared_map_command.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>
#include <verisq/map.hpp>
#include <verisq/uncertain_model.hpp>

#include "host/command_line/choice.hpp"
#include "host/command_line/default_tolerance.hpp"
#include "host/command_line/length_option.hpp"
#include "host/command_line/overwriting.hpp"
#include "host/command_line/part_option.hpp"
#include "host/command_line/pose_option.hpp"
#include "host/command_line/posed_input.hpp"
#include "host/command_line/shared_options.hpp"
#include "host/command_line/triangle_stream.hpp"
#include "host/errors/refusal.hpp"

namespace verisq::command_line {
namespace {

constexpr const char* closing_words =
    "The options are those of `verisq map`:\n"
    "  mpirun -n 64 verisq-mpi map --model stem.json --points samples.npy -o distances.npy\n"
    "The file has the bytes that `verisq map` writes on the same kind of device, whatever the number of ranks. Ranks\n"
    "take chunks of whole blocks of rows from a counter, and write them where they belong by MPI-IO. Beside OUT are,\n"
    "while it runs, OUT.rows, OUT.chunks and OUT.job: where a rank dies, MPI ends the job, and the same command with\n"
    "--resume, on as many ranks as there are then, makes what is not finished yet.\n"
    "\n"
    "Exit status: that of `verisq map`: 0 every enclosure is at most the tolerance wide, 3 one is wider, 2 bad usage\n"
    "or input.";

void check_usage(const SharedMapArguments& arguments) {
  check_usage(arguments.inputs);
  if (arguments.inputs.points == "-") refuse("--points -: ranks have no standard input in common: give a file");
  if (arguments.on == MapElements::triangles && arguments.inputs.mesh.empty()) {
    refuse("--on triangles: give their --mesh");
  }
  (void)format_of_part(arguments.rows.output, std::nullopt);
  refuse_to_overwrite("-o", arguments.rows.output,
                      {arguments.inputs.model, arguments.inputs.mesh, arguments.inputs.points});
}

std::vector<PartSetting> settings_of(const SharedMapArguments& arguments, const MapOptions& options) {
  std::vector<PartSetting> settings = settings_of(arguments.rows, options.tolerance);
  settings.push_back({"point_radius", fmt::format("{}", options.point_radius)});
  if (arguments.on == MapElements::triangles) settings.push_back({"on", "triangles"});
  if (arguments.inputs.pose) settings.push_back({"pose", option_text(*arguments.inputs.pose)});
  if (options.pose_uncertainty) settings.push_back({"place", text_of(*options.pose_uncertainty)});
  return settings;
}

MapOptions options_of(const SharedMapArguments& arguments, const UncertainModel& model, std::uint64_t rows,
                      const mpi::Session& session) {
  const double radius = bounding_radius(bracket(model).largest);
  const SharedRowsArguments& given = arguments.rows;
  return {.tolerance = arguments.tolerance ? *arguments.tolerance
                                           : default_tolerance(tolerance_of_distances, radius, "the model"),
          .device = given.device == "auto" && rows <= few_rows ? "host" : device_of(given, session),
          .point_radius = arguments.point_radius,
          .pose_uncertainty = pose_uncertainty(arguments.pose_uncertainty, arguments.inputs.pose)};
}

template <class Stream>
ExitStatus map_all(const SharedMapArguments& arguments, const mpi::Session& session) {
  using Element = typename Stream::Element;
  Stream stream(arguments.inputs);
  const std::uint64_t rows = count_elements(stream);
  const UncertainModel model = read_uncertain_model_at(arguments.inputs.pose, arguments.inputs.model);
  const MapOptions options = options_of(arguments, model, rows, session);
  Mapper<Element> mapper(model, options);
  const std::string& elements_file = arguments.inputs.mesh.empty() ? arguments.inputs.points : arguments.inputs.mesh;
  const mpi::SharedMapRequest request{.output = arguments.rows.output,
                                      .rows = rows,
                                      .subjects = {arguments.inputs.model, elements_file},
                                      .settings = settings_of(arguments, options),
                                      .resume = arguments.rows.resume};
  const auto map = [&](const RowRange& range, const std::function<void(std::span<const MapResult>)>& deliver) {
    stream.go_to(range.first);
    std::uint64_t left = range.count;
    return mapper.map(
        [&](std::span<Element> elements) {
          const auto most = static_cast<std::size_t>(std::min<std::uint64_t>(elements.size(), left));
          const std::size_t count = stream.read(elements.first(most));
          left -= count;
          return count;
        },
        [&](auto, std::span<const MapResult> results, auto) { deliver(results); });
  };
  return share_rows(arguments.rows, request, options.tolerance, session, map);
}

}  // namespace

void declare_shared_map(Options& options, SharedMapArguments& arguments) {
  options.explain(closing_words);
  declare_inputs(options, arguments.inputs);
  options.add("--on", arguments.on,
              choice<MapElements>({{"vertices", MapElements::vertices}, {"triangles", MapElements::triangles}}), "WHAT",
              "What of the mesh is mapped: vertices (default) or triangles");
  add_tolerance(options, arguments.tolerance, "the model");
  options.add("--point-radius", arguments.point_radius, parse_length, "NUMBER",
              "Each vertex or point is any within this distance of the given one, in model units (default 0)");
  add_pose_uncertainty(options, arguments.pose_uncertainty, "The model's");
  declare_shared_rows(options, arguments.rows);
}

ExitStatus run_shared_map(const SharedMapArguments& arguments, const mpi::Session& session) {
  check_usage(arguments);
  if (arguments.on == MapElements::triangles) return map_all<TriangleStream>(arguments, session);
  return map_all<PointStream>(arguments, session);
}

}  // namespace verisq::command_line
