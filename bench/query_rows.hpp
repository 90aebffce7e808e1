/// Rows that answer many queries of one kind (points, pairs, triangles) about one object, unverified or with
/// enclosures.
#pragma once

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <span>
#include <string_view>
#include <vector>
#include <verisq/enclosure.hpp>

#include "bench/row_counters.hpp"

namespace verisq::bench {

/// What a tool answers where it fails; such queries are counted, and left out of errors and widths.
inline constexpr double no_answer = std::numeric_limits<double>::quiet_NaN();
inline constexpr Enclosure no_enclosure{no_answer, no_answer};

/// Must outlive its rows.
template <class Query>
struct Queries {
  std::string_view kind;    ///< "point", "pair", "triangle"
  std::string_view object;  ///< of Table 5 or 6
  double tolerance;         ///< enclosures at most this wide count as verified
  std::vector<Query> all;
  std::size_t judged;  ///< so many answers, from the first, are compared with `judge`
  std::function<std::vector<Enclosure>(std::span<const Query>)> judge;
};

namespace rows {

[[nodiscard]] inline bool disjoint(const Enclosure& a, const Enclosure& b) {
  return a.lo > b.hi || b.lo > a.hi;
}

inline void set_counts(benchmark::State& state, std::size_t queries, std::ptrdiff_t failures) {
  set_rate(state, "queries_per_second", queries);
  state.counters["queries"] = static_cast<double>(queries);
  state.counters["failures"] = static_cast<double>(failures);
}

}  // namespace rows

/// The row "tool/kind/object": `prepare()` makes a function from a query to a distance or `no_answer`, which answers
/// the first `count` queries one by one.
template <class Query, class Prepare>
void add_unverified_row(std::string_view tool, const Queries<Query>& queries, std::size_t count, Prepare prepare) {
  add_row(tool, queries.kind, queries.object, [&queries, count, prepare](benchmark::State& state) {
    auto answer = prepare();
    const auto asked = std::span(queries.all).first(count);
    std::vector<double> answers(count);
    for (auto _ : state) std::ranges::transform(asked, answers.begin(), std::ref(answer));
    rows::set_counts(state, count, std::ranges::count_if(answers, [](double x) { return std::isnan(x); }));
    const std::size_t judged = std::min(count, queries.judged);
    set_errors(state, std::span(answers).first(judged), queries.judge(asked.first(judged)));
  });
}

/// The row "tool/kind_verified/object": `prepare()` makes a function from a span of queries to a vector with an
/// enclosure for each. Ends in an error where an enclosure contradicts the judge's: one of them is wrong.
template <class Query, class Prepare>
void add_verified_row(std::string_view tool, const Queries<Query>& queries, std::size_t count, Prepare prepare) {
  const std::string kind = std::string(queries.kind) + "_verified";
  add_row(tool, kind, queries.object, [&queries, count, prepare](benchmark::State& state) {
    auto enclose = prepare();
    const auto asked = std::span(queries.all).first(count);
    std::vector<Enclosure> enclosures;
    for (auto _ : state) enclosures = enclose(asked);
    const std::size_t judged = std::min(count, queries.judged);
    const std::vector<Enclosure> truth = queries.judge(asked.first(judged));
    for (std::size_t i = 0; i < judged; ++i)
      if (rows::disjoint(enclosures[i], truth[i])) return state.SkipWithError("an enclosure contradicts the judge's");
    const auto failures = std::erase_if(enclosures, [](const Enclosure& e) { return std::isnan(e.lo); });
    rows::set_counts(state, count, static_cast<std::ptrdiff_t>(failures));
    if (!enclosures.empty()) set_widths(state, enclosures, queries.tolerance);
  });
}

/// Lifts a function from a query to its enclosure to one from a span to a vector.
template <class Query, class Enclose>
[[nodiscard]] auto one_by_one(Enclose enclose) {
  return [enclose = std::move(enclose)](std::span<const Query> queries) mutable {
    std::vector<Enclosure> enclosures;
    enclosures.reserve(queries.size());
    for (const Query& query : queries) enclosures.push_back(enclose(query));
    return enclosures;
  };
}

/// FCL's -1, in the words of these rows.
[[nodiscard]] inline double answer_of_fcl(double distance) {
  return distance < 0.0 ? no_answer : distance;
}

}  // namespace verisq::bench
