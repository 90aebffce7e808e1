/// Whether one tolerance explains every status of a map: "verified" rows are at most so wide, "wide" ones are wider. A
/// tolerance of 0, which asks for the tightest, has a width of its own for each row.
#pragma once

#include <cstdint>
#include <optional>
#include <verisq/enclosure.hpp>
#include <verisq/map_file.hpp>

namespace verisq::command_line {

/// What a tolerance of 0 calls verified: rows at most `surely` wide, none wider than `possibly`.
struct TightestWidths {
  double surely = 0.0;
  double possibly = infinity;
};

/// The tolerance itself is not in the map, nor can a map prove which of device and host verified a row.
class StatusConsistency {
 public:
  /// In any order.
  void add(std::uint64_t index, const MapResult& row, const TightestWidths& tightest);

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
  bool tightest_explains_ = true;  ///< a tolerance of 0 does
};

}  // namespace verisq::command_line
