/// The Python literal that is a header.
#include "host/files/npy_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <set>
#include <system_error>

#include "host/files/input_file.hpp"
#include "host/files/words.hpp"

namespace verisq {
namespace {

/// NumPy itself takes longer headers for an attack.
constexpr std::uint64_t longest_header = 10000;

/// A reader of `{'descr': '<f8', 'fortran_order': False, 'shape': (3, 4), }`, of nothing that such a header cannot be.
class HeaderLiteral {
 public:
  HeaderLiteral(const InputFile& file, std::string_view text) : file_(file), text_(text), rest_(text) {}

  NpyHeader read() {
    NpyHeader header;
    std::set<std::string, std::less<>> keys;
    expect('{');
    while (!accept('}')) {
      const std::string key = string("a key");
      if (!keys.insert(key).second) fail(fmt::format("key {} twice", in_quotes(key)));
      expect(':');
      read_value(key, header);
      if (!accept(',')) {
        expect('}');
        break;
      }
    }
    skip_blanks();
    if (!rest_.empty()) fail(fmt::format("unexpected {} after it", in_quotes(rest_)));
    for (const char* const key : {"descr", "fortran_order", "shape"}) {
      if (!keys.contains(key)) fail(fmt::format("no key '{}'", key));
    }
    return header;
  }

 private:
  void read_value(std::string_view key, NpyHeader& header) {
    if (key == "descr") {
      skip_blanks();
      if (rest_.starts_with('[')) {
        fail(fmt::format("descr = {}: elements with fields, expected plain numbers", in_quotes(rest_)));
      }
      header.descr = string("descr");
    } else if (key == "fortran_order") {
      header.fortran_order = truth();
    } else if (key == "shape") {
      header.shape = sizes();
    } else {
      fail(fmt::format("unknown key {}", in_quotes(key)));
    }
  }

  std::string string(std::string_view what) {
    skip_blanks();
    const char quote = rest_.empty() ? '\0' : rest_.front();
    const std::size_t end = quote == '\'' || quote == '"' ? rest_.find(quote, 1) : std::string_view::npos;
    if (end == std::string_view::npos) fail(fmt::format("{}: expected {}", found(), what));
    std::string result(rest_.substr(1, end - 1));
    rest_.remove_prefix(end + 1);
    return result;
  }

  bool truth() {
    skip_blanks();
    for (const auto& [word, value] : {std::pair<std::string_view, bool>{"True", true}, {"False", false}}) {
      if (!rest_.starts_with(word)) continue;
      rest_.remove_prefix(word.size());
      return value;
    }
    fail(fmt::format("fortran_order = {}: expected True or False", found()));
  }

  std::vector<std::uint64_t> sizes() {
    std::vector<std::uint64_t> result;
    expect('(');
    while (!accept(')')) {
      result.push_back(size());
      if (!accept(',')) {
        expect(')');
        break;
      }
    }
    return result;
  }

  std::uint64_t size() {
    skip_blanks();
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
    if (error != std::errc{}) fail(fmt::format("shape: {}: not a size", found()));
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    return value;
  }

  void skip_blanks() { rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t\r\n"), rest_.size())); }

  bool accept(char c) {
    skip_blanks();
    if (!rest_.starts_with(c)) return false;
    rest_.remove_prefix(1);
    return true;
  }

  void expect(char c) {
    if (!accept(c)) fail(fmt::format("{}: expected '{}'", found(), c));
  }

  [[nodiscard]] std::string found() const { return rest_.empty() ? "the end" : in_quotes(rest_); }

  [[noreturn]] void fail(std::string_view message) const {
    file_.fail(fmt::format("header of the array: {}", message));
  }

  const InputFile& file_;
  std::string_view text_;
  std::string_view rest_;
};

/// The length has two bytes in version 1.0, four in the others, little-endian.
std::uint64_t header_length(InputFile& file) {
  const std::string_view version = file.take(2, "the version of the array");
  const auto major = static_cast<unsigned char>(version[0]);
  const auto minor = static_cast<unsigned char>(version[1]);
  if (major < 1 || major > 3 || minor != 0) {
    file.fail(fmt::format("version {}.{} of .npy: known are 1.0, 2.0, 3.0", major, minor));
  }
  if (major == 1) {
    return number_from<std::uint16_t>(file.take(2, "the length of the header").data(), std::endian::little);
  }
  return number_from<std::uint32_t>(file.take(4, "the length of the header").data(), std::endian::little);
}

}  // namespace

NpyHeader read_npy_header(InputFile& file) {
  const std::string_view magic = file.peek(npy_magic.size());
  if (magic != npy_magic) {
    file.fail_whole(fmt::format("not a NumPy array: begins with {}, expected '\\x93NUMPY'", in_quotes(magic)));
  }
  (void)file.take(npy_magic.size(), "the name of the format");
  const std::uint64_t length = header_length(file);
  if (length > longest_header) {
    file.fail(fmt::format("header of {} bytes: longer than {}", length, longest_header));
  }
  return HeaderLiteral(file, file.take(static_cast<std::size_t>(length), "the header of the array")).read();
}

std::string npy_header(std::string_view descr, std::uint64_t rows) {
  constexpr std::size_t alignment = 64;
  constexpr std::size_t before = npy_magic.size() + 4;  // with version and length
  const auto literal = [descr](std::uint64_t count) {
    return fmt::format("{{'descr': {}, 'fortran_order': False, 'shape': ({},), }}", descr, count);
  };
  const std::size_t longest = literal(std::numeric_limits<std::uint64_t>::max()).size() + 1;
  const std::size_t length = (before + longest + alignment - 1) / alignment * alignment - before;
  std::string header(npy_magic);
  header += {'\1', '\0', static_cast<char>(length % 256), static_cast<char>(length / 256)};
  header += fmt::format("{:<{}}\n", literal(rows), length - 1);
  return header;
}

}  // namespace verisq
