/// Uncertain models and their members, for the tests of what must hold for every member.
#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <vector>
#include <verisq/uncertain_model.hpp>

#include "tests/map_in_memory.hpp"
#include "tests/oracle/mixed_norm.hpp"
#include "tests/oracle/random_cases.hpp"
#include "tests/requested_count.hpp"

namespace verisq::oracle {

/// Which numbers are uncertain, and by how much on either side: semi-axes and exponents by a part of themselves, each
/// coordinate of the translation by a part of the smallest semi-axis.
struct Uncertainty {
  double semi_axes = 0.0;
  double exponents = 0.0;
  double translation = 0.0;
};

[[nodiscard]] inline Enclosure about(double x, double radius) {
  return {x - radius, x + radius};
}

[[nodiscard]] inline UncertainPrimitive uncertain(const Primitive& primitive, const Uncertainty& by) {
  const auto& [semi_axes, exponents] = primitive.superquadric;
  UncertainPrimitive result{primitive.name, {}, {}, {}, primitive.pose.quaternion};
  const double reach = by.translation * std::ranges::min(semi_axes);
  for (std::size_t i = 0; i < 3; ++i) {
    result.semi_axes[i] = about(semi_axes[i], by.semi_axes * semi_axes[i]);
    result.translation[i] = about(primitive.pose.translation[i], reach);
  }
  for (std::size_t i = 0; i < 2; ++i) {
    result.exponents[i] = about(exponents[i], by.exponents * exponents[i]);
    result.exponents[i].hi = std::min(result.exponents[i].hi, 2.0);
  }
  return result;
}

[[nodiscard]] inline UncertainModel uncertain_model(std::span<const Primitive> primitives, const Uncertainty& by) {
  UncertainModel model;
  for (const Primitive& primitive : primitives) model.primitives.push_back(uncertain(primitive, by));
  return model;
}

/// A number of the interval, either end as often as all between.
[[nodiscard]] inline double any_of(const Enclosure& interval, RandomCases& random) {
  switch (random.choice(4)) {
    case 0: return interval.lo;
    case 1: return interval.hi;
    default: return std::clamp(random.uniform(interval.lo, interval.hi), interval.lo, interval.hi);
  }
}

[[nodiscard]] inline Model any_member(const UncertainModel& model, RandomCases& random) {
  Model member;
  for (const UncertainPrimitive& uncertain : model.primitives) {
    Primitive primitive{uncertain.name, {}, {{}, uncertain.quaternion}};
    for (std::size_t i = 0; i < 3; ++i) {
      primitive.superquadric.semi_axes[i] = any_of(uncertain.semi_axes[i], random);
      primitive.pose.translation[i] = any_of(uncertain.translation[i], random);
    }
    for (std::size_t i = 0; i < 2; ++i) primitive.superquadric.exponents[i] = any_of(uncertain.exponents[i], random);
    member.primitives.push_back(primitive);
  }
  return member;
}

/// The smallest semi-axes with the largest exponents first, then the opposite, then at random; the extremes stand where
/// the translations' lower ends put them.
[[nodiscard]] inline std::vector<Model> members(const UncertainModel& model, std::size_t count) {
  Model least;
  Model most;
  for (const auto& [name, axes, exponents, at, quaternion, bend] : model.primitives) {
    const Pose pose{{at[0].lo, at[1].lo, at[2].lo}, quaternion};
    least.primitives.push_back(
        {name, {{axes[0].lo, axes[1].lo, axes[2].lo}, {exponents[0].hi, exponents[1].hi}}, pose});
    most.primitives.push_back({name, {{axes[0].hi, axes[1].hi, axes[2].hi}, {exponents[0].lo, exponents[1].lo}}, pose});
  }
  std::vector<Model> result{least, most};
  RandomCases random(11);
  while (result.size() < count) result.push_back(any_member(model, random));
  return result;
}

/// How many members a test tries: the variable VERISQ_MEMBERS of the environment.
[[nodiscard]] inline std::size_t member_count(std::size_t otherwise) {
  return requested_count("VERISQ_MEMBERS", otherwise);
}

/// The objects of the paper's Table 5.
[[nodiscard]] inline std::vector<Primitive> table_objects() {
  return {{"capsule", {{0.75, 0.75, 1.0}, {1.0, 0.8}}, {}},
          {"gem", {{0.43, 0.6, 1.9}, {1.5, 0.4}}, {}},
          {"soap", {{3.4, 4.3, 1.7}, {0.1, 0.1}}, {}}};
}

[[nodiscard]] inline Primitive box(const Point& semi_axes, const Point& centre) {
  return {"box", {semi_axes, {0.05, 0.05}}, {centre, {1.0, 0.0, 0.0, 0.0}}};
}

/// Three solids in a row: the second is turned and overlaps the first, the third stands apart.
[[nodiscard]] inline std::vector<Primitive> three_in_a_row() {
  return {{"first", {{1.0, 0.8, 0.6}, {0.4, 0.9}}, {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}}},
          {"second", {{0.9, 0.5, 0.7}, {1.2, 0.6}}, {{1.5, 0.1, -0.1}, {0.9, 0.1, -0.2, 0.3}}},
          {"third", {{0.5, 0.5, 0.5}, {1.0, 1.0}}, {{3.5, 0.0, 0.2}, {1.0, 0.0, 0.0, 0.0}}}};
}

/// About each primitive: in its box, in three times its box, and on its surface.
[[nodiscard]] inline std::vector<Point> points_about(std::span<const Primitive> primitives, std::size_t of_each_kind) {
  RandomCases random(5);
  std::vector<Point> points;
  for (const Primitive& primitive : primitives) {
    const MixedNorm<double> norm(primitive.superquadric);
    for (std::size_t n = 0; n < 3 * of_each_kind; ++n) {
      Point q;
      for (std::size_t i = 0; i < 3; ++i) {
        q[i] = (n % 3 == 0 ? 3.0 : 0.7) * primitive.superquadric.semi_axes[i] * random.uniform(-1, 1);
      }
      const double scale = n % 3 == 2 ? 1.0 / norm.gauge(q) : 1.0;
      for (std::size_t i = 0; i < 3; ++i) q[i] = scale * q[i] + primitive.pose.translation[i];
      points.push_back(q);
    }
  }
  return points;
}

}  // namespace verisq::oracle
