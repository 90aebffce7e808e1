/// The class verisq.CertifiedContact: how much of a mesh's area is in contact, with what proves it again.
#pragma once

#include <pybind11/pybind11.h>

#include <cstddef>
#include <string>
#include <vector>
#include <verisq/contact_certificate.hpp>

#include "python/module/pickling.hpp"
#include "python/module/result_members.hpp"

namespace verisq::python {

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
