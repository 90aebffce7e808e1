/// How large an implant's parts are.
#pragma once

#include "verisq/model.hpp"

namespace verisq::fit_search {

/// To nearest, in cubes of the model unit. Proportional to each semi-axis.
[[nodiscard]] double volume(const Superquadric& solid);

}  // namespace verisq::fit_search
