/// What proves the distance of two solids again, where planes between sections of their primitives, or balls about
/// these, or covers of their neighbourhoods do.
#pragma once

#include <cstddef>

#include "verify/proof/exact_checker.hpp"
#include "verify/sets/solid_pair_cells.hpp"
#include "verisq/model_search.hpp"
#include "verisq/pair_certificate.hpp"

namespace verisq::verify {

/// A model, and what searches make of it.
struct SearchedModel {
  explicit SearchedModel(const Model& of) : model(of), solid(of), places(of) {}

  Model model;
  SearchSolid solid;
  ExactChecker places;
};

/// Of a cover; about a neck beside a rim it has some 200.
inline constexpr std::size_t most_cells_about_a_primitive = 1000;

/// Planes alone: they lose least while a model moves.
[[nodiscard]] PairCertificate planes_between(const SearchedModel& a, const SearchedModel& b, const Pose& pose,
                                             const SearchedDistance& found, const SearchOptions& options);

/// As ModelSearch::certified says.
[[nodiscard]] PairCertificate certificate_of(const SearchedModel& a, const SearchedModel& b, const Pose& pose,
                                             const SearchedDistance& found, const SearchOptions& options);

}  // namespace verisq::verify
