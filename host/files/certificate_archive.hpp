/// One description of each value of a certificate file serves reading and writing; and the values that several kinds
/// hold (docs/formats.md §9).
#pragma once

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>
#include <verisq/certificate_file.hpp>

#include "host/errors/refusal.hpp"
#include "host/files/json_document.hpp"
#include "host/files/map_layout.hpp"

// A description is a function `describe(archive, value)`. It calls one member of the archive that states the value's
// form in JSON, such as `object`, and then `require` and `each` for the conditions that a reader checks. A reading
// archive fills the value; a writing one takes it const. The order of the fields is that of the file.
namespace verisq::certificates {

/// A `Value`; const if it is written.
template <class Type, class Value>
concept Of = std::same_as<std::remove_const_t<Type>, Value>;

/// A kind of certificate files, a specialization beside each description.
struct Kind {
  std::string_view word = {};
  int indentation = -1;  ///< of the whole document; -1: it takes one line, but for lists of lines
};
template <class Answer>
inline constexpr Kind kind_of{};

inline constexpr const char* certificate_format = "verisq-certificate/1";

/// Fails where the value is not allowed; called before the value is read.
using Rule = void (*)(const JsonValue& where);

inline void nonnegative(const JsonValue& where) {
  if (where.number() < 0.0) where.fail("must be at least 0");
}
inline void positive(const JsonValue& where) {
  if (!(where.number() > 0.0)) where.fail("must be positive");
}
inline void one_line(const JsonValue& where) {
  (void)where.line();
}
inline void shown_name(const JsonValue& where) {
  (void)where.name();
}
inline void not_empty(const JsonValue& where) {
  if (where.size() == 0) where.fail("must not be empty");
}

// Fields of an object. Functions give tuples of them, of which `object` takes any number.

/// Describes a value by the `describe` of its type.
struct ByType {
  void operator()(const auto& archive, auto& value) const { describe(archive, value); }
};

/// The key may be missing where `Value` is optional.
template <class Value, class How>
struct Field {
  const char* key;
  Value& value;
  How how;
  Rule rule = nullptr;
  bool unless_empty = false;     ///< the key is missing where the value is empty
  const char* beside = nullptr;  ///< the key is there with this one, and not without it
};

/// A key that has the same value in every file.
struct Constant {
  const char* key;
  std::string_view value;
};

/// A list of the document itself, written as one line an element.
template <class Value>
struct Lines {
  const char* key;
  Value& value;
  const char* fewer;  ///< what to reduce if the file would be too large
};

template <class Value>
auto field(const char* key, Value& value, Rule rule = nullptr) {
  return std::tuple(Field<Value, ByType>{key, value, {}, rule});
}
template <class Value, class How>
auto field_by(const char* key, Value& value, How how) {
  return std::tuple(Field<Value, How>{key, value, how});
}
template <class Value, class How>
auto unless_empty(std::tuple<Field<Value, How>> one) {
  std::get<0>(one).unless_empty = true;
  return one;
}
template <class Value, class How>
auto beside(const char* other, std::tuple<Field<Value, How>> one) {
  std::get<0>(one).beside = other;
  return one;
}
inline auto constant(const char* key, std::string_view value) {
  return std::tuple(Constant{key, value});
}
template <class Value>
auto lines(const char* key, Value& value, const char* fewer) {
  return std::tuple(Lines<Value>{key, value, fewer});
}

template <class Value>
inline constexpr bool is_optional = false;
template <class Value>
inline constexpr bool is_optional<std::optional<Value>> = true;

/// The words of a value that is one of few.
template <class Value>
using Words = std::initializer_list<std::pair<std::string_view, std::remove_const_t<Value>>>;

class ReadingArchive {
 public:
  static constexpr bool reads = true;

  explicit ReadingArchive(const JsonValue& value) : value_(value) {}

  [[nodiscard]] const JsonValue& json() const { return value_; }

  /// An object of these keys and no others.
  template <class... Groups>
  void object(const Groups&... groups) const {
    std::apply(
        [this](const auto&... fields) {
          value_.check_keys({fields.key...});
          (this->get(fields), ...);
        },
        std::tuple_cat(groups...));
  }

  /// An array of these values.
  template <class... Values>
  void array(std::string_view otherwise, Values&... values) const {
    if (value_.size() != sizeof...(values)) value_.fail(otherwise);
    std::size_t k = 0;
    (describe(ReadingArchive(value_.element(k++)), values), ...);
  }

  /// An array of any length; `how` describes one element of each list for each of its elements.
  template <class How, class... Lists>
  void list(const How& how, Lists&... lists) const {
    const std::size_t count = value_.size();
    for (std::size_t i = 0; i < count; ++i) how(ReadingArchive(value_.element(i)), lists.emplace_back()...);
  }

  void number_or_infinity(double& number) const { number = value_.number_or_infinity(); }

  // Values that JSON and C++ have in common, and covers.

  void plain(double& number) const { number = value_.number(); }
  void plain(std::string& text) const { text = value_.text(); }

  template <std::unsigned_integral Index>
  void plain(Index& index) const {
    if (!value_.json().is_number_unsigned() || value_.json().template get<std::uint64_t>() > 0xffffffffU) {
      value_.fail("must be an index");
    }
    index = value_.json().template get<std::uint32_t>();
  }

  template <std::size_t N>
  void plain(std::array<double, N>& numbers) const {
    if (value_.size() != N) value_.fail(fmt::format("must be an array of {} numbers", N));
    for (std::size_t k = 0; k < N; ++k) numbers[k] = value_.element(k).number();
  }

  void plain(std::vector<bool>& cover) const {
    auto read = cover_from(value_.text());
    if (!read) value_.fail("must be the hexadecimal digits of a cover");
    cover = *std::move(read);
  }

  template <class Value>
  void word(Value& value, Words<Value> words, std::string_view otherwise) const {
    const std::string text = value_.text();
    const auto* const found = std::ranges::find(words, text, [](const auto& word) { return word.first; });
    if (found == words.end()) value_.fail(otherwise);
    value = found->second;
  }

  /// A text of one letter for each element: the letters of the enumerators, in their order.
  template <class Letter>
  void letters(std::vector<Letter>& all, std::string_view alphabet, std::string_view otherwise) const {
    const std::string text = value_.text();
    all.reserve(text.size());
    for (const char letter : text) {
      const std::size_t index = alphabet.find(letter);
      if (index == std::string_view::npos) value_.fail(otherwise);
      all.push_back(static_cast<Letter>(index));
    }
  }

  [[nodiscard]] bool is_object(bool /*when_written*/) const { return value_.json().is_object(); }
  [[nodiscard]] bool has(std::string_view key) const { return value_.find(key).has_value(); }

  /// Fails at "areas[2].name", a path in this value, or at the value itself, unless something holds.
  template <class... Arguments>
  void require(bool holds, std::string_view place, fmt::format_string<const Arguments&...> otherwise,
               const Arguments&... arguments) const {
    if (holds) return;
    const JsonValue where = place.empty() ? value_ : value_.at_place(place);
    where.fail(fmt::format(otherwise, arguments...));
  }

  /// Fails at `within` of the first element of `key` for which `holds(index)` is false.
  template <class List, class Holds, class... Arguments>
  void each(std::string_view key, std::string_view within, const List& list, Holds holds,
            fmt::format_string<const Arguments&...> otherwise, const Arguments&... arguments) const {
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (!holds(i)) require(false, fmt::format("{}[{}]{}", key, i, within), otherwise, arguments...);
    }
  }

 private:
  template <class Value, class How>
  void get(const Field<Value, How>& field) const {
    const std::optional<JsonValue> found = value_.find(field.key);
    const bool alone = field.beside != nullptr && !has(field.beside);
    if (found && alone) found->fail(fmt::format("must not be there without \"{}\"", field.beside));
    if (!found && (alone || field.unless_empty || (is_optional<Value> && field.beside == nullptr))) return;
    const JsonValue where = value_.at(field.key);
    if (field.rule != nullptr) field.rule(where);
    if constexpr (is_optional<Value>) {
      field.how(ReadingArchive(where), field.value.emplace());
    } else {
      field.how(ReadingArchive(where), field.value);
    }
  }

  void get(const Constant& constant) const {
    const JsonValue where = value_.at(constant.key);
    if (where.line() != constant.value) where.fail(fmt::format("must be \"{}\"", constant.value));
  }

  template <class Value>
  void get(const Lines<Value>& lines) const {
    ReadingArchive(value_.at(lines.key)).list(ByType(), lines.value);
  }

  JsonValue value_;
};

using OrderedJson = nlohmann::ordered_json;

[[nodiscard]] inline std::string text_of(const OrderedJson& document, int indentation) {
  return document.dump(indentation, ' ', false, OrderedJson::error_handler_t::replace);
}

/// A document that is being written. Its lists of lines become text at once: none is a document in memory besides.
struct Document {
  std::string name;  ///< name of its file, for messages
  OrderedJson head = {};
  std::string lines = {};  ///< the head, too, where there are lists of lines; all but the last brace
};

class WritingArchive {
 public:
  static constexpr bool reads = false;

  /// Only an archive of a whole document writes lists of lines.
  explicit WritingArchive(OrderedJson& value, Document* document = nullptr) : value_(value), document_(document) {}

  template <class... Groups>
  void object(const Groups&... groups) const {
    value_ = OrderedJson::object();
    std::apply([this](const auto&... fields) { (this->put(fields), ...); }, std::tuple_cat(groups...));
  }

  template <class... Values>
  void array(std::string_view /*otherwise*/, const Values&... values) const {
    value_ = OrderedJson::array();
    (describe(next(), values), ...);
  }

  template <class How, class First, class... Lists>
  void list(const How& how, const First& first, const Lists&... lists) const {
    value_ = OrderedJson::array();
    for (std::size_t i = 0; i < first.size(); ++i) how(next(), first[i], lists[i]...);
  }

  void plain(const std::vector<bool>& cover) const { value_ = digits_of_cover(cover); }
  void plain(const auto& plain) const { value_ = plain; }

  void number_or_infinity(double number) const {
    if (std::isfinite(number)) {
      value_ = number;
    } else {
      value_ = number > 0.0 ? "inf" : "-inf";
    }
  }

  template <class Value>
  void word(const Value& value, Words<Value> words, std::string_view /*otherwise*/) const {
    for (const auto& [word, meaning] : words) {
      if (meaning == value) value_ = word;
    }
  }

  template <class Letter>
  void letters(const std::vector<Letter>& all, std::string_view alphabet, std::string_view /*otherwise*/) const {
    std::string text;
    text.reserve(all.size());
    for (const Letter letter : all) text += alphabet[static_cast<std::size_t>(letter)];
    value_ = std::move(text);
  }

  [[nodiscard]] bool is_object(bool when_written) const { return when_written; }
  [[nodiscard]] bool has(std::string_view /*key*/) const { return true; }
  void require(const auto&... /*unused*/) const {}
  void each(const auto&... /*unused*/) const {}

 private:
  [[nodiscard]] WritingArchive next() const {
    value_.push_back(nullptr);
    return WritingArchive(value_.back());
  }

  template <class Value, class How>
  void put(const Field<Value, How>& field) const {
    if constexpr (is_optional<std::remove_const_t<Value>>) {
      if (field.value) field.how(WritingArchive(value_[field.key]), *field.value);
    } else {
      if constexpr (requires { field.value.empty(); }) {
        if (field.unless_empty && field.value.empty()) return;
      }
      field.how(WritingArchive(value_[field.key]), field.value);
    }
  }

  void put(const Constant& constant) const { value_[constant.key] = constant.value; }

  template <class Value>
  void put(const Lines<Value>& lines) const {
    std::string& text = document_->lines;
    if (text.empty()) (text = text_of(document_->head, -1)).pop_back();
    text += fmt::format(",\n\"{}\": [", lines.key);
    for (std::size_t i = 0; i < lines.value.size(); ++i) {
      OrderedJson line;
      describe(WritingArchive(line), lines.value[i]);
      text += (i == 0 ? "\n" : ",\n") + text_of(line, -1);
      constexpr std::size_t of_ending = 2;
      if (text.size() + of_ending <= largest_certificate) continue;
      refuse(fmt::format("{}: the first {} of {} {} take more than the {} bytes of a certificate file: give fewer {}",
                         document_->name, i + 1, lines.value.size(), lines.key, largest_certificate, lines.fewer));
    }
    text += "\n]";
  }

  OrderedJson& value_;
  Document* document_;
};

// Conditions that `each` tests for elements.

/// The condition that no element equals an earlier one, by the result of `of`.
template <class List, class Tell = std::identity>
[[nodiscard]] auto distinct(const List& list, Tell of = {}) {
  using Told = std::remove_cvref_t<std::invoke_result_t<Tell, const typename List::value_type&>>;
  return [&list, of, seen = std::set<Told>()](std::size_t i) mutable {
    return seen.insert(std::invoke(of, list[i])).second;
  };
}

/// The condition that each element is above the one before.
template <class List, class Tell = std::identity>
[[nodiscard]] auto ascending(const List& list, Tell of = {}) {
  return [&list, of](std::size_t i) { return i == 0 || std::invoke(of, list[i - 1]) < std::invoke(of, list[i]); };
}

// Values of C++.

template <class Value>
concept Plain = requires(const ReadingArchive& archive, std::remove_const_t<Value>& value) {
  archive.plain(value);
};

/// Elements that are described one by one: bits make a cover, enumerators a text of letters.
template <class List>
concept Described =
    !Plain<List> && Of<List, std::vector<typename List::value_type>> && !std::is_enum_v<typename List::value_type>;

void describe(const auto& archive, Plain auto& value) {
  archive.plain(value);
}
void describe(const auto& archive, Described auto& list) {
  archive.list(ByType(), list);
}

// Values that several kinds of certificate files hold.

inline void is_digest(const JsonValue& where) {
  const std::string text = where.text();
  if (text.size() != 64 || text.find_first_not_of("0123456789abcdef") != std::string::npos)
    where.fail("must be 64 lower-case hexadecimal digits");
}

void describe(const auto& archive, Of<SubjectFile> auto& file) {
  archive.object(field("file", file.name), field("sha256", file.sha256, is_digest));
}

inline constexpr auto as_end = [](const auto& archive, auto& end) { archive.number_or_infinity(end); };

auto claim_fields(Of<Enclosure> auto& claim) {
  return std::tuple_cat(field_by("lo", claim.lo, as_end), field_by("hi", claim.hi, as_end));
}
void describe(const auto& archive, Of<Enclosure> auto& claim) {
  archive.object(claim_fields(claim));
}

void describe(const auto& archive, Of<Pose> auto& pose) {
  archive.object(field("translation", pose.translation), field("quaternion", pose.quaternion));
  archive.require(pose.quaternion != decltype(pose.quaternion){}, "quaternion", "must not be zero");
}

void describe(const auto& archive, Of<Normal> auto& normal) {
  auto& [x, y, z] = normal.vector;
  archive.array("must be the index of a primitive and three numbers", normal.primitive, x, y, z);
}

/// The fields of a point's certificate, or of a triangle's without weights.
auto certificate_fields(Of<Certificate> auto& certificate) {
  return std::tuple_cat(field("normals", certificate.normals), field("escape", certificate.escape),
                        field("witness", certificate.witness), unless_empty(field("cover", certificate.cover)));
}

auto sample_fields(Of<CertifiedEnclosure> auto& sample) {
  return std::tuple_cat(claim_fields(sample.distance), certificate_fields(sample.certificate));
}
void describe(const auto& archive, Of<CertifiedEnclosure> auto& sample) {
  archive.object(sample_fields(sample));
}

// Fields that files begin with.

/// The format and the kind.
template <class Answer>
auto heading() {
  constexpr Kind kind = kind_of<std::remove_const_t<Answer>>;
  static_assert(!kind.word.empty(), "a kind has a word");
  return std::tuple_cat(constant("format", certificate_format), constant("kind", kind.word));
}

inline constexpr auto as_one_model = [](const auto& archive, auto& model) {
  archive.array("must be an array of one model", model);
};
inline constexpr auto as_two_models = [](const auto& archive, auto& models) {
  archive.array("must be an array of two models", models[0], models[1]);
};

template <class Answer>
auto units_of(Answer& answer) {
  return unless_empty(field("units", answer.units, one_line));
}
template <class Answer>
auto head_of_two_models(Answer& answer) {
  return std::tuple_cat(heading<Answer>(), field_by("models", answer.models, as_two_models), units_of(answer));
}
template <class Answer>
auto head_of_model_and_mesh(Answer& answer) {
  return std::tuple_cat(heading<Answer>(), field_by("models", answer.model, as_one_model), field("mesh", answer.mesh),
                        units_of(answer));
}

}  // namespace verisq::certificates
