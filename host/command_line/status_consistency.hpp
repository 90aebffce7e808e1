/// Whether one tolerance explains every status of a map: "verified" rows are at most so wide, "wide" ones are wider.
#pragma once

#include <cstdint>
#include <optional>
#include <verisq/map_file.hpp>

namespace verisq::command_line {

/// The tolerance itself is not in the map, nor can a map prove which of device and host verified a row.
class StatusConsistency {
 public:
  /// In any order.
  void add(std::uint64_t index, const MapResult& row);

  /// A row whose status no finite tolerance allows beside those of the others; the array is "status".
  [[nodiscard]] std::optional<MapDifference> contradiction() const;

 private:
  struct Row {
    std::uint64_t index;
    Status status;
    double width;
  };

  std::optional<Row> widest_verified_;
  std::optional<Row> narrowest_wide_;
};

}  // namespace verisq::command_line
