/// The choice of the alpha of a wrap: as small as the gaps of the input allow.
#pragma once

#include <optional>
#include <verisq/mesh.hpp>

namespace verisq::surface {

struct Wrap {
  Mesh mesh;
  double alpha;
  double offset;
};

/// The wrap with the alpha that `prepare_surface` promises; `offset` as given, or alpha / 100. Throws Error(input)
/// where all vertices coincide.
[[nodiscard]] Wrap wrap_with_chosen_alpha(const Mesh& input, std::optional<double> offset);

/// The wrap with the alpha given.
[[nodiscard]] Wrap wrap(const Mesh& input, double alpha, std::optional<double> offset);

}  // namespace verisq::surface
