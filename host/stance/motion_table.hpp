/// A proven motion over time, as a table and as a picture.
#pragma once

#include <string>
#include <verisq/stance_motion.hpp>

namespace verisq::stance {

/// CSV, a header and a row for each slab: from, to, then _lo and _hi of each quantity, which contain it at all times
/// from the one to the other. Shortest decimals that read back as the same binary64.
[[nodiscard]] std::string motion_table(const Motion& motion);

/// SVG: the tubes of x, height and pitch of the root and of the cylinders' forces over time.
[[nodiscard]] std::string motion_picture(const Motion& motion);

}  // namespace verisq::stance
