/// What proves the distance of two solids again, where planes between sections of their primitives, or balls about
/// these, do.
#pragma once

#include "verify/sets/solid_pair_cells.hpp"
#include "verisq/model_search.hpp"
#include "verisq/pair_certificate.hpp"

namespace verisq::verify {

/// A model, and what searches make of it.
struct SearchedModel {
  explicit SearchedModel(const Model& of) : model(of), solid(of) {}

  Model model;
  SearchSolid solid;
};

/// As ModelSearch::certified says.
[[nodiscard]] PairCertificate certificate_of(const SearchedModel& a, const SearchedModel& b, const Pose& pose,
                                             const SearchedDistance& found, const SearchOptions& options);

}  // namespace verisq::verify
