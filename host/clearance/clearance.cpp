/// Maps the cavity and sums up. The report of an interrupted map is of the rows delivered: `map.points` of them, the
/// first of the cavity.
#include "verisq/clearance.hpp"

#include <algorithm>

#include "verify/clearance/clearance_sum.hpp"

namespace verisq {

Clearance certified_clearance(const Model& posed, const Cavity& cavity, const Fitness& fitness,
                              double penetration_limit, const MapOptions& options, const Sink<Point>& sink) {
  ClearanceSum sum(cavity.areas, cavity.area_of, fitness, penetration_limit);
  std::span<const Point> rest = cavity.points;
  const Source<Point> source = [&rest](std::span<Point> chunk) {
    const std::size_t count = std::min(chunk.size(), rest.size());
    std::ranges::copy(rest.first(count), chunk.begin());
    rest = rest.subspan(count);
    return count;
  };
  const Sink<Point> sum_up = [&](std::span<const Point> points, std::span<const MapResult> rows,
                                 std::span<const Certificate> certificates) {
    sum.add(rows);
    sink(points, rows, certificates);
  };
  const MapSummary summary = PointMapper(posed, options).map(source, sum_up);
  Clearance clearance = sum.report();
  clearance.map = summary;
  return clearance;
}

}  // namespace verisq
