/// The classes verisq.CertifiedBound and verisq.CertifiedContact: what proves a fit's bound and contact again.
#pragma once

#include <pybind11/pybind11.h>

#include <string>
#include <vector>
#include <verisq/deviation.hpp>
#include <verisq/fit_bound.hpp>

#include "python/module/pickling.hpp"

namespace verisq::python {

// The class verisq.CertifiedBound: how good a fit can be at best, with what proves it again.

struct PythonCertifiedBound {
  BestFitClaim claim;
  BestFitCertificate certificate;
};

void declare_class_of_certified_bounds(pybind11::module_& module);

// The class verisq.CertifiedContact: how much of a mesh's area is in contact, with what proves it again.

struct PythonCertifiedContact {
  std::vector<std::string> areas;  ///< names of the regions
  ContactTerms terms;
  ContactClaims claims;
  ContactCertificate certificate;
};

void declare_class_of_certified_contacts(pybind11::module_& module);

}  // namespace verisq::python
