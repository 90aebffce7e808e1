/// The peer: FCL's own continuous collision of two ellipsoids, one of which shifts.
///
/// One core, no verification. Conservative advancement stops where it would advance by less than 1e-4 of the time,
/// which the request's `toc_err` does not change in FCL 0.7; it knows balls, but no ellipsoids. Sampling ("naive",
/// FCL's default) asks at equal steps of time whether the bodies overlap.
#pragma once

#include <cstddef>
#include <optional>
#include <verisq/model.hpp>

namespace verisq::bench {

/// The time of first contact in [0, 1]; nothing where FCL says that there is none.
using FclContact = std::optional<double>;

/// Of balls. B goes from one place to the other on a straight line, A rests at the origin.
[[nodiscard]] FclContact fcl_advanced_contact(double radius_a, double radius_b, const Point& from, const Point& to);

/// Of ellipsoids, at `samples` times; precondition: at least 2.
[[nodiscard]] FclContact fcl_sampled_contact(const Point& semi_axes_a, const Point& semi_axes_b, const Point& from,
                                             const Point& to, std::size_t samples);

}  // namespace verisq::bench
