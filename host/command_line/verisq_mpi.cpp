/// The program `verisq-mpi`: commands of `verisq` for all ranks of an MPI job.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <vector>
#include <verisq/device.hpp>
#include <verisq/error.hpp>
#include <verisq/files.hpp>
#include <verisq/insertion.hpp>
#include <verisq/map.hpp>
#include <verisq/map_file.hpp>
#include <verisq/model.hpp>

#include "host/command_line/batch_command.hpp"
#include "host/command_line/inputs.hpp"
#include "host/command_line/options.hpp"
#include "host/command_line/run.hpp"
#include "host/command_line/shared_inputs.hpp"
#include "host/command_line/summaries.hpp"
#include "host/errors/refusal.hpp"
#include "host/mpi/shared_map.hpp"

namespace verisq::command_line {
namespace {

// A command that all ranks of an MPI job run together.

/// Runs it. If a rank fails, one message is printed for all, and the others are ended, which would wait for it.
ExitStatus run_guarded(const mpi::Session& session, const std::function<ExitStatus()>& run);

/// Like `command`. `session` must outlive the command.
template <class Arguments>
[[nodiscard]] Command shared_command(const std::string& name, const std::string& description,
                                     const mpi::Session& session, void (*declare)(Options&, Arguments&),
                                     ExitStatus (*run)(const Arguments&, const mpi::Session&)) {
  return {name, description, [&session, declare, run](Options& options) -> Action {
            const auto arguments = std::make_shared<Arguments>();
            declare(options, *arguments);
            return
                [&session, arguments, run] { return run_guarded(session, [&] { return run(*arguments, session); }); };
          }};
}

// The common part of `verisq-mpi map` and `insert`: a rank's device, and how a shared map continues and ends.

struct SharedRowsArguments {
  std::string device = "auto";
  bool device_of_rank = false;
  std::string output;
  bool resume = false;
  bool json = false;
};

// `verisq-mpi batch`: the cases of a cohort by all ranks of an MPI job.

// `verisq-mpi map`: one map by all ranks of an MPI job.

/// As typed.
struct SharedMapArguments {
  InputArguments inputs;
  MapElements on = MapElements::vertices;
  std::optional<double> tolerance;
  double point_radius = 0.0;
  PoseUncertaintyArguments pose_uncertainty;
  SharedRowsArguments rows;
};

void declare_shared_map(Options& options, SharedMapArguments& arguments);

/// Called by all ranks. Throws Error as `verisq map`.
ExitStatus run_shared_map(const SharedMapArguments& arguments, const mpi::Session& session);

// `verisq-mpi insert`: how deep an implant cuts into the bone on its way in, by all ranks of an MPI job.

/// As typed.
struct SharedInsertArguments {
  InsertionInputs inputs;
  SharedRowsArguments rows;
};

void declare_shared_insert(Options& options, SharedInsertArguments& arguments);

/// Called by all ranks. Throws Error as `verisq insert`.
ExitStatus run_shared_insert(const SharedInsertArguments& arguments, const mpi::Session& session);

ExitStatus run_guarded(const mpi::Session& session, const std::function<ExitStatus()>& run) {
  try {
    return run();
  } catch (const Error& error) {
    const auto status = static_cast<int>(error.kind() == ErrorKind::input ? ExitStatus::bad_input : ExitStatus::failed);
    // All ranks find errors in the input; rank 0 reports them, unless another one alone has found one.
    constexpr auto patience = std::chrono::seconds(2);
    if (session.rank() != 0) std::this_thread::sleep_for(patience);
    fmt::print(stderr, "verisq-mpi: {}\n", on_one_line(as_typed(error.what())));
    std::fflush(stderr);
    session.abort(status);
  }
}

void print(const mpi::SharedMapResult& result, const SharedRowsArguments& arguments, const mpi::Session& session,
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
  fmt::print("device             {}\n", quotation(summary.device));
  fmt::print("smallest distance  [{}, {}]\n", summary.minimum_lo, summary.minimum_hi);
  fmt::print("time               {:.3g} s (of all ranks: device {:.3g} s, host proofs {:.3g} s)\n", seconds,
             summary.device_seconds, summary.host_seconds);
  fmt::print("map                {}\n", quotation(arguments.output));
}

/// Adds --device, --device-of-rank, -o, --resume, --json.
void declare_shared_rows(Options& options, SharedRowsArguments& arguments) {
  options.add("--device", arguments.device, "DEVICE", "As of `verisq map`, on every rank");
  options.add_flag("--device-of-rank", arguments.device_of_rank,
                   "Rank k of a machine takes its device k (modulo how many there are), as `verisq devices` counts");
  options.require("-o,--output", arguments.output, "FILE", "The map: .npy, or .csv, which rank 0 writes in the end");
  options.add_flag("--resume", arguments.resume, "Go on with the job that left OUT.job");
  options.add_flag("--json", arguments.json, "Print the summary as one JSON object; what is not bounded is null");
}

/// The device on which this rank computes.
std::string device_of(const SharedRowsArguments& arguments, const mpi::Session& session) {
  if (!arguments.device_of_rank) return arguments.device;
  const std::size_t devices = test_devices().size();
  return devices == 0 ? "host" : std::to_string(static_cast<std::size_t>(session.local_rank()) % devices);
}

/// "tolerance" and "format".
std::vector<PartSetting> settings_of(const SharedRowsArguments& arguments, double tolerance) {
  return {{"tolerance", fmt::format("{}", tolerance)},
          {"format", std::filesystem::path(arguments.output).extension().string()}};
}

/// Makes all ranks compute the rows; rank 0 prints the summary. Like `mpi::shared_map`.
ExitStatus share_rows(const SharedRowsArguments& arguments, const mpi::SharedMapRequest& request, double tolerance,
                      const mpi::Session& session, const mpi::RangeMap& map) {
  const Stopwatch time;
  std::string device;
  double device_seconds = 0.0;
  double host_seconds = 0.0;
  const auto measured = [&](const RowRange& range, const auto& rows) {
    const MapSummary summary = map(range, rows);
    device = summary.device;
    device_seconds += summary.device_seconds;
    host_seconds += summary.host_seconds;
    return summary;
  };
  mpi::SharedMapResult result = mpi::shared_map(session, request, measured);
  result.summary.device = device;
  result.summary.device_seconds = session.sum(device_seconds);
  result.summary.host_seconds = session.sum(host_seconds);
  if (session.rank() == 0) print(result, arguments, session, tolerance, time.seconds());
  return result.summary.wide > 0 ? ExitStatus::unverified : ExitStatus::verified;
}

constexpr const char* closing_words_of_batch = R"(The manifest, and what DIR gets, are those of `verisq batch`:
  mpirun -n 16 verisq-mpi batch cohort.csv -o cohort
A rank runs one case at a time, of any command, by the program verisq that lies beside this one; ranks take cases
from a counter, so that none waits for another. DIR and the files of the cases have to be on a file system that
all ranks see. A case takes the processors, and the devices, that its rank may use: let the queue bind them
(srun --gpus-per-task=1; mpirun --map-by node:PE=8). The tables are those of one process.
Where a rank dies, MPI ends the job; the same command once more, with any number of ranks or by `verisq batch`,
takes over what is finished.

Exit status: that of `verisq batch`.)";

std::filesystem::path program_beside_this_one() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path() / "verisq";
}

/// A line for each case that this rank has run.
std::string text_of(const BatchRun& run) {
  std::string text;
  for (std::size_t place = 0; place < run.results.size(); ++place) {
    if (run.results[place].outcome == CaseOutcome::not_run) continue;
    text += fmt::format("{} {}\n", place, text_of(run.results[place]));
  }
  return text;
}

/// Precondition: a text of `text_of`.
void add(std::string_view text, BatchRun& run) {
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(line.size() + 1);
    const std::size_t space = line.find(' ');
    std::size_t place = 0;
    std::from_chars(line.data(), line.data() + space, place);
    run.results.at(place) = result_from(line.substr(space + 1));
  }
}

/// The results of all ranks, at rank 0.
BatchRun gathered(const BatchRun& own, const mpi::Session& session) {
  BatchRun all{.results = std::vector<CaseResult>(own.results.size())};
  for (const std::string& text : session.gathered(text_of(own))) add(text, all);
  all.taken_over = static_cast<std::size_t>(session.sum(static_cast<double>(own.taken_over)));
  all.interrupted = session.largest(own.interrupted ? 1 : 0) != 0;
  return all;
}

BatchRun run_own(const BatchArguments& arguments, const std::vector<BatchCase>& cases, const mpi::Session& session) {
  mpi::Counter counter;
  ProgressBar bar(!arguments.no_progress && session.rank() == 0, "cases");
  std::uint64_t begun = 0;  // by all ranks, as far as this one knows
  const auto next = [&]() -> std::optional<std::size_t> {
    begun = counter.next();
    return begun < cases.size() ? std::optional<std::size_t>(begun) : std::nullopt;
  };
  const auto show = [&](std::size_t) {
    bar.update(begun, static_cast<double>(begun) / static_cast<double>(cases.size()));
  };
  return run_batch(cases, folders_of(arguments),
                   {.jobs = 1, .program = program_beside_this_one(), .next = next, .progress = show});
}

void declare_shared_batch(Options& options, BatchArguments& arguments) {
  options.explain(closing_words_of_batch);
  declare_cohort(options, arguments);
}

/// Called by all ranks. Throws Error(input) for the manifest alone.
ExitStatus run_shared_batch(const BatchArguments& arguments, const mpi::Session& session) {
  const std::vector<BatchCase> cases = read_manifest(arguments.manifest);
  if (const auto program = program_beside_this_one(); !std::filesystem::exists(program))
    refuse(fmt::format("{}: is not there: it runs the cases", program.string()));
  watch_for_interruption();
  const BatchRun run = gathered(run_own(arguments, cases, session), session);
  std::array<ExitStatus, 1> status{};
  if (session.rank() == 0) status[0] = conclude(arguments, cases, run);
  session.share(std::as_writable_bytes(std::span(status)));
  return status[0];
}

}  // namespace
}  // namespace verisq::command_line

namespace {

constexpr const char* closing_words_of_program = R"(Run it by mpirun or srun:
  mpirun -n 64 verisq-mpi map --model stem.json --points samples.npy -o distances.npy
  mpirun -n 64 verisq-mpi insert --implant stem.json --mesh femur.ply --along 0,0,-1 --length 100 -o way.npy
  mpirun -n 64 verisq-mpi batch cohort.csv -o cohort
A batch shares cases of any command: fits, recoveries, whatever `verisq batch` runs.
Exit status: that of the command of `verisq`.
`verisq-mpi COMMAND --help` explains a command.)";

}  // namespace

int main(int argc, char** argv) {
  using namespace verisq::command_line;
  verisq::leave_compilations_at_exit();  // MPI has ended by then
  const verisq::mpi::Session session(argc, argv);
  const std::array commands{
      shared_command("map", "One map, of points or triangles, whose rows all ranks share", session, declare_shared_map,
                     run_shared_map),
      shared_command("insert", "How deep an implant cuts on its way in, whose rows all ranks share", session,
                     declare_shared_insert, run_shared_insert),
      shared_command("batch", "The cases of a cohort, any command each, which all ranks share", session,
                     declare_shared_batch, run_shared_batch),
  };
  const Program program{.name = "verisq-mpi",
                        .description = "verisq-mpi: one large job, done by all ranks of an MPI job.",
                        .closing_words = closing_words_of_program};
  return run_program(program, commands, argc, argv);
}

namespace verisq::command_line {
namespace {

constexpr const char* closing_words_of_map = R"(The options are those of `verisq map`:
  mpirun -n 64 verisq-mpi map --model stem.json --points samples.npy -o distances.npy
The file has the bytes that `verisq map` writes on the same kind of device, whatever the number of ranks. Ranks
take chunks of whole blocks of rows from a counter, and write them where they belong by MPI-IO. Beside OUT are,
while it runs, OUT.rows, OUT.chunks and OUT.job: where a rank dies, MPI ends the job, and the same command with
--resume, on as many ranks as there are then, makes what is not finished yet.

Exit status: that of `verisq map`: 0 every enclosure is at most the tolerance wide, 3 one is wider, 2 bad usage
or input.)";

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
  if (options.pose_uncertainty) settings.push_back({"place", command_line::text_of(*options.pose_uncertainty)});
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

void declare_shared_map(Options& options, SharedMapArguments& arguments) {
  options.explain(closing_words_of_map);
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

constexpr const char* closing_words_of_insert = R"(The options are those of `verisq insert`:
  mpirun -n 64 verisq-mpi insert --implant stem.json --mesh femur.ply --along 0,0,-1 --length 100 -o way.npy
Each row is [lo, hi], which contains the smallest signed distance from the vertex to the implant along the whole
way: the bytes that `verisq insert` writes on the same kind of device, whatever the number of ranks, which share
blocks of 1,024 vertices. --resume and the files beside OUT: see `verisq-mpi map --help`. Volumes, and ways that
are searched, are those of one process, or of a `verisq-mpi batch`.

Exit status: that of `verisq insert`: 0 every enclosure is at most the tolerance wide, 3 one is wider, 2 bad
usage or input.)";

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

void declare_shared_insert(Options& options, SharedInsertArguments& arguments) {
  options.explain(closing_words_of_insert);
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

}  // namespace
}  // namespace verisq::command_line
