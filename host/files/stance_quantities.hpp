/// Numbers of a stance model that may be uncertain, and the parameters that they name.
#pragma once

#include <functional>
#include <string>
#include <vector>
#include <verisq/stance_model.hpp>

#include "host/files/xml_element.hpp"

namespace verisq::stance {

/// Reads quantities in the order of the file. The first that names a parameter defines it; later ones that give its
/// name alone share it.
class Quantities {
 public:
  /// One of  value="V";  lower="L" upper="U" with an optional nominal="N", else the midpoint;  nominal="N"
  /// deviation="D";  each with an optional parameter="NAME", which unit="..." and description="..." may explain, and
  /// which a deviation must have. Or parameter="NAME" alone. Fails where `allowed` refuses an end of the range, with
  /// `what` it must be.
  [[nodiscard]] Quantity read(const XmlElement& element, const std::function<bool(double)>& allowed, const char* what);
  /// For any finite number.
  [[nodiscard]] Quantity read(const XmlElement& element);

  /// Components x, y, z: each an attribute, which is exact, or a child that is a quantity.
  [[nodiscard]] QuantityVector read_vector(const XmlElement& element, const std::function<bool(double)>& allowed,
                                           const char* what);
  [[nodiscard]] QuantityVector read_vector(const XmlElement& element);

  [[nodiscard]] const std::vector<Parameter>& parameters() const { return parameters_; }

 private:
  [[nodiscard]] std::optional<std::uint32_t> index_of(std::string_view name) const;
  [[nodiscard]] Quantity known(const XmlElement& element) const;
  [[nodiscard]] Quantity define(const XmlElement& element, Quantity quantity);

  std::vector<Parameter> parameters_;
};

}  // namespace verisq::stance
