/// Fuzz target of parse_landmarks.
#include <algorithm>
#include <cmath>
#include <verisq/features.hpp>

#include "tests/fuzz/landmark_promise.hpp"
#include "tests/fuzz/promise.hpp"
#include "tests/fuzz/targets.hpp"

namespace verisq::fuzz {

void check_landmarks(const FemurLandmarks& landmarks) {
  for (const NamedLandmark& named : named_landmarks) {
    const std::optional<Point>& point = landmarks.*named.point;
    check(!point || std::ranges::all_of(*point, [](double x) { return std::isfinite(x); }), "landmarks are finite");
  }
  const std::optional<double>& radius = landmarks.head_radius;
  check(!radius || (std::isfinite(*radius) && *radius > 0.0), "a head's radius is finite and positive");
}

void landmarks(Bytes bytes) {
  const std::string name = "landmarks.json";
  const std::string json(bytes.begin(), bytes.end());  // a copy, so that reading past its end shows
  read_or_refuse(name, [&] { check_landmarks(parse_landmarks(json, name).landmarks); });
}

}  // namespace verisq::fuzz
