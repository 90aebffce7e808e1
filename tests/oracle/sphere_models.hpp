/// Random models of spheres that overlap: unions, lenses, bored spheres and trees of them.
#pragma once

#include <fmt/format.h>

#include <verisq/model.hpp>

#include "tests/oracle/random_cases.hpp"

namespace verisq::oracle {

/// Two to four spheres of comparable size, in any order under one to three operators.
[[nodiscard]] inline Model random_spheres(RandomCases& random) {
  const double scale = random.log_uniform(1e-2, 1e2);
  const auto any_operation = [&] { return static_cast<SetOperation>(random.choice(3)); };
  Model model;
  const std::size_t count = 2 + random.choice(3);
  SetExpression tree{{}, SetOperation::unite, 0};
  for (std::uint32_t i = 0; i < count; ++i) {
    const double radius = scale * random.uniform(0.6, 1.2);
    Pose pose;
    for (double& t : pose.translation) t = 0.7 * scale * random.uniform(-1, 1);
    model.primitives.push_back({fmt::format("s{}", i), {{radius, radius, radius}, {1.0, 1.0}}, pose, {}});
    const SetExpression leaf{{}, SetOperation::unite, i};
    if (i == 0) continue;
    // A larger tree as the operand that is taken away, now and then.
    tree = random.choice(4) == 0 ? SetExpression{{leaf, tree}, any_operation(), 0}
                                 : SetExpression{{tree, leaf}, any_operation(), 0};
  }
  model.csg = tree;
  return model;
}

}  // namespace verisq::oracle
