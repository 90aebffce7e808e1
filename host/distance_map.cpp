/// This file implements the map: source -> device (or host) -> host for what stays open -> sink.
#include "verisq/distance_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "host/device/batch.hpp"
#include "host/parallel.hpp"
#include "verify/witness_estimate.hpp"
#include "verisq/error.hpp"
#include "verisq/signed_distance.hpp"

namespace verisq {
namespace {

constexpr std::size_t host_chunk = 4096;

// With a tolerance below these widths the host is asked only for what is wider than them: the device's certificates
// outside, and its branch and bound inside, are then as good as the methods are (design 2, §2, §5).
constexpr double outside_limit = 1e-12;  // of max(largest |coordinate|, radius of the model)
constexpr double inside_limit = 2e-9;    // of the radius of the model

// Whether the host may do better. True for NaN.
bool is_open(const Point& point, const Enclosure& found, double tolerance, double radius) {
  if (verified(found, tolerance)) return false;
  if (found.lo < 0.0) return !verified(found, inside_limit * radius);
  const double size = std::max({std::abs(point[0]), std::abs(point[1]), std::abs(point[2]), radius});
  return !verified(found, outside_limit * size);
}

// Both contain the exact value; if they have nothing in common one of them is wrong, which must never pass silently.
Enclosure intersect(const Enclosure& a, const Enclosure& b, const Point& point) {
  const Enclosure both{std::max(a.lo, b.lo), std::min(a.hi, b.hi)};
  if (both.lo <= both.hi) return both;
  throw Error(ErrorKind::failure,
              fmt::format("device and host contradict each other at ({}, {}, {}): [{}, {}] and [{}, {}]; please report",
                          point[0], point[1], point[2], a.lo, a.hi, b.lo, b.hi));
}

// The certificate of an intersection: upper end first, as certificates want it, then what proves the lower end.
Certificate merge(const CertifiedEnclosure& a, const CertifiedEnclosure& b) {
  const CertifiedEnclosure& upper = b.distance.hi < a.distance.hi ? b : a;
  const CertifiedEnclosure& lower = b.distance.lo > a.distance.lo ? b : a;
  Certificate both{upper.certificate.normals, lower.certificate.escape};
  if (&lower != &upper)
    both.normals.insert(both.normals.end(), lower.certificate.normals.begin(), lower.certificate.normals.end());
  return both;
}

// One run over all points: the host's share of the work, and the books.
class Run {
 public:
  Run(const SignedDistance& host, const verify::WitnessEstimate& witness_distance, double radius,
      const MapOptions& options, const MapSink& sink)
      : host_(host),
        witness_distance_(witness_distance),
        radius_(radius),
        tolerance_(options.tolerance),
        certificates_(options.certificates),
        sink_(sink) {
    summary_.minimum_lo = summary_.minimum_hi = std::numeric_limits<double>::infinity();
  }

  // Proves on the host what `found` leaves wide, and hands the rows on. `certificates` are those of `found`; empty
  // unless they were asked for.
  void finish_chunk(std::span<const Point> points, std::span<Enclosure> found, std::span<Certificate> certificates) {
    const auto start = std::chrono::steady_clock::now();
    if (certificates_) drop_unwitnessed(points, found, certificates);
    std::vector<std::size_t> open;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (is_open(points[i], found[i], tolerance_, radius_)) open.push_back(i);
    in_parallel(open.size(), [&](std::size_t n) {
      const std::size_t i = open[n];
      const CertifiedEnclosure proven = prove(points[i]);
      if (certificates_) certificates[i] = merge({found[i], std::move(certificates[i])}, proven);
      found[i] = intersect(found[i], proven.distance, points[i]);
    });
    summary_.host_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

    rows_.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
      rows_[i] = {found[i], verified(found[i], tolerance_) ? Status::device_verified : Status::wide};
    for (const std::size_t i : open)
      if (rows_[i].status == Status::device_verified) rows_[i].status = Status::host_verified;
    for (const MapResult& row : rows_) count(row);
    sink_(points, rows_, certificates);
  }

  [[nodiscard]] MapSummary& summary() { return summary_; }

 private:
  // Upper ends that hold, but not by their certificates.
  void drop_unwitnessed(std::span<const Point> points, std::span<Enclosure> found,
                        std::span<const Certificate> certificates) const {
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!(found[i].hi > 0.0) || certificates[i].normals.empty()) continue;
      if (witness_distance_(points[i], certificates[i].normals.front()) <= found[i].hi) continue;
      found[i].hi = std::numeric_limits<double>::infinity();
    }
  }

  [[nodiscard]] CertifiedEnclosure prove(const Point& point) const {
    if (certificates_) return host_.certified(point, tolerance_);
    return {host_(point, tolerance_), {}};
  }

  void count(const MapResult& row) {
    ++summary_.points;
    switch (row.status) {
      case Status::device_verified: ++summary_.device_verified; break;
      case Status::host_verified: ++summary_.host_verified; break;
      case Status::wide: ++summary_.wide; break;
    }
    summary_.minimum_lo = std::min(summary_.minimum_lo, row.distance.lo);
    summary_.minimum_hi = std::min(summary_.minimum_hi, row.distance.hi);
    summary_.largest_width = std::max(summary_.largest_width, row.distance.width());
  }

  const SignedDistance& host_;
  const verify::WitnessEstimate& witness_distance_;
  double radius_;
  double tolerance_;
  bool certificates_;
  const MapSink& sink_;
  std::vector<MapResult> rows_;  // of the current chunk; kept to spare allocations
  MapSummary summary_;
};

// Reads up to `capacity` points into `points`; checks what every kernel and proof relies on.
void read_chunk(const PointSource& source, std::size_t capacity, std::vector<Point>& points) {
  points.resize(capacity);
  points.resize(source(points));
  for (const Point& p : points)
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]))
      throw Error(ErrorKind::input, fmt::format("point ({}, {}, {}) is not finite", p[0], p[1], p[2]));
}

void map_on_host(Run& run, const PointSource& source, const MapOptions& options) {
  const Enclosure nothing{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  std::vector<Point> points;
  std::vector<Enclosure> found;
  std::vector<Certificate> certificates;
  while (!options.interrupted()) {
    read_chunk(source, host_chunk, points);
    if (points.empty()) return;
    found.assign(points.size(), nothing);
    certificates.assign(options.certificates ? points.size() : 0, {});
    run.finish_chunk(points, found, certificates);
  }
  run.summary().interrupted = true;
}

// While the device works on one chunk, the next is read and the last is finished and written.
void map_on_device(Run& run, device::Batch& batch, const PointSource& source, const MapOptions& options) {
  std::vector<Point> current;
  std::vector<Point> next;
  std::vector<Enclosure> found;
  std::vector<Certificate> certificates;
  batch.discard();  // what an earlier run left when it failed
  const double earlier_seconds = batch.device_seconds();
  read_chunk(source, batch.capacity(), current);
  if (!current.empty()) batch.submit(current);
  while (!current.empty()) {
    next.clear();
    if (options.interrupted())
      run.summary().interrupted = true;
    else
      read_chunk(source, batch.capacity(), next);
    if (!next.empty()) batch.submit(next);
    batch.collect(found, certificates);
    run.finish_chunk(current, found, certificates);
    std::swap(current, next);
  }
  run.summary().device_seconds = batch.device_seconds() - earlier_seconds;
}

}  // namespace

struct DistanceMapper::State {
  State(const Model& model, const MapOptions& map_options)
      : options(map_options), radius(bounding_radius(model)), host(model), witness_distance(model) {
    if (options.device == "host") return;
    const device::Selection selection = device::select_device(options.device);
    notice = selection.notice;
    if (!selection.device) return;
    if (!device::within_device_range(model)) {
      notice = "the model's sizes span more than the device's kernels are made for";
      return;
    }
    name = selection.device->name;
    batch.emplace(*selection.device, model, options.tolerance, options.certificates);
  }

  MapOptions options;
  double radius;
  SignedDistance host;
  verify::WitnessEstimate witness_distance;
  std::string name = "host";
  std::string notice;
  std::optional<device::Batch> batch;  // nothing: the host does all
};

DistanceMapper::DistanceMapper(const Model& model, const MapOptions& options)
    : state_(std::make_unique<State>(model, options)) {}
DistanceMapper::~DistanceMapper() = default;
DistanceMapper::DistanceMapper(DistanceMapper&&) noexcept = default;
DistanceMapper& DistanceMapper::operator=(DistanceMapper&&) noexcept = default;

MapSummary DistanceMapper::map(const PointSource& source, const MapSink& sink) {
  Run run(state_->host, state_->witness_distance, state_->radius, state_->options, sink);
  run.summary().device = state_->name;
  run.summary().notice = state_->notice;
  if (state_->batch)
    map_on_device(run, *state_->batch, source, state_->options);
  else
    map_on_host(run, source, state_->options);
  return run.summary();
}

MapSummary map_points(const Model& model, const PointSource& source, const MapSink& sink, const MapOptions& options) {
  return DistanceMapper(model, options).map(source, sink);
}

}  // namespace verisq
