/// The messages for what is out of its range.
#include "host/fit/fit_problem_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "verisq/error.hpp"

namespace verisq::fit_search {

namespace {

void require_input(bool holds, const std::string& message) {
  if (!holds) throw Error(ErrorKind::input, message);
}

bool are_finite(std::span<const double> numbers) {
  return std::ranges::all_of(numbers, [](double x) { return std::isfinite(x); });
}

}  // namespace

void check_fit_problem(const Cavity& cavity, const Fitness& fitness, double penetration_limit, const PoseRange& range) {
  require_input(!cavity.points.empty(), "fit: the cavity has no points");
  for (std::size_t i = 0; i < cavity.points.size(); ++i)
    require_input(are_finite(cavity.points[i]), fmt::format("fit: point {} of the cavity is not finite", i));
  const auto& [target, scale, serves] = fitness;
  require_input(std::isfinite(target) && target >= 0.0 && std::isfinite(scale) && scale > 0.0,
                fmt::format("fitness: target must be at least 0 and scale positive, not {} and {}", target, scale));
  require_input(std::isfinite(penetration_limit) && penetration_limit >= 0.0,
                fmt::format("penetration limit: must be finite and at least 0, not {}", penetration_limit));
  const auto& [start, translation, rotation] = range;
  require_input(are_finite(start.translation) && are_finite(start.quaternion) &&
                    std::ranges::any_of(start.quaternion, [](double x) { return x != 0.0; }),
                "start: its numbers must be finite and its quaternion not zero");
  require_input(std::isfinite(translation) && translation >= 0.0,
                fmt::format("translation: must be finite and at least 0, not {}", translation));
  require_input(rotation >= 0.0 && rotation <= 180.0,
                fmt::format("rotation: must be between 0 and 180 degrees, not {}", rotation));
}

}  // namespace verisq::fit_search
