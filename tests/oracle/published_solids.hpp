/// The solids of the paper's Table 5.
#pragma once

#include <array>
#include <string_view>
#include <verisq/model.hpp>

namespace verisq::oracle {

struct PublishedSolid {
  std::string_view name;
  Superquadric superquadric;
};

inline constexpr std::array published_solids{PublishedSolid{"capsule", {{0.75, 0.75, 1.0}, {1.0, 0.8}}},
                                             PublishedSolid{"gem", {{0.43, 0.6, 1.9}, {1.5, 0.4}}},
                                             PublishedSolid{"soap", {{3.4, 4.3, 1.7}, {0.1, 0.1}}}};

}  // namespace verisq::oracle
