/// A stance model over narrower ranges than its file's.
#pragma once

#include <cstdint>
#include <verisq/stance_model.hpp>

namespace verisq::stance {

/// The model with another range of one parameter, in which a nominal value that lies outside becomes the midpoint.
/// Precondition: `range` lies within the parameter's, so that what the reader asks of its ends holds.
[[nodiscard]] Model narrowed(Model model, std::uint32_t parameter, const Enclosure& range);

}  // namespace verisq::stance
