/// The XML part of a `.vtp` map: which arrays it declares and where their bytes lie.
#pragma once

#include <cstdint>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <verisq/map_file.hpp>

#include "host/files/input_file.hpp"
#include "host/files/vtp_layout.hpp"

namespace verisq {

/// An array in the appended part, as a DataArray element states it: nothing is known yet of the bytes it speaks of.
struct DeclaredArray {
  std::string_view name;
  std::uint64_t tuples;
  std::uint64_t offset;  ///< from the first byte of the appended part
};

/// What the writer writes ("VTK File Formats", XML): PolyData of one piece with appended raw arrays, little-endian,
/// version 1.0 with UInt64 headers. All members throw Error(input) naming the byte of the element and the value.
class VtpDocument {
 public:
  /// Reads `file`, which must outlive this, as far as the '_' before the appended part.
  explicit VtpDocument(InputFile& file);

  /// The elements that have an array of that name: a tuple for each point or for each triangle. Nothing when neither
  /// has; refused when both have.
  [[nodiscard]] std::optional<MapElements> elements_with(std::string_view name) const;

  // The one array of that name, which must have the type and number of components. `name` must outlive the result.
  [[nodiscard]] DeclaredArray element_array(MapElements elements, std::string_view name, std::string_view type,
                                            int components) const;
  [[nodiscard]] DeclaredArray field_array(std::string_view name, std::string_view type, int components) const;

  // Of the geometry: the coordinates of the points; the cells, as many as `layout` says.
  [[nodiscard]] DeclaredArray points(const VtpLayout& layout) const;
  /// A tuple for each cell, of its corners.
  [[nodiscard]] DeclaredArray connectivity(const VtpLayout& layout) const;
  [[nodiscard]] DeclaredArray offsets(const VtpLayout& layout) const;

  [[nodiscard]] VtpLayout layout(MapElements elements, std::uint64_t further_normals) const;

  /// Refuses an XML part that is not what the writer writes, to the letter: what nobody checks a viewer may show.
  void expect_only(const VtpLayout& layout) const;

 private:
  void check_attributes() const;
  [[nodiscard]] bool has_array(const char* data, std::string_view name) const;
  [[nodiscard]] std::uint64_t count(MapElements elements) const;
  [[nodiscard]] pugi::xml_node cells(const VtpLayout& layout) const;
  [[nodiscard]] pugi::xml_node poly_data() const;
  [[nodiscard]] pugi::xml_node piece() const;
  [[nodiscard]] pugi::xml_node only_child(pugi::xml_node parent, const char* name) const;
  [[nodiscard]] pugi::xml_node only_array(pugi::xml_node parent, std::string_view name, std::string_view type,
                                          int components) const;
  void expect(pugi::xml_node element, const char* attribute, std::string_view value) const;
  [[nodiscard]] std::uint64_t whole_number(pugi::xml_node element, const char* attribute) const;
  [[noreturn]] void fail(pugi::xml_node element, std::string_view message) const;

  const InputFile& file_;
  std::string text_;  // with the '_'
  pugi::xml_document xml_;
};

}  // namespace verisq
