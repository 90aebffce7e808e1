/// Certificates with one wrong digit, at every place of every number: nothing false is ever proved by them, nothing
/// true refuted, and where the digit carries the proof the row is no longer proved.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "tests/fixtures/forged_numbers.hpp"
#include "tests/fixtures/map_in_memory.hpp"
#include "verisq/checker.hpp"
#include "verisq/distance.hpp"
#include "verisq/enclosure.hpp"

namespace verisq {
namespace {

using oracle::moved;

constexpr std::size_t digits = 17;  // what a binary64 number needs at most

/// The number with one significant decimal digit changed, counted from 0.
double with_wrong_digit(double x, std::size_t place) {
  std::string text = fmt::format("{:.16e}", x);
  const std::size_t first = text.find_first_of("0123456789");
  char& digit = text[place == 0 ? first : first + 1 + place];
  digit = static_cast<char>('0' + (digit - '0' + 5) % 10);
  double changed = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), changed);
  return changed;
}

/// The numbers of a certificate, to be changed in place.
std::vector<std::reference_wrapper<double>> numbers_of(Certificate& certificate) {
  std::vector<std::reference_wrapper<double>> numbers;
  for (Normal& normal : certificate.normals)
    for (double& component : normal.vector) numbers.emplace_back(component);
  if (certificate.escape)
    for (double& coordinate : *certificate.escape) numbers.emplace_back(coordinate);
  return numbers;
}

struct Tally {
  std::size_t proved = 0;
  std::size_t unproved = 0;
};

struct Row {
  Point point;
  Enclosure claimed;
  Certificate certificate;
};

std::vector<Row> certified_rows(const Model& model, const std::vector<Point>& points, double tolerance) {
  const oracle::FinishedMap map = oracle::map_in_memory(model, points, {.tolerance = tolerance, .certificates = true});
  std::vector<Row> rows;
  for (std::size_t i = 0; i < points.size(); ++i)
    rows.push_back({points[i], map.rows[i].distance, map.certificates[i]});
  return rows;
}

const Primitive egg{"egg", {{1.0, 2.0, 3.0}, {0.9, 1.1}}, {{0.1, 0.2, 0.3}, {1.0, 2.0, 3.0, 4.0}}};
const Primitive soap{"soap", {{2.0, 1.0, 1.5}, {0.3, 1.6}}, {{1.5, 0.5, -0.5}, {0.9, 0.1, 0.2, -0.4}}};

struct Case {
  std::string name;
  Model model;
  double tolerance;
  std::size_t carrying;  ///< leading digits of which each carries the proof
  std::vector<Point> points;
};

class FalsifiedCertificateTest : public testing::TestWithParam<Case> {};

TEST_P(FalsifiedCertificateTest, ProvesNothingFalse) {
  const auto& [name, model, tolerance, carrying, points] = GetParam();
  const Checker check(model);
  const SignedDistance host(model);
  std::array<Tally, digits> tallies;
  for (Row& row : certified_rows(model, points, tolerance)) {
    const auto verdict = [&](const Enclosure& claim) { return check(row.point, claim, row.certificate).verdict; };
    const Enclosure claimed = row.claimed;
    ASSERT_EQ(verdict(claimed), Verdict::proved);
    // The truth lies in the host's enclosure: an end beyond the other side of that is past it.
    const Enclosure truth = host(row.point, 0.0);
    const double beyond_lo = moved(truth.hi, infinity);
    const double beyond_hi = moved(truth.lo, -infinity);
    for (double& number : numbers_of(row.certificate)) {
      const double honest = number;
      for (std::size_t place = 0; place < digits; ++place) {
        number = with_wrong_digit(honest, place);
        const Verdict of_truth = verdict(claimed);
        EXPECT_NE(of_truth, Verdict::refuted) << number;
        EXPECT_NE(verdict({beyond_lo, std::max(claimed.hi, beyond_lo)}), Verdict::proved) << number;
        EXPECT_NE(verdict({std::min(claimed.lo, beyond_hi), beyond_hi}), Verdict::proved) << number;
        ++(of_truth == Verdict::proved ? tallies[place].proved : tallies[place].unproved);
      }
      number = honest;
    }
  }
  // Trailing digits need not matter: any normal proves something, and a bound is second order in its error.
  for (std::size_t place = 0; place < carrying; ++place) EXPECT_EQ(tallies[place].proved, 0U) << "digit " << place;
  fmt::print("{}: digit, rows still proved, no longer proved\n", name);
  for (std::size_t place = 0; place < digits; ++place)
    fmt::print("{:>8}{:>8}{:>8}\n", place + 1, tallies[place].proved, tallies[place].unproved);
}

INSTANTIATE_TEST_SUITE_P(
    Rows, FalsifiedCertificateTest,
    testing::Values(
        Case{"Outside",
             {"", {egg}},
             0.0,
             5,
             {{3.0, 4.0, 5.0}, {-2.0, 1.0, 7.0}, {9.0, -9.0, 9.0}, {0.1, 0.2, 40.0}, {-3.0, 0.5, 0.2}}},
        Case{"Inside", {"", {egg}}, 1e-6, 0, {{0.3, 0.4, 0.5}, {0.1, 0.2, 0.3}, {-0.5, 0.5, 1.0}}},
        Case{"OutsideUnion", {"", {egg, soap}}, 0.0, 0, {{4.0, 4.0, 4.0}, {-3.0, 1.0, -4.0}, {6.0, 0.0, 0.0}}},
        Case{"InsideUnion", {"", {egg, soap}}, 1e-4, 0, {{0.3, 0.4, 0.5}, {1.0, 0.5, 0.0}, {1.5, 0.5, -0.5}}}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace verisq
