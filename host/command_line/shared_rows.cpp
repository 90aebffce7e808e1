/// The options, and the summary of all ranks.
#include "host/command_line/shared_rows.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <verisq/device.hpp>

#include "host/command_line/json_value.hpp"
#include "host/command_line/stopwatch.hpp"

namespace verisq::command_line {
namespace {

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
  fmt::print("device             {}\n", summary.device);
  fmt::print("smallest distance  [{}, {}]\n", summary.minimum_lo, summary.minimum_hi);
  fmt::print("time               {:.3g} s (of all ranks: device {:.3g} s, host proofs {:.3g} s)\n", seconds,
             summary.device_seconds, summary.host_seconds);
  fmt::print("map                {}\n", arguments.output);
}

}  // namespace

void declare_shared_rows(Options& options, SharedRowsArguments& arguments) {
  options.add("--device", arguments.device, "DEVICE", "As of `verisq map`, on every rank");
  options.add_flag("--device-of-rank", arguments.device_of_rank,
                   "Rank k of a machine takes its device k (modulo how many there are), as `verisq devices` counts");
  options.require("-o,--output", arguments.output, "FILE", "The map: .npy, or .csv, which rank 0 writes in the end");
  options.add_flag("--resume", arguments.resume, "Go on with the job that left OUT.job");
  options.add_flag("--json", arguments.json, "Print the summary as one JSON object; what is not bounded is null");
}

std::string device_of(const SharedRowsArguments& arguments, const mpi::Session& session) {
  if (!arguments.device_of_rank) return arguments.device;
  const std::size_t devices = test_devices().size();
  return devices == 0 ? "host" : std::to_string(static_cast<std::size_t>(session.local_rank()) % devices);
}

std::vector<PartSetting> settings_of(const SharedRowsArguments& arguments, double tolerance) {
  return {{"tolerance", fmt::format("{}", tolerance)},
          {"format", std::filesystem::path(arguments.output).extension().string()}};
}

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

}  // namespace verisq::command_line
