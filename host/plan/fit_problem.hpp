/// The problem of a fit as it is solved: the requirements, and the places where an implant touches.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>
#include <verisq/clearance.hpp>
#include <verisq/deviation.hpp>
#include <verisq/fit.hpp>
#include <verisq/fit_solution.hpp>
#include <verisq/map.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq::planning {

// The requirements of a fit, checked and made ready: constraints, sides, kept features.

// The changes that an implant makes to a bone's features, as ranges that a fit must keep.

/// Throws Error(input) for features that bone and implants do not determine.
void check_kept(const FitProblem& problem);

/// The problem must outlive them.
[[nodiscard]] std::vector<FitConstraint> constraints_of(const FitProblem& problem);

// The side of the mesh on which each of an implant's parts must be, from the request and the mesh itself.

/// The kind of surface that the mesh is. `has_sides` is true if its triangles keep the limit. `notices` gets the
/// assumptions made. Throws Error(input) if the user must decide, and for a surface other than the user claims.
[[nodiscard]] FitSurface surface_of(const FitRequest& request, const Mesh& mesh, bool has_sides,
                                    std::vector<std::string>& notices);

/// One side for each primitive of each implant; none if the surface is unsided. Throws Error(input) for unknown names,
/// and for those without a requirement, or with two.
[[nodiscard]] std::vector<std::vector<SurfaceSide>> sides_of(const FitRequest& request,
                                                             std::span<const UncertainModel> series,
                                                             FitSurface surface);

/// Nothing passes through a closed surface: throws Error(input) if a primitive is required to.
void check_openings(const FitRequest& request, const Mesh& mesh);

// The contact of bone and implant, as it is required and proven.

/// Returns whether a name of `KeptFeature` is one of contact.
[[nodiscard]] bool is_contact(std::string_view name);
/// Returns whether it is that of the implant's own surface.
[[nodiscard]] bool is_contact_of_implant(std::string_view name);

/// The contacts that the search keeps, by samples. It does not know requirements on the implant's own surface.
[[nodiscard]] std::vector<FitContact> contacts_of(const FitProblem& problem);

/// Throws Error(input) for missing areas, and for a mesh without triangles.
void check_contacts(const FitProblem& problem);

/// The largest distance that counts as contact.
[[nodiscard]] double contact_distance(const FitProblem& problem);

/// The share with this name; nothing if it is not requested.
[[nodiscard]] std::optional<Enclosure> share_named(const FitProblem& problem, const ContactAreas& contact,
                                                   std::string_view name);

/// The options for this implant of the series.
[[nodiscard]] ContactAreaOptions contact_options(const FitProblem& problem, std::size_t implant,
                                                 const std::function<bool()>& interrupted);

/// The contact of the posed implant of the series; nothing for a mesh without triangles.
[[nodiscard]] std::optional<ContactAreas> proven_contact(const FitProblem& problem, std::size_t implant,
                                                         const Model& posed, const MapOptions& options);

}  // namespace verisq::planning
