/// This file implements the uncertain maps: the bracketing models are mapped chunk by chunk, their rows combined.
#include "verisq/uncertain_map.hpp"

#include <algorithm>
#include <chrono>
#include <concepts>
#include <optional>
#include <utility>
#include <vector>

#include "host/maps/chunk_pace.hpp"
#include "host/maps/summary_count.hpp"
#include "verify/proof/intersection.hpp"
#include "verify/proof/uncertain_distance.hpp"

namespace verisq {
namespace {

// The rows of one chunk by one mapper: fewer than its items if the map was interrupted.
struct Rows {
  std::vector<MapResult> results;
  std::vector<Certificate> certificates;
  MapSummary summary;

  [[nodiscard]] std::size_t size() const { return results.size(); }
};

template <class Mapper, class Item>
Rows map_chunk(Mapper& mapper, std::span<const Item> items) {
  Rows rows;
  const auto source = [&](std::span<Item> chunk) {
    const std::size_t count = std::min(chunk.size(), items.size());
    std::ranges::copy(items.first(count), chunk.begin());
    items = items.subspan(count);
    return count;
  };
  const auto sink = [&](std::span<const Item>, std::span<const MapResult> results,
                        std::span<const Certificate> certificates) {
    rows.results.insert(rows.results.end(), results.begin(), results.end());
    rows.certificates.insert(rows.certificates.end(), certificates.begin(), certificates.end());
  };
  rows.summary = mapper.map(source, sink);
  return rows;
}

// What the maps of the bracketing models say of one chunk. `inflated` has rows where the bracket has such a model.
struct BracketRows {
  Rows smallest;
  Rows largest;
  std::optional<Rows> inflated;

  [[nodiscard]] std::size_t size() const {
    const std::size_t both = std::min(smallest.size(), largest.size());
    return inflated ? std::min(both, inflated->size()) : both;
  }
};

bool same_solids(const Model& a, const Model& b) {
  return std::ranges::equal(a.primitives, b.primitives, [](const Primitive& x, const Primitive& y) {
    return x.superquadric.semi_axes == y.superquadric.semi_axes && x.superquadric.exponents == y.superquadric.exponents;
  });
}

Enclosure combine(const verify::MemberBounds& bounds, const BracketRows& rows, std::size_t i, const Point& point) {
  std::optional<double> of_inflated;
  if (rows.inflated) of_inflated = rows.inflated->results[i].distance.lo;
  return verify::between(bounds.signed_lower(rows.largest.results[i].distance.lo, of_inflated),
                         bounds.upper(rows.smallest.results[i].distance.hi),
                         [&] { return "the signed distance at " + verify::text_of(point); });
}

Enclosure combine(const verify::MemberBounds& bounds, const BracketRows& rows, std::size_t i,
                  const Triangle& triangle) {
  return verify::between(bounds.triangle_lower(rows.largest.results[i].distance.lo),
                         bounds.upper(rows.smallest.results[i].distance.hi),
                         [&] { return "the distance of the triangle from " + verify::text_of(triangle[0]); });
}

Status status(const Enclosure& distance, double tolerance, const BracketRows& rows, std::size_t i) {
  // The tightest of uncertain numbers is what the tightest of both ends leave.
  const auto is_wide = [i](const Rows& of) { return of.results[i].status == Status::wide; };
  const bool tightest = tolerance == 0.0 && !is_wide(rows.smallest) && !is_wide(rows.largest) &&
                        !(rows.inflated && is_wide(*rows.inflated));
  if (!verified(distance, tolerance) && !tightest) return Status::wide;
  const auto by_device = [i](const Rows& of) { return of.results[i].status == Status::device_verified; };
  const bool all = by_device(rows.smallest) && by_device(rows.largest) && (!rows.inflated || by_device(*rows.inflated));
  return all ? Status::device_verified : Status::host_verified;
}

// The upper end's normals first, as certificates want it; each later normal proves what it can. An escape is that of
// `inflated` where there is one: what lies outside it lies outside every member.
Certificate merge(const BracketRows& rows, std::size_t i) {
  Certificate merged = rows.smallest.certificates[i];
  const auto add = [&](const Certificate& lower) {
    for (const Normal& normal : lower.normals)
      if (std::ranges::find(merged.normals, normal) == merged.normals.end()) merged.normals.push_back(normal);
    merged.escape = lower.escape;
  };
  add(rows.largest.certificates[i]);
  if (rows.inflated) add(rows.inflated->certificates[i]);
  return merged;
}

// Only signed distances need the inflated model, for points deep in a union (see Bracket).
template <class Item>
constexpr bool is_signed = std::same_as<Item, Point>;

// Mapper maps items of type Item: DistanceMapper or TriangleMapper.
template <class Mapper, class Item>
class BracketMapper {
 public:
  BracketMapper(const UncertainModel& model, double point_radius, const MapOptions& options)
      : BracketMapper(bracket(model), point_radius, options, is_exact(model) && point_radius == 0.0) {}

  template <class Source, class Sink>
  MapSummary map(const Source& source, const Sink& sink) {
    if (exact_) return smallest_.map(source, sink);
    MapSummary summary = empty_summary();
    std::vector<Item> items;
    ChunkPace pace;
    do {
      items.resize(pace.size());
      items.resize(source(items));
      const auto start = std::chrono::steady_clock::now();
      const BracketRows rows = map_bracket(items);
      pace.took(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
      add_runs(summary, rows);
      deliver(items, rows, summary, sink);
    } while (!items.empty() && !summary.interrupted);
    return summary;
  }

 private:
  BracketMapper(const Bracket& models, double point_radius, const MapOptions& options, bool exact)
      : exact_(exact),
        options_(options),
        bounds_(models, point_radius),
        smallest_(models.smallest, by_single_primitives(models, of_one_model())) {
    if (!same_solids(models.smallest, models.largest)) largest_.emplace(models.largest, of_one_model());
    if (models.inflated && is_signed<Item>) inflated_.emplace(*models.inflated, of_one_model());
  }

  // The obligation of Bracket: where the primitives of a union move independently of each other, no upper end may be
  // proven by several of them together. Certificates never are.
  static MapOptions by_single_primitives(const Bracket& models, MapOptions options) {
    if (is_signed<Item> && models.inflated) {
      options.certificates = true;
      options.method = Method::duality;  // the published one has none
    }
    return options;
  }

  [[nodiscard]] MapOptions of_one_model() const {
    MapOptions result = options_;
    if (!exact_) result.tolerance = options_.tolerance / 2;
    return result;
  }

  [[nodiscard]] BracketRows map_bracket(std::span<const Item> items) {
    BracketRows rows{map_chunk(smallest_, items), {}, std::nullopt};
    rows.largest = largest_ ? map_chunk(*largest_, items) : rows.smallest;
    if (inflated_) rows.inflated = map_chunk(*inflated_, items);
    return rows;
  }

  void add_runs(MapSummary& summary, const BracketRows& rows) const {
    const auto add = [&summary](const MapSummary& run) {
      summary.device_seconds += run.device_seconds;
      summary.host_seconds += run.host_seconds;
      summary.interrupted = summary.interrupted || run.interrupted;
      summary.out_of_time = summary.out_of_time || run.out_of_time;
    };
    summary.device = rows.smallest.summary.device;
    summary.notice = rows.smallest.summary.notice;
    add(rows.smallest.summary);
    if (largest_) add(rows.largest.summary);
    if (rows.inflated) add(rows.inflated->summary);
  }

  template <class Sink>
  void deliver(std::span<const Item> items, const BracketRows& rows, MapSummary& summary, const Sink& sink) const {
    const std::size_t finished = rows.size();
    if (finished == 0) return;
    std::vector<MapResult> results(finished);
    std::vector<Certificate> certificates(options_.certificates ? finished : 0);
    for (std::size_t i = 0; i < finished; ++i) {
      const Enclosure distance = combine(bounds_, rows, i, items[i]);
      results[i] = {distance, status(distance, options_.tolerance, rows, i)};
      if (options_.certificates) certificates[i] = merge(rows, i);
      count(summary, results[i]);
    }
    sink(items.first(finished), results, certificates);
  }

  bool exact_;
  MapOptions options_;
  verify::MemberBounds bounds_;
  Mapper smallest_;
  std::optional<Mapper> largest_;  // nothing: the smallest is the largest
  std::optional<Mapper> inflated_;
};

}  // namespace

struct UncertainDistanceMapper::State : BracketMapper<DistanceMapper, Point> {
  using BracketMapper::BracketMapper;
};

UncertainDistanceMapper::UncertainDistanceMapper(const UncertainModel& model, double point_radius,
                                                 const MapOptions& options)
    : state_(std::make_unique<State>(model, point_radius, options)) {}
UncertainDistanceMapper::~UncertainDistanceMapper() = default;
UncertainDistanceMapper::UncertainDistanceMapper(UncertainDistanceMapper&&) noexcept = default;
UncertainDistanceMapper& UncertainDistanceMapper::operator=(UncertainDistanceMapper&&) noexcept = default;

MapSummary UncertainDistanceMapper::map(const PointSource& source, const MapSink& sink) {
  return state_->map(source, sink);
}

struct UncertainTriangleMapper::State : BracketMapper<TriangleMapper, Triangle> {
  using BracketMapper::BracketMapper;
};

UncertainTriangleMapper::UncertainTriangleMapper(const UncertainModel& model, double point_radius,
                                                 const MapOptions& options)
    : state_(std::make_unique<State>(model, point_radius, options)) {}
UncertainTriangleMapper::~UncertainTriangleMapper() = default;
UncertainTriangleMapper::UncertainTriangleMapper(UncertainTriangleMapper&&) noexcept = default;
UncertainTriangleMapper& UncertainTriangleMapper::operator=(UncertainTriangleMapper&&) noexcept = default;

MapSummary UncertainTriangleMapper::map(const TriangleSource& source, const TriangleSink& sink) {
  return state_->map(source, sink);
}

}  // namespace verisq
