/// The first pose that is none is named.
#include "verify/placement/path_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <verisq/error.hpp>

namespace verisq {

void check_path(std::span<const Pose> path) {
  if (path.empty()) throw Error(ErrorKind::input, "the path has no pose");
  for (std::size_t k = 0; k < path.size(); ++k) {
    const Point& t = path[k].translation;
    const auto& q = path[k].quaternion;
    const auto refuse = [&](const char* why) {
      throw Error(ErrorKind::input, fmt::format("pose {} of the path, ({}, {}, {}), quaternion ({}, {}, {}, {}), {}", k,
                                                t[0], t[1], t[2], q[0], q[1], q[2], q[3], why));
    };
    const auto finite = [](double c) { return std::isfinite(c); };
    if (!std::ranges::all_of(t, finite) || !std::ranges::all_of(q, finite)) refuse("is not finite");
    if (std::ranges::all_of(q, [](double c) { return c == 0.0; })) refuse("has a zero quaternion");
  }
}

void check_turns(std::span<const Pose> path) {
  constexpr double nearly = 1e-9;
  for (std::size_t k = 1; k < path.size(); ++k) {
    const auto& p = path[k - 1].quaternion;
    const auto& q = path[k].quaternion;
    const double sizes = std::hypot(std::hypot(p[0], p[1]), std::hypot(p[2], p[3])) *
                         std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
    const double product = p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3];
    if (!(std::abs(product) <= nearly * sizes)) continue;
    throw Error(ErrorKind::input,
                fmt::format("pose {} of the path is half a turn from the one before, which has two ways: put a pose "
                            "between them",
                            k));
  }
}

}  // namespace verisq
