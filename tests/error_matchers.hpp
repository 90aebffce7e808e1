/// Expects a verisq::Error of a kind with a message, to the letter.
#pragma once

#include <gmock/gmock.h>

#include <filesystem>
#include <string>
#include <verisq/error.hpp>

namespace verisq::testing {

/// The message must be one line: `file`, then `rest` (which starts with ": ").
template <class Action>
void expect_error(Action action, ErrorKind kind, const std::string& file, const std::string& rest) {
  try {
    action();
    ADD_FAILURE() << "no error; expected " << file << rest;
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()), file + rest);
    EXPECT_EQ(error.kind(), kind) << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  }
}

template <class Action>
void expect_input_error(Action action, const std::filesystem::path& file, const std::string& rest) {
  expect_error(action, ErrorKind::input, file.string(), rest);
}

}  // namespace verisq::testing
