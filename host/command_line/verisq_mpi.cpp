/// The program `verisq-mpi`: `verisq map` for all ranks of an MPI job. A program of its own, so that no other command
/// is linked with MPI, whose library takes longer to start than a small map.
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <verisq/device.hpp>
#include <verisq/map.hpp>
#include <verisq/uncertain_model.hpp>
#include <verisq/version.hpp>

#include "host/command_line/choice.hpp"
#include "host/command_line/default_tolerance.hpp"
#include "host/command_line/json_value.hpp"
#include "host/command_line/length_option.hpp"
#include "host/command_line/overwriting.hpp"
#include "host/command_line/part_option.hpp"
#include "host/command_line/point_stream.hpp"
#include "host/command_line/pose_option.hpp"
#include "host/command_line/pose_uncertainty_option.hpp"
#include "host/command_line/posed_input.hpp"
#include "host/command_line/run_program.hpp"
#include "host/command_line/shared_options.hpp"
#include "host/command_line/stopwatch.hpp"
#include "host/command_line/triangle_stream.hpp"
#include "host/errors/refusal.hpp"
#include "host/mpi/communicator.hpp"
#include "host/mpi/shared_map.hpp"

namespace verisq::command_line {
namespace {

constexpr const char* closing_words =
    "Run it by mpirun or srun, with the options of `verisq map`:\n"
    "  mpirun -n 64 verisq-mpi --model stem.json --points samples.npy -o distances.npy\n"
    "The file has the bytes that `verisq map` writes on the same kind of device, whatever the number of ranks. Ranks "
    "take\n"
    "chunks of whole blocks of rows from a counter, and write them where they belong by MPI-IO. Beside OUT are, while "
    "it\n"
    "runs, OUT.rows, OUT.chunks and OUT.job: where a rank dies, MPI ends the job, and the same command with --resume,\n"
    "on as many ranks as there are then, makes what is not finished yet.\n"
    "\n"
    "Exit status: that of `verisq map`: 0 every enclosure is at most the tolerance wide, 3 one is wider, 2 bad usage "
    "or\n"
    "input.";

struct MpiArguments {
  InputArguments inputs;
  MapElements on = MapElements::vertices;
  std::optional<double> tolerance;
  double point_radius = 0.0;
  PoseUncertaintyArguments pose_uncertainty;
  std::string device = "auto";
  bool device_of_rank = false;
  std::string output;
  bool resume = false;
  bool json = false;
};

void declare(Options& options, MpiArguments& arguments) {
  options.explain(closing_words);
  declare_inputs(options, arguments.inputs);
  options.add("--on", arguments.on,
              choice<MapElements>({{"vertices", MapElements::vertices}, {"triangles", MapElements::triangles}}), "WHAT",
              "What of the mesh is mapped: vertices (default) or triangles");
  add_tolerance(options, arguments.tolerance, "the model");
  options.add("--point-radius", arguments.point_radius, parse_length, "NUMBER",
              "Each vertex or point is any within this distance of the given one, in model units (default 0)");
  add_pose_uncertainty(options, arguments.pose_uncertainty, "The model's");
  options.add("--device", arguments.device, "DEVICE", "As of `verisq map`, on every rank");
  options.add_flag("--device-of-rank", arguments.device_of_rank,
                   "Rank k of a machine takes its device k (modulo how many there are), as `verisq devices` counts");
  options.require("-o,--output", arguments.output, "FILE", "The map: .npy, or .csv, which rank 0 writes in the end");
  options.add_flag("--resume", arguments.resume, "Go on with the job that left OUT.job");
  options.add_flag("--json", arguments.json, "Print the summary as one JSON object; what is not bounded is null");
}

void check_usage(const MpiArguments& arguments) {
  check_usage(arguments.inputs);
  if (arguments.inputs.points == "-") refuse("--points -: ranks have no standard input in common: give a file");
  if (arguments.on == MapElements::triangles && arguments.inputs.mesh.empty()) {
    refuse("--on triangles: give their --mesh");
  }
  (void)format_of_part(arguments.output, std::nullopt);
  refuse_to_overwrite("-o", arguments.output, {arguments.inputs.model, arguments.inputs.mesh, arguments.inputs.points});
}

std::string device_of(const MpiArguments& arguments, std::uint64_t rows, const mpi::Session& session) {
  if (arguments.device == "auto" && rows <= few_rows) return "host";
  if (!arguments.device_of_rank) return arguments.device;
  const std::size_t devices = test_devices().size();
  return devices == 0 ? "host" : std::to_string(static_cast<std::size_t>(session.local_rank()) % devices);
}

std::vector<PartSetting> settings_of(const MpiArguments& arguments, const MapOptions& options) {
  std::vector<PartSetting> settings{{"tolerance", fmt::format("{}", options.tolerance)},
                                    {"point_radius", fmt::format("{}", options.point_radius)},
                                    {"format", std::filesystem::path(arguments.output).extension().string()}};
  if (arguments.on == MapElements::triangles) settings.push_back({"on", "triangles"});
  if (arguments.inputs.pose) settings.push_back({"pose", option_text(*arguments.inputs.pose)});
  if (options.pose_uncertainty) settings.push_back({"place", text_of(*options.pose_uncertainty)});
  return settings;
}

void print(const mpi::SharedMapResult& result, const MpiArguments& arguments, const mpi::Session& session,
           double tolerance, double seconds) {
  const MapSummary& summary = result.summary;
  if (arguments.json) {
    JsonObject object{{"points", summary.points},
                      {"device_verified", summary.device_verified},
                      {"host_verified", summary.host_verified},
                      {"wide", summary.wide},
                      {"device", summary.device},
                      {"tolerance", tolerance},
                      {"largest_width", summary.largest_width},
                      {"ranks", session.ranks()},
                      {"chunks", result.chunks},
                      {"taken_over", result.taken_over},
                      {"device_seconds", summary.device_seconds},
                      {"host_seconds", summary.host_seconds},
                      {"seconds", seconds},
                      {"output", arguments.output}};
    if (summary.points > 0) object.set("smallest_distance", Enclosure{summary.minimum_lo, summary.minimum_hi});
    fmt::print("{}\n", object.text());
    return;
  }
  fmt::print("points             {}\n", summary.points);
  fmt::print("  device-verified  {}\n  host-verified    {}\n  wide             {}\n", summary.device_verified,
             summary.host_verified, summary.wide);
  fmt::print("ranks              {}, {} chunks\n", session.ranks(), result.chunks);
  if (result.taken_over > 0) fmt::print("taken over         {} rows of an earlier job\n", result.taken_over);
  fmt::print("device             {}\n", summary.device);
  fmt::print("smallest distance  [{}, {}]\n", summary.minimum_lo, summary.minimum_hi);
  fmt::print("time               {:.3g} s (of all ranks: device {:.3g} s, host proofs {:.3g} s)\n", seconds,
             summary.device_seconds, summary.host_seconds);
  fmt::print("map                {}\n", arguments.output);
}

/// What all ranks do alike before the first row, and what one of them may fail at.
template <class Stream>
struct Prepared {
  Stream stream;
  std::uint64_t rows;
  MapOptions options;
  Mapper<typename Stream::Element> mapper;

  Prepared(const MpiArguments& arguments, const mpi::Session& session)
      : stream(arguments.inputs), rows(count_elements(stream)), options{.tolerance = 0.0}, mapper([&] {
          const UncertainModel model = read_uncertain_model_at(arguments.inputs.pose, arguments.inputs.model);
          const double radius = bounding_radius(bracket(model).largest);
          options.tolerance = arguments.tolerance ? *arguments.tolerance
                                                  : default_tolerance(tolerance_of_distances, radius, "the model");
          options.point_radius = arguments.point_radius;
          options.pose_uncertainty = pose_uncertainty(arguments.pose_uncertainty, arguments.inputs.pose);
          options.device = device_of(arguments, rows, session);
          return Mapper<typename Stream::Element>(model, options);
        }()) {}
};

template <class Stream>
ExitStatus map_all(const MpiArguments& arguments, const mpi::Session& session) {
  using Element = typename Stream::Element;
  const Stopwatch time;
  Prepared<Stream> prepared(arguments, session);
  const mpi::SharedMapRequest request{
      .output = arguments.output,
      .rows = prepared.rows,
      .subjects = {arguments.inputs.model,
                   arguments.inputs.mesh.empty() ? arguments.inputs.points : arguments.inputs.mesh},
      .settings = settings_of(arguments, prepared.options),
      .resume = arguments.resume};
  std::string device;
  double device_seconds = 0.0;
  double host_seconds = 0.0;
  const auto map = [&](const RowRange& range, const std::function<void(std::span<const MapResult>)>& rows) {
    prepared.stream.go_to(range.first);
    std::uint64_t left = range.count;
    const MapSummary summary = prepared.mapper.map(
        [&](std::span<Element> elements) {
          const auto most = static_cast<std::size_t>(std::min<std::uint64_t>(elements.size(), left));
          const std::size_t count = prepared.stream.read(elements.first(most));
          left -= count;
          return count;
        },
        [&](auto, std::span<const MapResult> results, auto) { rows(results); });
    device = summary.device;
    device_seconds += summary.device_seconds;
    host_seconds += summary.host_seconds;
    return summary;
  };
  mpi::SharedMapResult result = mpi::shared_map(session, request, map);
  result.summary.device = device;
  result.summary.device_seconds = session.sum(device_seconds);
  result.summary.host_seconds = session.sum(host_seconds);
  if (session.rank() == 0) print(result, arguments, session, prepared.options.tolerance, time.seconds());
  return result.summary.wide > 0 ? ExitStatus::unverified : ExitStatus::verified;
}

ExitStatus run(const MpiArguments& arguments, const mpi::Session& session) {
  check_usage(arguments);
  if (arguments.on == MapElements::triangles) return map_all<TriangleStream>(arguments, session);
  return map_all<PointStream>(arguments, session);
}

/// One message for all ranks; a rank that fails alone ends the others.
ExitStatus run_guarded(const MpiArguments& arguments, const mpi::Session& session) {
  try {
    return run(arguments, session);
  } catch (const Error& error) {
    const auto status = static_cast<int>(error.kind() == ErrorKind::input ? ExitStatus::bad_input : ExitStatus::failed);
    // What is wrong with the input all ranks find out; rank 0 says it, unless another one alone has.
    constexpr auto patience = std::chrono::seconds(2);
    if (session.rank() != 0) std::this_thread::sleep_for(patience);
    fmt::print(stderr, "verisq-mpi: {}\n", error.what());
    std::fflush(stderr);
    session.abort(status);
  }
}

}  // namespace
}  // namespace verisq::command_line

int main(int argc, char** argv) {
  using namespace verisq::command_line;
  const verisq::mpi::Session session(argc, argv);
  const Program program{.name = "verisq-mpi",
                        .description = "verisq-mpi: one map, of points or triangles, made by all ranks of an MPI job."};
  const Command command{program.name, program.description, [&session](Options& options) -> Action {
                          const auto arguments = std::make_shared<MpiArguments>();
                          declare(options, *arguments);
                          return [arguments, &session] { return run_guarded(*arguments, session); };
                        }};
  return run_program(program, command, argc, argv);
}
