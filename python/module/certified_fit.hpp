/// The classes verisq.CertifiedBound and verisq.CertifiedContact: what proves a fit's bound and contact again.
#pragma once

#include <pybind11/pybind11.h>

#include <cstddef>
#include <string>
#include <vector>
#include <verisq/deviation.hpp>
#include <verisq/fit_bound.hpp>

#include "python/module/pickling.hpp"

namespace verisq::python {

// The class verisq.CertifiedBound: how good a fit can be at best, with what proves it again.

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

// The class verisq.CertifiedContact: how much of a mesh's area is in contact, with what proves it again.

template <>
inline constexpr std::size_t member_count<ContactTerms> = 4;
template <>
inline constexpr std::size_t member_count<ContactClaim> = 3;
template <>
inline constexpr std::size_t member_count<ContactClaims> = 3;
template <>
inline constexpr std::size_t member_count<VertexProof> = 2;
template <>
inline constexpr std::size_t member_count<DividedTriangle> = 2;
template <>
inline constexpr std::size_t member_count<ContactCertificate> = 3;

struct PythonCertifiedContact {
  std::vector<std::string> areas;  ///< names of the regions
  ContactTerms terms;
  ContactClaims claims;
  ContactCertificate certificate;

  static constexpr std::size_t members = 4;
};

void declare_class_of_certified_contacts(pybind11::module_& module);

}  // namespace verisq::python
