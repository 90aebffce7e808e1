/// Model, vertices and certificates, bit for bit.
#include "host/report/proof_data.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/files/input_file.hpp"
#include "host/files/sha256.hpp"
#include "host/report/column_text.hpp"

namespace verisq::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t piece = std::size_t{1} << 16;

/// Calls `take` with all bytes of a file.
template <class Take>
void for_each_piece(const std::filesystem::path& path, const Take& take) {
  InputFile file(path);
  while (file.remaining() > 0) {
    const std::size_t size = std::min<std::uint64_t>(piece, file.remaining());
    take(file.take(size, "its bytes"));
  }
}

std::string text_of(const std::filesystem::path& path) {
  std::string text;
  for_each_piece(path, [&](std::string_view bytes) { text += bytes; });
  return text;
}

std::string sha256_of(const std::filesystem::path& path) {
  Sha256 hash;
  for_each_piece(path, [&](std::string_view bytes) { hash.add(std::as_bytes(std::span(bytes))); });
  return hash.digest();
}

template <std::size_t size>
void append(std::vector<double>& numbers, const std::array<double, size>& more) {
  numbers.insert(numbers.end(), more.begin(), more.end());
}

std::vector<double> vertices(const Mesh& mesh) {
  std::vector<double> numbers;
  for (const Point& vertex : mesh.vertices) append(numbers, vertex);
  return numbers;
}

/// Where the primitives stand, if not where the file says.
Json poses(const Report& report) {
  if (!report.proof->moved) return nullptr;
  std::vector<double> numbers;
  for (const Primitive& primitive : report.implant.primitives) {
    append(numbers, primitive.pose.translation);
    append(numbers, primitive.pose.quaternion);
  }
  return column_text(std::move(numbers));
}

/// Points that some rows have.
struct RowPoints {
  std::vector<std::uint32_t> rows;
  std::vector<double> points;

  void add(std::size_t row, const std::optional<Point>& point) {
    if (!point) return;
    rows.push_back(static_cast<std::uint32_t>(row));
    append(points, *point);
  }
};

/// Of all rows one after the other, eight a byte, the highest first.
struct CoverBits {
  std::vector<std::uint32_t> ends;
  std::vector<std::uint8_t> bytes;
  std::uint32_t count = 0;

  void add(const std::vector<bool>& cover) {
    for (const bool bit : cover) {
      if (count % 8 == 0) bytes.push_back(0);
      bytes.back() |= static_cast<std::uint8_t>((bit ? 0x80U : 0U) >> (count++ % 8));
    }
    ends.push_back(count);
  }
};

Json columns_of(std::span<const Certificate> certificates) {
  std::vector<std::uint32_t> ends;
  std::vector<std::uint32_t> primitives;
  std::vector<double> vectors;
  RowPoints escapes;
  RowPoints witnesses;
  CoverBits covers;
  for (std::size_t row = 0; row < certificates.size(); ++row) {
    const Certificate& certificate = certificates[row];
    for (const auto& [primitive, vector] : certificate.normals) {
      primitives.push_back(primitive);
      append(vectors, vector);
    }
    ends.push_back(static_cast<std::uint32_t>(primitives.size()));
    escapes.add(row, certificate.escape);
    witnesses.add(row, certificate.witness);
    covers.add(certificate.cover);
  }
  return {{"normals_end", column_text(std::move(ends))},
          {"primitives", column_text(std::move(primitives))},
          {"normals", column_text(std::move(vectors))},
          {"escaping", column_text(std::move(escapes.rows))},
          {"escapes", column_text(std::move(escapes.points))},
          {"witnessing", column_text(std::move(witnesses.rows))},
          {"witnesses", column_text(std::move(witnesses.points))},
          {"covers_end", column_text(std::move(covers.ends))},
          {"covers", column_text(std::move(covers.bytes))}};
}

}  // namespace

Json proof_data(const Report& report) {
  if (!report.proof) return nullptr;
  const ReportProof& proof = *report.proof;
  return {{"model", text_of(proof.model_file)},
          {"model_name", proof.model_file.filename().string()},
          {"mesh_name", proof.mesh_file.filename().string()},
          {"mesh_sha256", sha256_of(proof.mesh_file)},
          {"poses", poses(report)},
          {"point_radius", proof.point_radius},
          {"vertices", column_text(vertices(report.bone))},
          {"certificates", columns_of(proof.certificates)}};
}

}  // namespace verisq::report
