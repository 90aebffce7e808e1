/// Lengths of two models can be compared only in one unit.
#pragma once

#include <fmt/core.h>

#include <string>

#include "host/errors/refusal.hpp"

namespace verisq::command_line {

/// Of two models, exact ones or uncertain; empty where neither has any. Throws Error(input), naming the file of `b`,
/// where they differ.
template <class AnyModel>
[[nodiscard]] std::string common_units(const AnyModel& a, const AnyModel& b, const std::string& path_of_a,
                                       const std::string& path_of_b) {
  if (!a.units.empty() && !b.units.empty() && a.units != b.units)
    refuse(fmt::format("{}: units {} differ from {} of {}", path_of_b, b.units, a.units, path_of_a));
  return a.units.empty() ? b.units : a.units;
}

}  // namespace verisq::command_line
