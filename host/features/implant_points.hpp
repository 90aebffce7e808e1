/// The points of an implant that say what it changes of a femur, where its file does not name them all.
#pragma once

#include <string>
#include <vector>
#include <verisq/features.hpp>
#include <verisq/model.hpp>

namespace verisq::features {

struct ImplantPoints {
  FemurLandmarks points;
  std::vector<std::string> notes;  ///< of head and neck, where each comes from
};

/// A primitive and the point that is its centre.
struct NamedCentre {
  std::string name;
  Point centre;
};

/// Primitives whose centres are head and neck, before what the file names; "": the file's, else those of the usual
/// names, "head" and "neck".
struct HeadAndNeck {
  std::string head = {};
  std::string neck = {};
};

/// `named`: what the file names. Precondition: primitives that are asked for by name are among the centres.
[[nodiscard]] ImplantPoints implant_points(const FemurLandmarks& named, const std::vector<NamedCentre>& centres,
                                           const HeadAndNeck& asked = {});

}  // namespace verisq::features
