/// Reads points or triangles and rows side by side, has each row proved, counts the verdicts.
#include "host/command_line/map_check.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <span>
#include <vector>
#include <verisq/checker.hpp>
#include <verisq/map_file.hpp>
#include <verisq/uncertain_model.hpp>

#include "host/command_line/element_words.hpp"
#include "host/command_line/interruption.hpp"
#include "host/command_line/posed_input.hpp"
#include "host/command_line/progress_bar.hpp"
#include "host/command_line/status_consistency.hpp"
#include "host/command_line/stopwatch.hpp"
#include "host/command_line/triangle_stream.hpp"
#include "host/errors/refusal.hpp"
#include "host/maps/tightest_enclosure.hpp"
#include "host/mesh/extent.hpp"
#include "host/threads/parallel.hpp"

namespace verisq::command_line {
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

/// Counts what is left of a stream that `read` fills into `chunk`.
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

/// What the map should draw: the mesh, or the points of a stream, which are kept only where the map draws anything.
class Drawing {
 public:
  Drawing(const Mesh* mesh, bool wanted) : mesh_(mesh), wanted_(wanted) {}

  /// In the order of the stream.
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

/// At least the radius of the model's bounding sphere, as it decides how wide the tightest enclosures are.
double radius_at_most(const UncertainModel& model) {
  std::vector<Point> corners;
  for (const UncertainPrimitive& primitive : model.primitives) {
    const auto& [a1, a2, a3] = primitive.semi_axes;
    const double widening = 1.0 + std::abs(primitive.taper - 1.0) / (primitive.taper + 1.0);
    // Of the corners of the box around any superquadric; of a bent one as far across its axis and then along it.
    const double across = std::hypot(widening * a1.hi, widening * a2.hi);
    const double reach = primitive.bend ? across + a3.hi : std::hypot(across, a3.hi);
    for (const double sign : {-1.0, 1.0}) {
      const auto& t = primitive.translation;
      corners.push_back({t[0].lo + sign * reach, t[1].lo + sign * reach, t[2].lo + sign * reach});
    }
  }
  constexpr double rounding = 1.0 + 0x1p-40;
  return rounding * extent_of(corners).half_diagonal();
}

/// Of uncertain numbers, how tight the ends of a row are does not tell how tight those of its members were.
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
  for (std::uint64_t first = 0; !interrupted();) {
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
      if (interrupted()) return;  // a chunk of points inside can take a minute
      const auto& [claimed, status] = rows[i].result;
      tally.add({first + i, elements[i], claimed, checker(elements[i], claimed, rows[i].certificate)}, status,
                tightest_widths(elements[i], claimed, radius));
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
  const Checker checker(model, arguments.point_radius);
  std::optional<double> radius;
  if (is_exact(model) && arguments.point_radius == 0.0) radius = radius_at_most(model);
  auto report = check_map(checker, map, arguments, radius, proven);
  report.elements = map.elements();
  report.map = arguments.map;
  report.units = model.units;
  return report;
}

}  // namespace verisq::command_line
