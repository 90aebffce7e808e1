/// Names of a file as text of a picture.
#pragma once

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

}  // namespace verisq::stance
