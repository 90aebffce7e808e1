/// Names of arguments that several kernels have, in the order of the buffers that belong to them.
#pragma once

#include <array>
#include <string_view>

namespace verisq::device {

inline constexpr std::array<std::string_view, 3> coordinate_arguments{"xs", "ys", "zs"};
inline constexpr std::array<std::string_view, 2> enclosure_arguments{"los", "his"};
inline constexpr std::array<std::string_view, 2> union_arguments{"union_los", "union_his"};

/// Of EvidenceBuffers.
inline constexpr std::array<std::string_view, 5> evidence_arguments{"los", "his", "normal_xs", "normal_ys",
                                                                    "normal_zs"};

}  // namespace verisq::device
