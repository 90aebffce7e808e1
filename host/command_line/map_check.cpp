/// Proves the rows of maps, the cubes of octrees and the answers for many poses again.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/distance.hpp>
#include <verisq/map_file.hpp>
#include <verisq/model.hpp>
#include <verisq/octree.hpp>

#include "host/command_line/check_command.hpp"
#include "host/command_line/inputs.hpp"
#include "host/command_line/options.hpp"
#include "host/command_line/run.hpp"
#include "host/command_line/summaries.hpp"
#include "host/errors/refusal.hpp"
#include "host/maps/certified_rows.hpp"
#include "host/prepare/mesh_geometry.hpp"
#include "host/threads/parallel.hpp"
#include "verisq/enclosure.hpp"

namespace verisq::command_line {

void StatusConsistency::add(std::uint64_t index, const MapResult& row, const TightestWidths& tightest) {
  const double difference = row.distance.width();
  // If both ends are the same infinity, nothing is bounded.
  const double width = std::isnan(difference) ? infinity : difference;
  const bool is_wide = row.status == Status::wide;
  if (is_wide ? width <= tightest.surely : width > tightest.possibly) tightest_explains_ = false;
  std::optional<Row>& kept = is_wide ? narrowest_wide_ : widest_verified_;
  const bool replaces = !kept || (is_wide ? width < kept->width : width > kept->width) ||
                        (width == kept->width && index < kept->index);  // the same row in whatever order they come
  if (replaces) kept = Row{index, row.status, width};
}

std::optional<MapDifference> StatusConsistency::contradiction() const {
  if (widest_verified_ && std::isinf(widest_verified_->width)) {
    return MapDifference{"status", widest_verified_->index, std::string(to_string(widest_verified_->status)),
                         "wide, since an end is infinite"};
  }
  if (!narrowest_wide_) return std::nullopt;
  const auto should_be_verified = [&](std::string why) {
    return MapDifference{"status", narrowest_wide_->index, "wide", "verified, " + std::move(why)};
  };
  if (narrowest_wide_->width == 0.0) return should_be_verified("since lo equals hi");
  if (!tightest_explains_ && widest_verified_ && narrowest_wide_->width <= widest_verified_->width) {
    return should_be_verified(fmt::format("since at index {} a width of {:.17g} is, and this one is {:.17g}",
                                          widest_verified_->index, widest_verified_->width, narrowest_wide_->width));
  }
  return std::nullopt;
}

namespace {

constexpr std::size_t chunk_size = 4096;

/// Counts verdicts, which threads deliver in any order.
template <typename Stream>
class Tally {
 public:
  Tally(const Stream& stream, MapElements elements, bool show_progress, const Proven& proven)
      : stream_(stream), proven_(proven), bar_(show_progress, plural(elements)) {}

  void add(const CheckedRow& row, Status status, const TightestWidths& tightest) {
    const std::lock_guard lock(mutex_);
    statuses_.add(row.index, {row.claimed, status}, tightest);
    proven_(row.index, row.finding.proven);
    count(row, report_);
    bar_.update(report_.rows(), stream_.fraction(report_.rows()));
  }

  /// Precondition: no `add` is under way.
  [[nodiscard]] CheckReport report() const {
    CheckReport report = report_;
    report.falsified = statuses_.contradiction();
    return report;
  }

 private:
  const Stream& stream_;
  const Proven& proven_;
  std::mutex mutex_;
  ProgressBar bar_;
  StatusConsistency statuses_;
  CheckReport report_{};
};

/// Counts the rest of a stream that `read` fills into `chunk`.
template <typename Stream, typename Item>
std::uint64_t count_rest(Stream& stream, std::vector<Item>& chunk) {
  std::uint64_t rest = 0;
  while (const std::size_t count = stream.read(chunk)) rest += count;
  return rest;
}

[[noreturn]] void refuse_lengths(std::uint64_t elements, std::uint64_t rows, const MapReader& map,
                                 const CheckArguments& arguments) {
  refuse(fmt::format("{}: {} rows for the {} {} of {}", arguments.map, rows, elements, plural(map.elements()),
                     arguments.inputs.mesh + arguments.inputs.points));
}

/// The elements that the map should draw: the mesh, or the points of a stream, which are kept only if the map draws
/// anything.
class Drawing {
 public:
  Drawing(const Mesh* mesh, bool wanted) : mesh_(mesh), wanted_(wanted) {}

  /// Points come in the order of the stream.
  void add(std::span<const Point> points) {
    if (wanted_ && mesh_ == nullptr) points_.vertices.insert(points_.vertices.end(), points.begin(), points.end());
  }
  void add(std::span<const Triangle> /*of the mesh*/) {}

  [[nodiscard]] const Mesh& mesh() const { return mesh_ == nullptr ? points_ : *mesh_; }

 private:
  const Mesh* mesh_;
  bool wanted_;
  Mesh points_;
};

/// From the corners of the box around any superquadric; for a bent one as far across its axis and then along it.
double reach_of(const UncertainPrimitive& primitive) {
  const auto& [a1, a2, a3] = primitive.semi_axes;
  const double widening = 1.0 + std::abs(primitive.taper - 1.0) / (primitive.taper + 1.0);
  const double across = std::hypot(widening * a1.hi, widening * a2.hi);
  return primitive.bend ? across + a3.hi : std::hypot(across, a3.hi);
}

double reach_of(const Mesh& mesh) {
  double reach = 0.0;
  for (const auto& [x, y, z] : mesh.vertices) reach = std::max(reach, std::hypot(x, y, z));
  return reach;
}

/// At least the radius of the model's bounding sphere as it determines the width of the tightest enclosures.
double radius_at_most(const UncertainModel& model) {
  std::vector<Point> corners;
  for (const UncertainPrimitive& primitive : model.primitives) {
    const double reach = primitive.mesh ? reach_of(*primitive.mesh) : reach_of(primitive);
    for (const double sign : {-1.0, 1.0}) {
      const auto& t = primitive.translation;
      corners.push_back({t[0].lo + sign * reach, t[1].lo + sign * reach, t[2].lo + sign * reach});
    }
  }
  constexpr double rounding = 1.0 + 0x1p-40;
  return rounding * extent_of(corners).half_diagonal();
}

/// For uncertain numbers, the tightness of a row's ends does not determine that of its members' enclosures.
template <typename Element>
TightestWidths tightest_widths(const Element& element, const Enclosure& claimed, const std::optional<double>& radius) {
  if (!radius) return {};
  return {tightest_width(element, claimed, 0.0), tightest_width(element, claimed, *radius)};
}

/// `radius`: at least that of an exact model.
template <typename Stream>
CheckReport check_rows(const Checker& checker, Stream stream, MapReader& map, const CheckArguments& arguments,
                       const std::optional<double>& radius, const Proven& proven) {
  Tally tally(stream, map.elements(), !arguments.no_progress, proven);
  Drawing drawing(stream.mesh(), map.draws());
  std::vector<typename Stream::Element> elements(chunk_size);
  std::vector<CertifiedRow> rows(chunk_size);
  const Stopwatch time;
  const auto finished = [&] {
    auto report = tally.report();
    report.seconds = time.seconds();
    return report;
  };
  std::uint64_t missing = 0;
  for (std::uint64_t first = 0; !arguments.ended();) {
    const std::size_t count = stream.read(elements);
    const std::size_t row_count = map.read(rows);
    if (row_count > count || (row_count < count && !map.partial())) {
      refuse_lengths(first + count + count_rest(stream, elements), first + row_count + count_rest(map, rows), map,
                     arguments);
    }
    missing += count - row_count;
    if (row_count == 0) {
      auto report = finished();
      report.missing = missing + count_rest(stream, elements);
      if (const auto difference = map.difference_from(drawing.mesh())) report.falsified = difference;
      return report;
    }
    drawing.add(std::span<const typename Stream::Element>(elements).first(count));
    in_parallel(row_count, [&](std::size_t i) {
      if (arguments.ended()) return;  // a chunk of points inside can take a minute
      const auto& [claimed, status] = rows[i].result;
      const Finding finding = checker(elements[i], claimed, rows[i].certificate, arguments.ended);
      if (finding.verdict == Verdict::unproved && arguments.ended()) return;  // not looked at to its end
      tally.add({first + i, elements[i], claimed, finding}, status, tightest_widths(elements[i], claimed, radius));
    });
    first += row_count;
  }
  auto report = finished();
  report.interrupted = true;  // also when the last chunk is done: no thread may have skipped a row unseen
  return report;
}

CheckReport check_map(const Checker& checker, MapReader& map, const CheckArguments& arguments,
                      const std::optional<double>& radius, const Proven& proven) {
  if (map.elements() == MapElements::vertices) {
    return check_rows(checker, PointStream(arguments.inputs), map, arguments, radius, proven);
  }
  if (arguments.inputs.mesh.empty()) {
    refuse(fmt::format("{}: a map of triangles: give their --mesh", arguments.map));
  }
  return check_rows(checker, TriangleStream(arguments.inputs), map, arguments, radius, proven);
}

}  // namespace

CheckReport checked_map(const CheckArguments& arguments, MapReader& map, const Proven& proven) {
  const UncertainModel model = read_uncertain_model_at(arguments.inputs.pose, arguments.inputs.model);
  const bool is_one_mesh = model.primitives.size() == 1 && model.primitives.front().mesh;
  if (is_one_mesh && map.elements() == MapElements::vertices) {
    tell(fmt::format(
        "note: {}: inside, a row is minus the distance to the nearest triangle; that is the depth only if no "
        "triangles cross",
        quotation(arguments.inputs.model)));
  }
  const Checker checker(model, arguments.point_radius);
  std::optional<double> radius;
  if (is_exact(model) && arguments.point_radius == 0.0) radius = radius_at_most(model);
  auto report = check_map(checker, map, arguments, radius, proven);
  report.elements = map.elements();
  report.map = arguments.map;
  report.units = model.units;
  return report;
}

namespace {

struct OctreeCheckReport {
  std::uint64_t cubes = 0;  ///< number of the octree's cubes
  std::uint64_t chosen = 0;
  std::uint64_t proved = 0;
  std::uint64_t unproved = 0;
  std::optional<ColouredCube> first;  ///< the first one that is not proved
  Enclosure volume{};
  double seconds = 0.0;
  bool interrupted = false;

  [[nodiscard]] bool proves_volume() const { return proved == cubes; }
};

/// Chooses `count` of them, in any order.
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
                              const OctreeCheckArguments& arguments) {
  OctreeCheckReport report;
  report.chosen = cubes.size();
  std::mutex mutex;
  ProgressBar bar(!arguments.no_progress, "cubes");
  const Stopwatch time;
  in_parallel(cubes.size(), [&](std::size_t i) {
    if (arguments.ended()) return;
    const bool proved = checker.proves(cubes[i], arguments.ended);
    if (!proved && arguments.ended()) return;  // it may not have been looked at to its end
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

/// Describes the cube in model units; for people.
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
    text += fmt::format("volume proved        {}{}\n", exact_text(report.volume), units_behind(units, 3));
  } else {
    text += fmt::format("volume not proved    {}: only all cubes together prove it\n", exact_text(report.volume));
  }
  text += fmt::format("time                 {:.3g} s\n", report.seconds);
  text += fmt::format("octree               {}{}\n", quotation(arguments.octree), mark_of_end(report.interrupted));
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
  const Model model = read_model_at(arguments.pose, arguments.model);
  const OctreeContents octree = read_octree(arguments.octree);
  const OctreeChecker checker(model, octree.root, octree.cubes);
  std::vector<ColouredCube> chosen = checker.cubes();
  if (arguments.sample) choose_at_random(chosen, *arguments.sample);
  watch_for_interruption();
  OctreeCheckReport report = check_cubes(checker, chosen, arguments);
  report.cubes = checker.cubes().size();
  report.volume = checker.volume();
  fmt::print("{}", arguments.json ? json(report, octree.root, arguments, model.units)
                                  : readable(report, octree.root, arguments, model.units));
  if (report.interrupted) return status_of_end();
  // Gray cubes alone claim nothing.
  return report.cubes > 0 && report.unproved == 0 ? ExitStatus::verified : ExitStatus::unverified;
}

namespace {

void count(const Finding& finding, std::size_t index, const PosedAnswer& answer, PosesReport& report) {
  report.unbounded += std::isfinite(answer.distance.hi) ? 0 : 1;
  switch (finding.verdict) {
    case Verdict::proved:
      ++report.proved;
      report.largest_width = std::max(report.largest_width, answer.distance.width());
      return;
    case Verdict::refuted: ++report.refuted; break;
    case Verdict::unproved: ++report.unproved; break;
  }
  const bool is_first_refuted = finding.verdict == Verdict::refuted && report.refuted == 1;
  if (!report.first || is_first_refuted) report.first = {index, answer, finding};
}

std::string readable(const PosesReport::Open& open) {
  const auto& [index, answer, finding] = open;
  return fmt::format("first {} pose, index {}, {}: {}\n  claimed          {}\n  proven           {}\n",
                     to_string(finding.verdict), index, option_text(answer.pose), reason(answer.distance, finding),
                     exact_text(answer.distance), exact_text(finding.proven));
}

JsonValue object_of(const std::optional<PosesReport::Open>& open) {
  if (!open) return {};
  const auto& [index, answer, finding] = *open;
  return JsonObject{{"verdict", to_string(finding.verdict)},
                    {"index", index},
                    {"pose", answer.pose},
                    {"claimed", answer.distance},
                    {"proven", finding.proven},
                    {"reason", reason(answer.distance, finding)}};
}

}  // namespace

PosesReport checked_poses(const Model& a, const Model& b, const PoseAnswers& answers,
                          const CertificateCheckArguments& arguments) {
  PosesReport report{.arguments = arguments, .units = answers.units};
  std::vector<std::optional<Finding>> findings(answers.answers.size());
  const Stopwatch time;
  const PairChecker check(a, b);
  in_parallel(findings.size(), [&](std::size_t i) {
    if (arguments.ended()) return;
    const PosedAnswer& answer = answers.answers[i];
    const Finding finding = check(answer.pose, answer.distance, answer.certificate, arguments.ended);
    if (finding.verdict != Verdict::unproved || !arguments.ended()) findings[i] = finding;
  });
  report.seconds = time.seconds();
  report.interrupted = arguments.ended();
  for (std::size_t i = 0; i < findings.size(); ++i)
    if (findings[i]) count(*findings[i], i, answers.answers[i], report);
  return report;
}

std::string readable(const PosesReport& report) {
  const std::string units = units_behind(report.units);
  std::string text = fmt::format("poses              {}\n", report.proved + report.refuted + report.unproved);
  text += fmt::format("  proved           {}\n", report.proved);
  text += fmt::format("  refuted          {}\n", report.refuted);
  text += fmt::format("  unproved         {}\n", report.unproved);
  if (report.unbounded > 0)
    text += fmt::format("  WITHOUT AN END   {}: of these nothing is claimed from above\n", report.unbounded);
  if (report.proved > 0)
    text += fmt::format("  largest width    {}{} of the proved ones\n", upper_digits(report.largest_width, 3), units);
  text += fmt::format("of                 the distances of two models\n");
  for (const std::string& model : report.arguments.models)
    text += fmt::format("  model            {}\n", quotation(model));
  text += fmt::format("time               {:.3g} s\n", report.seconds);
  text += fmt::format("certificate        {}{}\n", quotation(report.arguments.certificate),
                      mark_of_end(report.interrupted));
  if (report.first) text += readable(*report.first);
  return text;
}

std::string json(const PosesReport& report) {
  const JsonObject object{{"kind", "poses"},
                          {"proved", report.proved},
                          {"refuted", report.refuted},
                          {"unproved", report.unproved},
                          {"without_an_end", report.unbounded},
                          {"largest_width", report.largest_width},
                          {"first", object_of(report.first)},
                          {"units", report.units},
                          {"models", report.arguments.models},
                          {"seconds", report.seconds},
                          {"interrupted", report.interrupted},
                          {"certificate", report.arguments.certificate}};
  return object.text() + "\n";
}

}  // namespace verisq::command_line
