/// Keeps the widest verified row and the narrowest wide one.
#include "host/command_line/status_consistency.hpp"

#include <fmt/core.h>

#include <cmath>
#include <string>
#include <utility>

#include "verisq/enclosure.hpp"

namespace verisq::command_line {

void StatusConsistency::add(std::uint64_t index, const MapResult& row, const TightestWidths& tightest) {
  const double difference = row.distance.width();
  // Where both ends are the same infinity nothing is bounded.
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

}  // namespace verisq::command_line
