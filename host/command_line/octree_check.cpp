/// Reads the file, has its cubes proved by all cores, prints what became of them and what volume they prove.
#include "host/command_line/octree_check.hpp"

#include <fmt/core.h>

#include <mutex>
#include <random>
#include <utility>
#include <vector>
#include <verisq/octree_checker.hpp>
#include <verisq/octree_file.hpp>

#include "host/command_line/check_summary.hpp"
#include "host/command_line/interruption.hpp"
#include "host/command_line/json_value.hpp"
#include "host/command_line/posed_input.hpp"
#include "host/command_line/progress_bar.hpp"
#include "host/command_line/stopwatch.hpp"
#include "host/threads/parallel.hpp"

namespace verisq::command_line {
namespace {

struct OctreeCheckReport {
  std::uint64_t cubes = 0;  ///< that the octree speaks of
  std::uint64_t chosen = 0;
  std::uint64_t proved = 0;
  std::uint64_t unproved = 0;
  std::optional<ColouredCube> first;  ///< that is not proved
  Enclosure volume{};
  double seconds = 0.0;
  bool interrupted = false;

  [[nodiscard]] bool proves_volume() const { return proved == cubes; }
};

/// `count` of them, in any order.
void choose_at_random(std::vector<ColouredCube>& cubes, std::uint64_t count) {
  if (count >= cubes.size()) return;
  std::random_device seed;  // whoever wrote the file cannot know which
  std::mt19937_64 random(seed() + (std::uint64_t{seed()} << 32U));
  for (std::size_t i = 0; i < count; ++i) {
    std::swap(cubes[i], cubes[std::uniform_int_distribution<std::size_t>(i, cubes.size() - 1)(random)]);
  }
  cubes.resize(count);
}

OctreeCheckReport check_cubes(const OctreeChecker& checker, const std::vector<ColouredCube>& cubes,
                              bool show_progress) {
  OctreeCheckReport report;
  report.chosen = cubes.size();
  std::mutex mutex;
  ProgressBar bar(show_progress, "cubes");
  const Stopwatch time;
  in_parallel(cubes.size(), [&](std::size_t i) {
    if (interrupted()) return;
    const bool proved = checker.proves(cubes[i]);
    const std::lock_guard lock(mutex);
    ++(proved ? report.proved : report.unproved);
    if (!proved && !report.first) report.first = cubes[i];
    const std::uint64_t done = report.proved + report.unproved;
    bar.update(done, static_cast<double>(done) / static_cast<double>(cubes.size()));
  });
  report.interrupted = report.proved + report.unproved < cubes.size();
  report.seconds = time.seconds();
  return report;
}

/// Of the root in model units; for people.
std::string text_of(const ColouredCube& cube, const OctreeRoot& root) {
  Point centre = root.centre;
  for (std::size_t i = 0; i < 3; ++i) centre[i] += root.half_width * cube.centre[i];
  return fmt::format("the cube about ({:.9g}, {:.9g}, {:.9g}) with edge {:.9g}, {}", centre[0], centre[1], centre[2],
                     2.0 * root.half_width * cube.half_width,
                     cube.colour == CubeColour::black ? "inside as the file says" : "outside as the file says");
}

std::string readable(const OctreeCheckReport& report, const OctreeRoot& root, const OctreeCheckArguments& arguments,
                     const std::string& units) {
  std::string text = fmt::format("{:<21}{}\n", "cubes", report.cubes);
  if (report.chosen < report.cubes) text += fmt::format("  chosen at random   {}\n", report.chosen);
  text += fmt::format("  proved             {}\n", report.proved);
  text += fmt::format("  unproved           {}\n", report.unproved);
  if (report.proves_volume()) {
    text +=
        fmt::format("volume proved        {}{}\n", exact_text(report.volume), units.empty() ? "" : " " + units + "^3");
  } else {
    text += fmt::format("volume not proved    {}: only all cubes together prove it\n", exact_text(report.volume));
  }
  text += fmt::format("time                 {:.3g} s\n", report.seconds);
  text += fmt::format("octree               {}{}\n", arguments.octree, report.interrupted ? " (interrupted)" : "");
  if (report.first) text += fmt::format("first unproved       {}\n", text_of(*report.first, root));
  return text;
}

std::string json(const OctreeCheckReport& report, const OctreeRoot& root, const OctreeCheckArguments& arguments,
                 const std::string& units) {
  const JsonObject object{
      {"cubes", report.cubes},
      {"chosen", report.chosen},
      {"proved", report.proved},
      {"unproved", report.unproved},
      {"volume", report.volume},
      {"volume_proved", report.proves_volume()},
      {"units", units},
      {"seconds", report.seconds},
      {"interrupted", report.interrupted},
      {"octree", arguments.octree},
      {"first", report.first ? JsonValue(text_of(*report.first, root)) : JsonValue()},
  };
  return object.text() + "\n";
}

}  // namespace

ExitStatus run_octree_check(const OctreeCheckArguments& arguments) {
  watch_for_interruption();
  const Model model = read_model_at(arguments.pose, arguments.model);
  const OctreeContents octree = read_octree(arguments.octree);
  const OctreeChecker checker(model, octree.root, octree.cubes);
  std::vector<ColouredCube> chosen = checker.cubes();
  if (arguments.sample) choose_at_random(chosen, *arguments.sample);
  OctreeCheckReport report = check_cubes(checker, chosen, !arguments.no_progress);
  report.cubes = checker.cubes().size();
  report.volume = checker.volume();
  fmt::print("{}", arguments.json ? json(report, octree.root, arguments, model.units)
                                  : readable(report, octree.root, arguments, model.units));
  if (report.interrupted) return ExitStatus::interrupted;
  return report.unproved == 0 ? ExitStatus::verified : ExitStatus::unverified;
}

}  // namespace verisq::command_line
