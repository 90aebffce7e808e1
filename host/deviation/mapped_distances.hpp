/// Maps as the source of signed distances that the searches of `verify/deviation` ask.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "verisq/enclosure.hpp"
#include "verisq/map.hpp"
#include "verisq/model.hpp"

namespace verisq {

/// A mapper as a source of enclosures.
class MappedDistances {
 public:
  MappedDistances(const Model& model, const MapOptions& options)
      : mapper_(std::make_shared<PointMapper>(model, options)), out_of_time_(options.out_of_time) {}

  bool operator()(std::span<const Point> points, std::span<Enclosure> rows) const {
    return !map(points, rows).interrupted && !(out_of_time_ && out_of_time_());
  }

  [[nodiscard]] MapSummary map(std::span<const Point> points, std::span<Enclosure> rows) const {
    std::vector<Status> status(rows.size(), Status::wide);
    return map(points, rows, status);
  }

  [[nodiscard]] MapSummary map(std::span<const Point> points, std::span<Enclosure> rows,
                               std::span<Status> status) const {
    if (points.empty()) return {};
    constexpr std::ptrdiff_t stride = sizeof(Enclosure) / sizeof(double);
    return mapper_->map(points, {rows.size(), {&rows[0].lo, stride}, {&rows[0].hi, stride}, {status.data()}});
  }

 private:
  std::shared_ptr<PointMapper> mapper_;
  std::function<bool()> out_of_time_;
};

}  // namespace verisq
