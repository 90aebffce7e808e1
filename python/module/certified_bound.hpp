/// The class verisq.CertifiedBound: how good a fit can be at best, with what proves it again.
#pragma once

#include <pybind11/pybind11.h>

#include <cstddef>
#include <verisq/best_fit_certificate.hpp>

#include "python/module/pickling.hpp"

namespace verisq::python {

template <>
inline constexpr std::size_t member_count<Fitness> = 3;
template <>
inline constexpr std::size_t member_count<Area> = 2;
template <>
inline constexpr std::size_t member_count<ClearanceTerms> = 4;
template <>
inline constexpr std::size_t member_count<PoseRange> = 3;
template <>
inline constexpr std::size_t member_count<BestFitClaim> = 4;
template <>
inline constexpr std::size_t member_count<BestFitCertificate> = 1;

struct PythonCertifiedBound {
  BestFitClaim claim;
  BestFitCertificate certificate;

  static constexpr std::size_t members = 2;
};

void declare_class_of_certified_bounds(pybind11::module_& module);

}  // namespace verisq::python
