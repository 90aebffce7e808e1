/// The arrays are those of vtp_layout.cpp ("VTK File Formats", PPolyData).
#include "host/files/pvtp_document.hpp"

#include <fmt/format.h>

#include <string_view>

namespace verisq {
namespace {

std::string in_attribute(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&': escaped += "&amp;"; break;
      case '<': escaped += "&lt;"; break;
      case '"': escaped += "&quot;"; break;
      default: escaped += c;
    }
  }
  return escaped;
}

std::string array(std::string_view type, std::string_view name, int components) {
  return fmt::format("      <PDataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\"/>\n", type, name, components);
}

std::string results(bool closest_points) {
  std::string text;
  for (const char* const name : {"dist_lo", "dist_hi", "dist_mid"}) text += array("Float64", name, 1);
  text += array("UInt8", "status", 1);
  if (!closest_points) return text;
  text += array("UInt8", "unique", 1);
  for (const char* const name : {"closest_lo", "closest_hi", "normal_lo", "normal_hi", "normal"})
    text += array("Float64", name, 3);
  return text + array("Int32", "primitive", 1);
}

}  // namespace

std::string pvtp_document(std::span<const std::string> sources, bool closest_points) {
  std::string text =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"PPolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      "  <PPolyData GhostLevel=\"0\">\n";
  text += fmt::format("    <PPointData Scalars=\"dist_mid\"{}>\n{}    </PPointData>\n",
                      closest_points ? " Vectors=\"normal\"" : "", results(closest_points));
  text += fmt::format("    <PPoints>\n{}    </PPoints>\n", array("Float64", "Points", 3));
  for (const std::string& source : sources) text += fmt::format("    <Piece Source=\"{}\"/>\n", in_attribute(source));
  return text + "  </PPolyData>\n</VTKFile>\n";
}

}  // namespace verisq
