/// The problem of a fit as it is solved: what is asked, and where an implant touches.
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

// What a fit is asked for, checked and made ready: constraints, sides, kept features.

// What an implant changes of a bone's features, as ranges that a fit keeps to.

/// Throws Error(input) for features that bone and implants say nothing of.
void check_kept(const FitProblem& problem);

/// The problem must outlive them.
[[nodiscard]] std::vector<FitConstraint> constraints_of(const FitProblem& problem);

// On which side of the mesh an implant's parts have to be, from what is asked for and the mesh itself.

/// What the mesh bounds; `has_sides` where its triangles keep the limit. Says in `notices` what it takes for granted.
/// Throws Error(input) where the user has to say, and for a surface that is not what the user says.
[[nodiscard]] FitSurface surface_of(const FitRequest& request, const Mesh& mesh, bool has_sides,
                                    std::vector<std::string>& notices);

/// One a primitive for each implant; none where the surface is unsided. Throws Error(input) for unknown names, and for
/// those that are asked for nothing, or twice.
[[nodiscard]] std::vector<std::vector<SurfaceSide>> sides_of(const FitRequest& request,
                                                             std::span<const UncertainModel> series,
                                                             FitSurface surface);

/// Nothing passes through a closed surface: throws Error(input) where a primitive is to.
void check_openings(const FitRequest& request, const Mesh& mesh);

// How much of bone and implant is in contact, as it is asked for and proven.

/// Whether a name of `KeptFeature` is one of contact.
[[nodiscard]] bool is_contact(std::string_view name);

/// What the search keeps to, by samples. What is asked of the implant's own surface it does not know.
[[nodiscard]] std::vector<FitContact> contacts_of(const FitProblem& problem);

/// Throws Error(input) for areas that are not there, and for a mesh without triangles.
void check_contacts(const FitProblem& problem);

/// No farther apart is contact: the largest distance that serves.
[[nodiscard]] double contact_distance(const FitProblem& problem);

/// The share that the name is of; nothing where it was not asked for.
[[nodiscard]] std::optional<Enclosure> share_named(const FitProblem& problem, const ContactAreas& contact,
                                                   std::string_view name);

/// Of the implant of the series.
[[nodiscard]] ContactAreaOptions contact_options(const FitProblem& problem, std::size_t implant,
                                                 const std::function<bool()>& interrupted);

/// Of the posed implant of the series; nothing for a mesh without triangles.
[[nodiscard]] std::optional<ContactAreas> proven_contact(const FitProblem& problem, std::size_t implant,
                                                         const Model& posed, const MapOptions& options);

}  // namespace verisq::planning
