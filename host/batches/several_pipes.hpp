/// The pipes of several devices as one: they take chunks in turn, as many points of them as each is fast.
#pragma once

#include <memory>
#include <vector>

#include "host/batches/point_pipe.hpp"

namespace verisq::device {

/// Rows are those of the device that its chunk fell to: where devices are alike, those of one. Precondition: at least
/// one pipe.
[[nodiscard]] std::unique_ptr<PointPipe> several_pipes(std::vector<std::unique_ptr<PointPipe>> pipes);

}  // namespace verisq::device
