/// How much of an area is no farther than a distance.
#pragma once

#include <verisq/enclosure.hpp>

namespace verisq {

/// Areas in squares of the model unit.
struct AreaWithin {
  Enclosure area{0.0, 0.0};    ///< of all
  Enclosure within{0.0, 0.0};  ///< of what is no farther than the distance asked about
  Enclosure share{0.0, 0.0};   ///< of all that is, in [0, 1]: narrower than what follows of the two areas
};

}  // namespace verisq
