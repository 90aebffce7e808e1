/// Texts of others are shown on one line, in marks, no longer than a name, and nothing in them acts on a terminal.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "host/errors/refusal.hpp"
#include "tests/fixtures/hostile_texts.hpp"

namespace verisq::testing {
namespace {

using ::testing::EndsWith;
using ::testing::StartsWith;

TEST(Quotation, ShowsNamesAsTheyAre) {
  for (const char* const name :
       {"stem", "left femur (2).off", "Hüftschaft", "Schaft µ²", "бедро", "μηρός", "大腿骨.stl", "넙다리뼈", "l’os",
        "it's", "a-b_c/d.e", "xương đùi", "xu\u031bo\u031bng", "=1+1"}) {
    EXPECT_EQ(quotation(name), "\"" + std::string(name) + "\"");
    EXPECT_TRUE(is_plain(name)) << name;
    EXPECT_EQ(on_one_line(name), name);
  }
  EXPECT_EQ(quotation(""), "\"\"");
}

TEST(Quotation, EscapesWhatEndsItOrActs) {
  EXPECT_EQ(quotation("a\" proved \"b"), R"("a\" proved \"b")");
  EXPECT_EQ(quotation("a' proved", '\''), R"('a\' proved')");
  EXPECT_EQ(quotation(R"(a\)"), R"("a\\")");
  EXPECT_EQ(quotation("a\nb\x1b[11A"), R"("a\x0ab\x1b[11A")");
  EXPECT_EQ(quotation(std::string_view("a\0b", 3)), R"("a\x00b")");
  EXPECT_EQ(quotation("\u202e\u2028\u0085\ufeff\u00a0"), R"("\u{202e}\u{2028}\u{85}\u{feff}\u{a0}")");
  EXPECT_EQ(quotation("\xff\xc0\x80\xed\xa0\x80\xf4\x90\x80\x80\xe2\x80"),
            R"("\xff\xc0\x80\xed\xa0\x80\xf4\x90\x80\x80\xe2\x80")")
      << "no UTF-8";
  EXPECT_EQ(quotation("\u201d \u2033"), R"("\u{201d} \u{2033}")") << "look like the mark";
  EXPECT_EQ(quotation(" a  b "), R"("\x20a \x20b\x20")");
  EXPECT_EQ(quotation("o\u0301\u0302\u0303 \u0301"), "\"o\u0301\u0302\\u{303} \\u{301}\"");
  EXPECT_EQ(quotation("\u05d0\u0661"), R"("\u{5d0}\u{661}")") << "from right to left";
}

TEST(Quotation, HoldsNothingThatActs) {
  for (const std::string& text : hostile_texts()) {
    expect_harmless(quotation(text));
    expect_harmless(on_one_line(text));
    EXPECT_FALSE(is_plain(text)) << quotation(text);
  }
}

TEST(Quotation, KeepsBothEndsOfALongText) {
  const std::string front(19, 'a');
  const std::string back(40, 'z');
  EXPECT_EQ(quotation(front + "xxx" + back), "\"" + front + "…" + back + "\"");
  const std::string fits(longest_quotation, 'm');
  EXPECT_EQ(quotation(fits), "\"" + fits + "\"");
  EXPECT_EQ(quotation(std::string(1000, '\n')), R"("\x0a\x0a\x0a\x0a…\x0a\x0a\x0a\x0a\x0a\x0a\x0a\x0a\x0a\x0a")");
  const std::string long_text = "a" + std::string(std::size_t{1} << 26, '\x01') + "z";
  EXPECT_THAT(quotation(long_text), StartsWith("\"a\\x01"));
  EXPECT_THAT(quotation(long_text), EndsWith("\\x01z\""));
  EXPECT_THAT(quotation(std::string(100, 'a') + "\u2603 is no mark"), EndsWith("\\u{2603} is no mark\""));
}

TEST(Quotation, ShowsEightOfAList) {
  EXPECT_EQ(quotation(std::vector<std::string>{"a", "b\n"}), R"("a", "b\x0a")");
  EXPECT_EQ(quotation(std::vector<std::string>(10, "a")), R"("a", "a", "a", "a", "a", "a", "a", "a" and 2 more)");
}

/// What follows a number is a unit of length, or said to be a text.
TEST(Quotation, ShowsUnitsBehindNumbers) {
  EXPECT_EQ(units_behind(""), "");
  EXPECT_EQ(units_behind("mm"), " mm");
  EXPECT_EQ(units_behind("µm", 3), " µm^3");
  EXPECT_EQ(units_behind("", 3), "");
  EXPECT_EQ(units_behind("mm, proved"), " \"mm, proved\"");
  EXPECT_EQ(units_behind("bone lengths", 2), " \"bone lengths\"^2");
}

TEST(OneLine, KeepsWhatASentenceHasOfItsOwn) {
  const std::string sentence = "a.json: \"b\\x0a…\" is  not 'c'";
  EXPECT_EQ(on_one_line(sentence), sentence);
  EXPECT_EQ(on_one_line("a\nb"), "a\\x0ab");
  EXPECT_LT(on_one_line(std::string(100'000, 'a')).size(), 5000U);
}

}  // namespace
}  // namespace verisq::testing
