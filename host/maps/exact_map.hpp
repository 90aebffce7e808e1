/// Maps of ordinary models and exact queries: what all others are made of.
#pragma once

#include <memory>

#include "host/maps/map_copies.hpp"
#include "verisq/map.hpp"

namespace verisq {

/// As Mapper, whose two kinds of maps have names of their own here.
template <class Query>
class ExactMap {
 public:
  ExactMap() = default;
  virtual ~ExactMap() = default;
  ExactMap(const ExactMap&) = delete;
  ExactMap& operator=(const ExactMap&) = delete;

  virtual MapSummary map(const Source<Query>& source, const Sink<Query>& sink) = 0;
  virtual MapSummary map_in_memory(const typename QueriesInMemory<Query>::type& queries, const ResultColumns& rows) {
    return map_copies<Query>(queries, rows, [this](const auto& source, const auto& sink) { return map(source, sink); });
  }
};

/// Throw as the constructors of Mapper. Points and triangles are exact, whatever radius the options give.
[[nodiscard]] std::unique_ptr<ExactMap<Point>> point_map(const Model& model, const MapOptions& options);
[[nodiscard]] std::unique_ptr<ExactMap<Triangle>> triangle_map(const Model& model, const MapOptions& options);
[[nodiscard]] std::unique_ptr<ExactMap<Pose>> pose_map(const Model& a, const Model& b, const MapOptions& options);

}  // namespace verisq
