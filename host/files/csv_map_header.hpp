/// The columns of a map as CSV, by their names in the first line.
#pragma once

#include <string_view>
#include <verisq/map_file.hpp>

namespace verisq {

inline constexpr std::string_view csv_map_header = "index,lo,hi,status";

/// With certificates, of points. `primitive` and `normal_*` are the first normal, `further_normals` the others, each as
/// "primitive:x:y:z" with a blank between two; fields of what a certificate does not have are empty.
inline constexpr std::string_view csv_certified_map_header =
    "index,lo,hi,status,primitive,normal_x,normal_y,normal_z,further_normals,escape_x,escape_y,escape_z";

/// The same with witnesses and covers, these as hexadecimal digits.
inline constexpr std::string_view csv_covered_map_header =
    "index,lo,hi,status,primitive,normal_x,normal_y,normal_z,further_normals,escape_x,escape_y,escape_z,"
    "witness_x,witness_y,witness_z,cover";

/// The same of triangles, whose certificates have weights instead of an escape.
inline constexpr std::string_view csv_certified_triangle_map_header =
    "index,lo,hi,status,primitive,normal_x,normal_y,normal_z,further_normals,weight_1,weight_2";
inline constexpr std::string_view csv_covered_triangle_map_header =
    "index,lo,hi,status,primitive,normal_x,normal_y,normal_z,further_normals,weight_1,weight_2,"
    "witness_x,witness_y,witness_z,cover";

/// That of a map with certificates, or with covers, too.
[[nodiscard]] constexpr std::string_view csv_certified_header(MapElements elements, bool covered) {
  if (elements == MapElements::vertices) return covered ? csv_covered_map_header : csv_certified_map_header;
  return covered ? csv_covered_triangle_map_header : csv_certified_triangle_map_header;
}

}  // namespace verisq
