/// Points that lie inside a tapered solid by hardly more than rounding, at 200 bits: no kernel may call them outside.
#pragma once

#include <cstddef>
#include <vector>
#include <verisq/model.hpp>

#include "tests/oracle/random_cases.hpp"

namespace verisq::mutation {

/// `count` points of the model's frame, in which the solid lies about `centre`, not turned.
[[nodiscard]] std::vector<Point> just_inside_tapered(const Superquadric& solid, const Point& centre, std::size_t count,
                                                     oracle::RandomCases& random);

}  // namespace verisq::mutation
