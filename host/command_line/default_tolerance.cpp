/// The product, where it is one.
#include "host/command_line/default_tolerance.hpp"

#include <fmt/core.h>

#include <cmath>

#include "host/errors/refusal.hpp"

namespace verisq::command_line {

double default_tolerance(const RelativeTolerance& relative, double radius, std::string_view owner) {
  const double tolerance = relative.value * radius;
  // An infinite tolerance would call every enclosure verified.
  if (!std::isfinite(tolerance)) refuse(fmt::format("--tol: give one, because the size of {} overflows", owner));
  return tolerance;
}

}  // namespace verisq::command_line
