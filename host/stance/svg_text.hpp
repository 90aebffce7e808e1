/// Pictures as SVG: the document, and names of a file as its text.
#pragma once

#include <fmt/core.h>

#include <string>
#include <string_view>

namespace verisq::stance {

/// With the characters that XML reserves written as entities.
[[nodiscard]] inline std::string svg_text(std::string_view words) {
  std::string text;
  for (const char c : words) {
    switch (c) {
      case '&': text += "&amp;"; break;
      case '<': text += "&lt;"; break;
      case '>': text += "&gt;"; break;
      default: text += c;
    }
  }
  return text;
}

/// A white picture with these elements.
[[nodiscard]] inline std::string svg_document(double width, double height, std::string_view elements) {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0f} {:.0f}\" font-family=\"sans-serif\" "
      "font-size=\"13\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n{}</svg>\n",
      width, height, elements);
}

}  // namespace verisq::stance
