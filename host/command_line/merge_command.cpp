/// Has the parts merged, and prints the summary of all rows.
#include "host/command_line/merge_command.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <verisq/map_part.hpp>

#include "host/command_line/directed_digits.hpp"
#include "host/command_line/element_words.hpp"
#include "host/command_line/json_value.hpp"
#include "host/command_line/stopwatch.hpp"

namespace verisq::command_line {
namespace {

constexpr const char* closing_words =
    "PARTS are the files that `verisq map --part I/N -o PART` or `verisq distance --poses F --part I/N -o PART` "
    "wrote,\n"
    "all N of them, in any order; beside each lies its PART.part.json. The whole is bit by bit what one process writes "
    "on\n"
    "the same kind of device; of .vtp parts it is a .pvtp, which names them and is opened by ParaView as one. Refused "
    "are\n"
    "gaps and overlaps, parts of other models, inputs, options, devices or "
    "versions\n"
    "of verisq, and files that are not those that were written.\n"
    "\n"
    "Exit status: that of the whole map: 0 every enclosure is at most the tolerance wide, 3 one is wider, 2 the parts "
    "do\n"
    "not belong together.\n"
    "\n"
    "Example:\n"
    "  for i in 1 2 3 4; do verisq map --model stem.json --points samples.npy --part $i/4 -o part.$i.npy; done\n"
    "  verisq merge part.*.npy -o distances.npy";

std::string tolerance_of(const MapPart& whole) {
  const auto found = std::ranges::find(whole.settings, "tolerance", &PartSetting::name);
  return found == whole.settings.end() ? std::string() : found->value;
}

std::string readable(const MergedMap& merged, const MergeArguments& arguments, double seconds) {
  const MapSummary& summary = merged.whole.summary;
  std::string text = fmt::format("{:<19}{}\n", plural(merged.whole.elements), summary.points);
  text += fmt::format("  device-verified  {}\n", summary.device_verified);
  text += fmt::format("  host-verified    {}\n", summary.host_verified);
  text += fmt::format("  wide             {}\n", summary.wide);
  text += fmt::format("parts              {}\n", arguments.parts.size());
  text += fmt::format("device             {}\n", summary.device);
  text += fmt::format("tolerance          {}\n", tolerance_of(merged.whole));
  if (summary.points > 0) {
    text += fmt::format("smallest distance  [{}, {}]\n", summary.minimum_lo, summary.minimum_hi);
    text += fmt::format("largest width      {}\n", upper_digits(summary.largest_width));
  }
  if (merged.whole.closest) text += fmt::format("closest points     {} unique\n", merged.whole.closest->unique);
  text += fmt::format("time               {:.3g} s (in all parts: device {:.3g} s, host proofs {:.3g} s)\n", seconds,
                      summary.device_seconds, summary.host_seconds);
  return text + fmt::format("map                {}\n", arguments.output);
}

std::string json(const MergedMap& merged, const MergeArguments& arguments, double seconds) {
  const MapSummary& summary = merged.whole.summary;
  JsonObject object{{plural(merged.whole.elements), summary.points},
                    {"device_verified", summary.device_verified},
                    {"host_verified", summary.host_verified},
                    {"wide", summary.wide},
                    {"parts", arguments.parts.size()},
                    {"devices", merged.devices},
                    {"largest_width", summary.largest_width},
                    {"device_seconds", summary.device_seconds},
                    {"host_seconds", summary.host_seconds},
                    {"seconds", seconds},
                    {"output", arguments.output}};
  if (summary.points > 0) object.set("smallest_distance", Enclosure{summary.minimum_lo, summary.minimum_hi});
  if (merged.whole.closest) object.set("unique_closest_points", merged.whole.closest->unique);
  JsonObject settings;
  for (const auto& [name, value] : merged.whole.settings) settings.set(name, value);
  object.set("settings", settings);
  return object.text() + "\n";
}

}  // namespace

void declare_merge(Options& options, MergeArguments& arguments) {
  options.explain(closing_words);
  options.require_each("PARTS", arguments.parts, "PARTS",
                       "All parts of a map: .csv, .npy or .vtp, each with its .part.json");
  options.require("-o,--output", arguments.output, "FILE", "The whole map; of .vtp parts a .pvtp");
  options.add_flag("--mixed-devices", arguments.mixed_devices,
                   "Accept parts of several devices: every row is valid, but which bits it has is then the device's");
  options.add_flag("--json", arguments.json, "Print the summary as one JSON object; what is not bounded is null");
}

ExitStatus run_merge(const MergeArguments& arguments) {
  const Stopwatch time;
  const std::vector<std::filesystem::path> parts(arguments.parts.begin(), arguments.parts.end());
  const MergedMap merged = merge_maps(parts, arguments.output, {.mixed_devices = arguments.mixed_devices});
  const double seconds = time.seconds();
  fmt::print("{}", arguments.json ? json(merged, arguments, seconds) : readable(merged, arguments, seconds));
  return merged.whole.summary.wide > 0 ? ExitStatus::unverified : ExitStatus::verified;
}

}  // namespace verisq::command_line
