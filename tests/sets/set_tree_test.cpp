/// Truth tables: what is said of colours holds for every way in which the gray ones may turn out.
#include "verify/search/set_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "tests/fixtures/large_models.hpp"

namespace verisq::verify {
namespace {

constexpr std::uint32_t primitive_count = 5;

using Membership = std::vector<bool>;  // of a point off all boundaries, in each primitive
using Colours = std::vector<Colour>;

using testing::leaf;

SetExpression random_expression(std::mt19937& random, int depth) {
  const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
  if (depth == 0 || below(4) == 0) return leaf(below(primitive_count));
  SetExpression result;
  result.operation = static_cast<SetOperation>(below(3));
  const std::uint32_t count = 1 + below(3);
  for (std::uint32_t i = 0; i < count; ++i) result.operands.push_back(random_expression(random, depth - 1));
  return result;
}

Model model_of(const SetExpression& expression) {
  Model model;
  model.primitives.resize(primitive_count);
  model.csg = expression;
  return model;
}

bool member(const SetExpression& expression, const Membership& of) {
  if (expression.operands.empty()) return of[expression.primitive];
  const auto is_in = [&](const SetExpression& operand) { return member(operand, of); };
  const std::span operands(expression.operands);
  switch (expression.operation) {
    case SetOperation::unite: return std::ranges::any_of(operands, is_in);
    case SetOperation::intersect: return std::ranges::all_of(operands, is_in);
    case SetOperation::subtract: return is_in(operands.front()) && std::ranges::none_of(operands.subspan(1), is_in);
  }
  return false;
}

bool member(const SetNode& node, const Membership& of) {
  const auto is_in = [&](const SetNode& operand) { return member(operand, of); };
  switch (node.kind) {
    case SetNode::Kind::leaf: return of[node.primitive] == (node.side == Side::inside);
    case SetNode::Kind::union_of: return std::ranges::any_of(node.operands, is_in);
    case SetNode::Kind::intersection_of: return std::ranges::all_of(node.operands, is_in);
  }
  return false;
}

/// All 2^n memberships, or 3^n colourings.
template <class Value>
std::vector<std::vector<Value>> assignments(std::vector<Value> values) {
  std::vector<std::vector<Value>> result{{}};
  for (std::uint32_t i = 0; i < primitive_count; ++i) {
    std::vector<std::vector<Value>> longer;
    for (const std::vector<Value>& start : result) {
      for (const Value value : values) {
        longer.push_back(start);
        longer.back().push_back(value);
      }
    }
    result = std::move(longer);
  }
  return result;
}

bool completes(const Membership& membership, const Colours& colours) {
  for (std::size_t i = 0; i < colours.size(); ++i) {
    if (colours[i] != Colour::gray && membership[i] != (colours[i] == Colour::black)) return false;
  }
  return true;
}

std::size_t size(const SetNode& node) {
  std::size_t sum = 1;
  for (const SetNode& operand : node.operands) sum += size(operand);
  return sum;
}

/// No operator has an operand of its own kind, or fewer than two.
bool is_normal(const SetNode& node) {
  if (node.kind == SetNode::Kind::leaf) return node.operands.empty();
  return node.operands.size() >= 2 && std::ranges::all_of(node.operands, [&](const SetNode& operand) {
           return operand.kind != node.kind && is_normal(operand);
         });
}

TEST(SetTreeTest, NormalFormsAreTheSolidAndItsComplement) {
  std::mt19937 random(1);
  const auto memberships = assignments<bool>({false, true});
  for (int round = 0; round < 300; ++round) {
    const SetExpression expression = random_expression(random, 4);
    const SetNode inside = normal_form(model_of(expression), Side::inside);
    const SetNode outside = normal_form(model_of(expression), Side::outside);
    EXPECT_TRUE(is_normal(inside));
    EXPECT_TRUE(is_normal(outside));
    for (const Membership& of : memberships) {
      ASSERT_EQ(member(inside, of), member(expression, of));
      ASSERT_EQ(member(outside, of), !member(expression, of));
    }
  }
}

TEST(SetTreeTest, WithoutExpressionTheUnionOfAll) {
  Model model;
  model.primitives.resize(primitive_count);
  for (const Membership& of : assignments<bool>({false, true})) {
    EXPECT_EQ(member(normal_form(model, Side::inside), of), std::ranges::count(of, true) > 0);
    EXPECT_EQ(member(normal_form(model, Side::outside), of), std::ranges::count(of, true) == 0);
  }
}

TEST(SetTreeTest, ColoursHoldForEveryCompletion) {
  std::mt19937 random(2);
  const auto memberships = assignments<bool>({false, true});
  const auto colourings = assignments<Colour>({Colour::white, Colour::gray, Colour::black});
  for (int round = 0; round < 60; ++round) {
    const SetNode node =
        normal_form(model_of(random_expression(random, 3)), random() % 2 == 1 ? Side::inside : Side::outside);
    for (const Colours& colours : colourings) {
      const Colour said = colour(node, colours);
      const bool open = std::ranges::count(colours, Colour::gray) > 0;
      ASSERT_TRUE(open || said != Colour::gray);
      if (said == Colour::gray) continue;
      for (const Membership& of : memberships) {
        ASSERT_TRUE(!completes(of, colours) || member(node, of) == (said == Colour::black));
      }
    }
  }
}

TEST(SetTreeTest, SimplifiedTreesAreTheSameSetThere) {
  std::mt19937 random(3);
  const auto memberships = assignments<bool>({false, true});
  const auto colourings = assignments<Colour>({Colour::white, Colour::gray, Colour::black});
  std::size_t shortened = 0;
  for (int round = 0; round < 40; ++round) {
    const SetNode node = normal_form(model_of(random_expression(random, 4)), Side::inside);
    for (const Colours& colours : colourings) {
      if (colour(node, colours) != Colour::gray) continue;
      const SetNode shorter = simplified(node, colours);
      ASSERT_TRUE(is_normal(shorter));
      ASSERT_LE(size(shorter), size(node));
      shortened += size(shorter) < size(node) ? 1 : 0;
      ASSERT_EQ(colour(shorter, colours), Colour::gray);
      for (const Membership& of : memberships) {
        ASSERT_TRUE(!completes(of, colours) || member(shorter, of) == member(node, of));
      }
    }
  }
  EXPECT_GT(shortened, 100U);
}

Model large_model(std::uint32_t primitives, SetExpression tree) {
  Model model;
  model.primitives.resize(primitives);
  model.csg = std::move(tree);
  return model;
}

TEST(SetTreeTest, NestedUnionsBecomeOne) {
  using namespace testing;
  for (const SetExpression& tree : {deep_tree(1000, always_union), deep_tree_of_last_operands(1000, always_union),
                                    balanced_tree(0, 1000, always_union)}) {
    const SetNode node = normal_form(large_model(1000, tree), Side::inside);
    ASSERT_EQ(node.kind, SetNode::Kind::union_of);
    ASSERT_EQ(node.operands.size(), 1000U);
    for (std::uint32_t i = 0; i < 1000; ++i) EXPECT_EQ(node.operands[i].primitive, i) << "in the order of the tree";
  }
}

TEST(SetTreeTest, LargeTreesMeanWhatTheySay) {
  using namespace testing;
  constexpr std::uint32_t deep = 1000;
  constexpr std::uint32_t wide = 10000;
  const std::array trees{deep_tree(deep, in_turn),
                         deep_tree_of_last_operands(deep, in_turn),
                         wide_tree(wide, SetOperation::unite),
                         wide_tree(wide, SetOperation::intersect),
                         wide_tree(wide, SetOperation::subtract),
                         balanced_tree(0, wide, in_turn)};
  std::mt19937 random(4);
  for (const SetExpression& tree : trees) {
    const Model model = large_model(wide, tree);
    const SetNode inside = normal_form(model, Side::inside);
    const SetNode outside = normal_form(model, Side::outside);
    EXPECT_TRUE(is_normal(inside));
    EXPECT_TRUE(is_normal(outside));
    for (int round = 0; round < 20; ++round) {
      // Mostly gray: the first operand that decides must not decide all.
      Colours colours(wide, Colour::gray);
      Membership of(wide);
      for (std::uint32_t i = 0; i < wide; ++i) {
        of[i] = random() % 2 == 0;
        if (random() % 1000 == 0) colours[i] = of[i] ? Colour::black : Colour::white;
      }
      ASSERT_EQ(member(inside, of), member(tree, of));
      ASSERT_EQ(member(outside, of), !member(tree, of));
      if (colour(inside, colours) != Colour::gray) continue;
      const SetNode shorter = simplified(inside, colours);
      EXPECT_TRUE(is_normal(shorter));
      ASSERT_EQ(member(shorter, of), member(tree, of));
    }
  }
}

TEST(SetTreeTest, DecidedOperandsLeaveTheTree) {
  // 0 without 1 and 2, beside 3
  SetExpression difference{.operands = {leaf(0), leaf(1), leaf(2)}, .operation = SetOperation::subtract};
  const SetExpression all{.operands = {difference, leaf(3)}, .operation = SetOperation::unite};
  const SetNode node = normal_form(model_of(all), Side::inside);
  const Colours colours{Colour::black, Colour::gray, Colour::white, Colour::white, Colour::gray};
  const SetNode shorter = simplified(node, colours);
  ASSERT_EQ(shorter.kind, SetNode::Kind::leaf);
  EXPECT_EQ(shorter.primitive, 1U);
  EXPECT_EQ(shorter.side, Side::outside);
}

bool member(const SetTerm& term, const Membership& of) {
  for (std::uint32_t i = 0; i < of.size(); ++i)
    if ((((of[i] ? term.outside : term.inside) >> i) & 1U) != 0) return false;
  return true;
}

TEST(SetTermsTest, HaveTheSamePoints) {
  std::mt19937 random(11);
  for (int n = 0; n < 300; ++n) {
    const Model model = model_of(random_expression(random, 4));
    for (const Side side : {Side::inside, Side::outside}) {
      const SetNode tree = normal_form(model, side);
      const auto terms = terms_of(tree, 1000);
      ASSERT_TRUE(terms);
      for (std::uint32_t bits = 0; bits < 1U << primitive_count; ++bits) {
        Membership of;
        for (std::uint32_t i = 0; i < primitive_count; ++i) of.push_back((bits >> i & 1U) != 0);
        const auto has = [&](const SetTerm& term) { return member(term, of); };
        EXPECT_EQ(std::ranges::any_of(*terms, has), member(tree, of));
      }
    }
  }
}

TEST(SetTermsTest, NoneIsInAnother) {
  const auto leaf_of = [](std::uint32_t i, Side side) { return SetNode{SetNode::Kind::leaf, i, side}; };
  const SetNode a = leaf_of(0, Side::inside);
  const SetNode b = leaf_of(1, Side::outside);
  const SetNode both{SetNode::Kind::intersection_of, 0, Side::inside, {a, b}};
  EXPECT_EQ(terms_of(both, 1), (std::vector<SetTerm>{{1U, 2U}}));
  for (const auto& operands : {std::vector{both, a}, std::vector{a, both}, std::vector{a, both, a}})
    EXPECT_EQ(terms_of({SetNode::Kind::union_of, 0, Side::inside, operands}, 2), (std::vector<SetTerm>{{1U, 0U}}));
}

TEST(SetTermsTest, NothingOfTooManyOrOfPrimitivesWithoutABit) {
  const SetNode late{SetNode::Kind::leaf, 32, Side::inside};
  EXPECT_FALSE(terms_of(late, 10));
  SetNode product{SetNode::Kind::intersection_of, 0, Side::inside, {}};
  for (std::uint32_t i = 0; i < 10; ++i) {
    const SetNode a{SetNode::Kind::leaf, 2 * i, Side::inside};
    const SetNode b{SetNode::Kind::leaf, 2 * i + 1, Side::inside};
    product.operands.push_back({SetNode::Kind::union_of, 0, Side::inside, {a, b}});
  }
  EXPECT_FALSE(terms_of(product, 32));
  EXPECT_EQ(terms_of(product, 1024)->size(), 1024U);
}

/// Every point of the solid lies in one of them; what is removed is not among them.
TEST(CoveringPrimitivesTest, HoldEveryPointOfTheSolid) {
  std::mt19937 random(4);
  for (int round = 0; round < 2000; ++round) {
    const SetExpression expression = random_expression(random, 4);
    const std::vector<std::uint32_t> covering = covering_primitives(model_of(expression));
    EXPECT_FALSE(covering.empty());
    EXPECT_TRUE(std::ranges::is_sorted(covering));
    for (std::uint32_t bits = 0; bits < (1U << primitive_count); ++bits) {
      Membership of(primitive_count);
      for (std::uint32_t i = 0; i < primitive_count; ++i) of[i] = ((bits >> i) & 1U) != 0;
      if (!member(expression, of)) continue;
      EXPECT_TRUE(std::ranges::any_of(covering, [&](std::uint32_t i) { return of[i]; })) << round;
    }
  }
}

TEST(CoveringPrimitivesTest, AreTheFirstOnesOfWhatIsCut) {
  using Indices = std::vector<std::uint32_t>;
  const auto covering = [](const SetExpression& csg) { return covering_primitives(model_of(csg)); };
  Model all = model_of(leaf(0));
  all.csg.reset();
  EXPECT_EQ(covering_primitives(all), (Indices{0, 1, 2, 3, 4}));
  EXPECT_EQ(covering({{leaf(2), leaf(1)}, SetOperation::unite}), (Indices{1, 2}));
  EXPECT_EQ(covering({{leaf(2), leaf(1)}, SetOperation::intersect}), (Indices{2}));
  EXPECT_EQ(covering({{leaf(2), leaf(1), leaf(0)}, SetOperation::subtract}), (Indices{2}));
  const SetExpression bored{{leaf(3), {{leaf(4), leaf(1)}, SetOperation::subtract}}, SetOperation::subtract};
  EXPECT_EQ(covering({{bored, leaf(0)}, SetOperation::unite}), (Indices{0, 3}));
}

}  // namespace
}  // namespace verisq::verify
