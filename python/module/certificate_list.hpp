/// The class verisq.Certificates: what proves the rows of a map again, kept as the library has it.
#pragma once

#include <cstddef>
#include <vector>
#include <verisq/certificate.hpp>

namespace verisq::python {

/// One for each row, in the order of the map.
struct CertificateList {
  std::vector<Certificate> certificates;

  static constexpr std::size_t members = 1;
};

}  // namespace verisq::python
