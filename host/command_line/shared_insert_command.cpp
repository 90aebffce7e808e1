/// Ranges of the vertices of a mesh that every rank reads for itself.
#include "host/command_line/shared_insert_command.hpp"

#include <vector>
#include <verisq/insertion.hpp>
#include <verisq/mesh_file.hpp>

#include "host/command_line/part_option.hpp"
#include "host/command_line/pose_option.hpp"
#include "host/command_line/posed_input.hpp"

namespace verisq::command_line {
namespace {

constexpr const char* closing_words =
    "The options are those of `verisq insert`:\n"
    "  mpirun -n 64 verisq-mpi insert --implant stem.json --mesh femur.ply --along 0,0,-1 --length 100 -o way.npy\n"
    "Each row is [lo, hi], which contains the smallest signed distance from the vertex to the implant along the whole\n"
    "way: the bytes that `verisq insert` writes on the same kind of device, whatever the number of ranks, which share\n"
    "blocks of 1,024 vertices. --resume and the files beside OUT: see `verisq-mpi map --help`. Volumes, and ways that\n"
    "are searched, are those of one process, or of a `verisq-mpi batch`.\n"
    "\n"
    "Exit status: that of `verisq insert`: 0 every enclosure is at most the tolerance wide, 3 one is wider, 2 bad\n"
    "usage or input.";

void check_usage(const SharedInsertArguments& arguments) {
  check_usage(arguments.inputs);
  (void)format_of_part(arguments.rows.output, std::nullopt);
  refuse_to_overwrite(arguments.rows.output, arguments.inputs);
}

std::vector<PartSetting> settings_of(const SharedInsertArguments& arguments, double tolerance,
                                     const std::vector<Pose>& path) {
  std::vector<PartSetting> settings = settings_of(arguments.rows, tolerance);
  settings.push_back({"command", "insert"});
  if (arguments.inputs.pose) settings.push_back({"pose", option_text(*arguments.inputs.pose)});
  for (const Pose& pose : path) settings.push_back({"way", option_text(pose)});
  return settings;
}

}  // namespace

void declare_shared_insert(Options& options, SharedInsertArguments& arguments) {
  options.explain(closing_words);
  declare_inputs(options, arguments.inputs);
  declare_shared_rows(options, arguments.rows);
}

ExitStatus run_shared_insert(const SharedInsertArguments& arguments, const mpi::Session& session) {
  check_usage(arguments);
  const Model implant = read_model_at(arguments.inputs.pose, arguments.inputs.implant);
  const Mesh bone = read_mesh(arguments.inputs.mesh);
  const std::vector<Pose> path = path_of(arguments.inputs, implant);
  const double tolerance = tolerance_of(arguments.inputs, implant);
  InsertionMapper mapper(path, implant, bone.vertices,
                         {.tolerance = tolerance, .device = device_of(arguments.rows, session)});
  const mpi::SharedMapRequest request{.output = arguments.rows.output,
                                      .rows = bone.vertices.size(),
                                      .rows_of_block = points_per_insertion_block,
                                      .subjects = {arguments.inputs.implant, arguments.inputs.mesh},
                                      .settings = settings_of(arguments, tolerance, path),
                                      .resume = arguments.rows.resume};
  const auto map = [&](const RowRange& range, const std::function<void(std::span<const MapResult>)>& deliver) {
    const Insertion insertion = mapper(range.first, range.count);
    deliver(insertion.rows);
    return insertion.summary;
  };
  return share_rows(arguments.rows, request, tolerance, session, map);
}

}  // namespace verisq::command_line
