/// This file implements the reading of one.
#include "host/files/subject_file.hpp"

#include <algorithm>

namespace verisq {

SubjectFile read_subject_file(const JsonValue& value) {
  value.check_keys({"file", "sha256"});
  SubjectFile file{value.at("file").text(), value.at("sha256").text()};
  const auto is_digit = [](char c) { return ('0' <= c && c <= '9') || ('a' <= c && c <= 'f'); };
  if (file.sha256.size() != 64 || !std::ranges::all_of(file.sha256, is_digit)) {
    value.at("sha256").fail("must be 64 lower-case hexadecimal digits");
  }
  return file;
}

std::array<SubjectFile, 2> read_two_models(const JsonValue& value) {
  if (value.size() != 2) value.fail("must be an array of two models");
  return {read_subject_file(value.element(0)), read_subject_file(value.element(1))};
}

}  // namespace verisq
