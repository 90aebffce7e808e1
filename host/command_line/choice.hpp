/// Options whose value is one of a few words.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace verisq::command_line {

/// Throws Error(input): `text` is not one of `words`.
[[noreturn]] void refuse_choice(std::string_view option, std::string_view text,
                                const std::vector<std::string_view>& words);

template <class Value>
struct Choice {
  std::string_view word;
  Value value;
};

/// The kind of option whose words stand for these values; messages name the words in this order.
template <class Value>
[[nodiscard]] auto choice(std::initializer_list<Choice<Value>> choices) {
  return [choices = std::vector(choices)](std::string_view option, std::string_view text) {
    std::vector<std::string_view> words;
    for (const auto& [word, value] : choices) {
      if (word == text) return value;
      words.push_back(word);
    }
    refuse_choice(option, text, words);
  };
}

}  // namespace verisq::command_line
