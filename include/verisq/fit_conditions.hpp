/// What is asked of a fit, each thing with what is proven of it, and whether it keeps the fit from being better.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>
#include <verisq/enclosure.hpp>

namespace verisq {

enum class ConditionUnit : std::uint8_t { none, length, degrees, percent };

/// An end of a range.
enum class RangeEnd : std::uint8_t { lower, upper };

struct FitCondition {
  std::string name;  ///< "smallest distance", "side of stem", a feature, "contact:proximal"
  ConditionUnit unit = ConditionUnit::none;
  std::optional<Enclosure> value = {};  ///< proven; nothing of sides
  std::optional<Enclosure> range = {};  ///< asked of it; nothing of sides
  std::optional<bool> kept = {};        ///< proven, or proven not to be; nothing where that is open
  /// Where the value comes so close to an end of the range that this end may be what keeps the fit from being better:
  /// to a hundredth of the distance on which the fitness changes, of a degree, or to half a percent.
  std::optional<RangeEnd> binds = {};
};

}  // namespace verisq
