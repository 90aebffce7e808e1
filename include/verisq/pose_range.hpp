/// The poses that a fit may choose.
#pragma once

#include <verisq/model.hpp>

namespace verisq {

/// From the start, the implant's centre (of the bounding box of its own frame) moves by at most `translation` along
/// each axis, and the implant turns about that centre by a rotation vector of at most `rotation_degrees` along each
/// axis.
struct PoseRange {
  Pose start{};
  double translation;       ///< model units, >= 0
  double rotation_degrees;  ///< in [0, 180]
};

}  // namespace verisq
