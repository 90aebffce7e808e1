/// The conditions of a valid model.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "verisq/model.hpp"

namespace verisq::verify {

// Refuses the models that only branch and bound can answer for.

/// For functions that rest on certificates of convex primitives: throws like require_valid, and Error(input), "WHAT:
/// not supported for ...", unless is_union_of_convex(model). Without this a bend would be read as none, and a
/// difference as a union.
void require_union_of_convex(const Model& model, std::string_view what);

/// Returns whether the model is the union of all its primitives, bent or not.
[[nodiscard]] bool is_union(const Model& model);

/// For certificates of points: throws the same errors unless is_union(model).
void require_union(const Model& model, std::string_view what);

/// Throws Error(input), "WHAT: not supported for tapered solids ...", if a primitive has a taper.
void require_no_taper(const Model& model, std::string_view what);

// The faults of impossible models, defined once for the readers of files and for every entry of the library.

struct Fault {
  std::string place;  ///< the place as in a file: "primitives[2].superquadric.exponents[0]"
  std::string value;
  std::string what;  ///< "must be in (0, 2]"
};

/// The first that breaks a precondition of model.hpp. A bend must be proven to keep its limits, on the largest member.
[[nodiscard]] std::optional<Fault> fault_of(const UncertainModel& model);

/// Throws Error(input), "PLACE = VALUE: WHAT". Also throws if a primitive is a mesh: for whatever reads
/// `Primitive::superquadric` without a look at `Primitive::mesh`.
void require_valid(const UncertainModel& model);

/// The same for what answers for meshes, too.
void require_valid_with_meshes(const UncertainModel& model);

/// Throws the same error for a point with a number that is not finite.
void require_finite(const Point& point, const std::string& name);

/// Throws the same error for a motion with a number that is not finite or a quaternion of zeros. `name` names the
/// motion in the message.
void require_valid(const Pose& pose, const std::string& name);

}  // namespace verisq::verify
