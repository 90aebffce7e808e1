/// Certificates to columns and back.
#include "host/files/certificate_columns.hpp"

#include <cmath>

namespace verisq {

void CertificateColumns::append(const Certificate& certificate) {
  const std::vector<Normal>& normals = certificate.normals;
  primitive.push_back(normals.empty() ? no_primitive : static_cast<std::int32_t>(normals[0].primitive));
  normal.push_back(normals.empty() ? Point{} : normals[0].vector);
  escape.push_back(certificate.escape.value_or(no_escape));
  for (std::size_t k = 1; k < normals.size(); ++k) {
    further_primitive.push_back(static_cast<std::int32_t>(normals[k].primitive));
    further_normal.push_back(normals[k].vector);
  }
  further_normals_end.push_back(static_cast<std::int64_t>(further_primitive.size()));
}

CertificateColumns::Range CertificateColumns::further_normals(std::size_t row) const {
  return {row == 0 ? 0 : static_cast<std::size_t>(further_normals_end[row - 1]),
          static_cast<std::size_t>(further_normals_end[row])};
}

void CertificateColumns::read(std::size_t row, Certificate& certificate) const {
  certificate.normals.clear();
  certificate.escape.reset();
  if (primitive[row] != no_primitive) {
    certificate.normals.push_back({static_cast<std::uint32_t>(primitive[row]), normal[row]});
  }
  const auto [begin, end] = further_normals(row);
  for (std::size_t k = begin; k < end; ++k) {
    certificate.normals.push_back({static_cast<std::uint32_t>(further_primitive[k]), further_normal[k]});
  }
  if (!std::isnan(escape[row][0])) certificate.escape = escape[row];
}

}  // namespace verisq
