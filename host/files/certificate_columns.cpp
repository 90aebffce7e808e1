/// Certificates to columns and back.
#include "host/files/certificate_columns.hpp"

#include <cmath>

namespace verisq {
namespace {

template <std::size_t N>
std::optional<std::array<double, N>> unless_none(const std::array<double, N>& numbers) {
  if (std::isnan(numbers[0])) return std::nullopt;
  return numbers;
}

}  // namespace

void CertificateColumns::append(const Certificate& certificate) {
  const std::vector<Normal>& normals = certificate.normals;
  primitive.push_back(normals.empty() ? no_primitive : static_cast<std::int32_t>(normals[0].primitive));
  normal.push_back(normals.empty() ? Point{} : normals[0].vector);
  if (elements == MapElements::vertices) {
    escape.push_back(certificate.escape.value_or(no_escape));
  } else {
    weights.push_back(certificate.weights.value_or(no_weights));
  }
  for (std::size_t k = 1; k < normals.size(); ++k) {
    further_primitive.push_back(static_cast<std::int32_t>(normals[k].primitive));
    further_normal.push_back(normals[k].vector);
  }
  further_normals_end.push_back(static_cast<std::int64_t>(further_primitive.size()));
  if (!covered) return;
  witness.push_back(certificate.witness.value_or(no_escape));
  cover.insert(cover.end(), certificate.cover.begin(), certificate.cover.end());
  cover_end.push_back(static_cast<std::int64_t>(cover.size()));
}

CertificateColumns::Range CertificateColumns::further_normals(std::size_t row) const {
  return {row == 0 ? 0 : static_cast<std::size_t>(further_normals_end[row - 1]),
          static_cast<std::size_t>(further_normals_end[row])};
}

void CertificateColumns::read(std::size_t row, Certificate& certificate) const {
  certificate.normals.clear();
  if (primitive[row] != no_primitive) {
    certificate.normals.push_back({static_cast<std::uint32_t>(primitive[row]), normal[row]});
  }
  const auto [begin, end] = further_normals(row);
  for (std::size_t k = begin; k < end; ++k) {
    certificate.normals.push_back({static_cast<std::uint32_t>(further_primitive[k]), further_normal[k]});
  }
  const bool of_vertex = elements == MapElements::vertices;
  certificate.escape = of_vertex ? unless_none(escape[row]) : std::nullopt;
  certificate.weights = of_vertex ? std::nullopt : unless_none(weights[row]);
  certificate.witness = covered ? unless_none(witness[row]) : std::nullopt;
  certificate.cover.clear();
  if (!covered) return;
  const std::int64_t first = row == 0 ? 0 : cover_end[row - 1];
  certificate.cover.assign(cover.begin() + first, cover.begin() + cover_end[row]);
}

}  // namespace verisq
