/// How much of bone and implant is in contact, as it is asked for and proven.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string_view>
#include <verisq/contact_area.hpp>
#include <verisq/fit_problem.hpp>
#include <verisq/map.hpp>

namespace verisq::planning {

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
