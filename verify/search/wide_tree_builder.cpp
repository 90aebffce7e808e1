/// This file builds the tree of wide_tree.hpp.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "verify/search/wide_tree.hpp"

namespace verisq::verify {

/// Splits where the surface area heuristic is least among sixteen bins an axis (Wald 2007), and of all parts of a node
/// the one with the largest box first.
class WideTree::Builder {
 public:
  explicit Builder(WideTree& tree) : tree_(tree), items_(tree.triangles_.size()) {
    for (std::uint32_t n = 0; n < items_.size(); ++n) {
      Item& item = items_[n];
      item.triangle = n;
      for (const Point& corner : tree.triangles_[n]) {
        const auto place = tree.scaled(corner);
        for (std::size_t i = 0; i < 3; ++i) {
          item.box.lower[i] = std::min(item.box.lower[i], below(place[i]));
          item.box.upper[i] = std::max(item.box.upper[i], above(place[i]));
        }
      }
    }
  }

  void build() {
    tree_.nodes_.reserve(items_.size() / 16 + 1);
    tree_.leaves_.reserve(items_.size() / 4 + 1);
    build(std::span(items_), 0);
    tree_.number_of_.resize(items_.size());
    tree_.place_of_.resize(items_.size());
    for (std::uint32_t place = 0; place < items_.size(); ++place) {
      tree_.number_of_[place] = items_[place].triangle;
      tree_.place_of_[items_[place].triangle] = place;
    }
    items_ = {};
    order_triangles();
  }

 private:
  struct Box {
    std::array<float, 3> lower{HUGE_VALF, HUGE_VALF, HUGE_VALF};
    std::array<float, 3> upper{-HUGE_VALF, -HUGE_VALF, -HUGE_VALF};

    void add(const Box& other) {
      for (std::size_t i = 0; i < 3; ++i) {
        lower[i] = std::min(lower[i], other.lower[i]);
        upper[i] = std::max(upper[i], other.upper[i]);
      }
    }
    [[nodiscard]] float middle(std::size_t axis) const { return lower[axis] + upper[axis]; }  // twice, about
    [[nodiscard]] float area() const {
      const float x = upper[0] - lower[0];
      const float y = upper[1] - lower[1];
      const float z = upper[2] - lower[2];
      return x * y + y * z + z * x;
    }
  };
  struct Item {
    Box box;
    std::uint32_t triangle;
  };
  using Items = std::span<Item>;

  static constexpr std::size_t bins = 16;
  struct Bin {
    Box box;
    std::size_t count = 0;
  };
  struct Cut {
    std::size_t axis = 0;
    std::size_t bin = 0;
    float cost = HUGE_VALF;
  };

  /// Scaled coordinates are off by 2^-52 of themselves; a step of binary32 is a good deal more.
  static float below(double x) { return std::nextafter(static_cast<float>(x), -HUGE_VALF); }
  static float above(double x) { return std::nextafter(static_cast<float>(x), HUGE_VALF); }

  static Box box_of(Items items) {
    Box box;
    for (const Item& item : items) box.add(item.box);
    return box;
  }

  static std::size_t bin_of(const Item& item, std::size_t axis, float least, float scale) {
    return std::min(bins - 1, static_cast<std::size_t>(std::max(0.0F, (item.box.middle(axis) - least) * scale)));
  }

  /// The cheapest cut between two of the bins of an axis.
  static void improve(Cut& best, const std::array<Bin, bins>& filled, std::size_t axis) {
    std::array<float, bins> above_cost{};
    Bin sum;
    for (std::size_t b = bins - 1; b > 0; --b) {
      sum.box.add(filled[b].box);
      sum.count += filled[b].count;
      above_cost[b] = sum.count > 0 ? sum.box.area() * static_cast<float>(sum.count) : HUGE_VALF;
    }
    sum = {};
    for (std::size_t b = 1; b < bins; ++b) {
      sum.box.add(filled[b - 1].box);
      sum.count += filled[b - 1].count;
      if (sum.count == 0) continue;
      const float cost = sum.box.area() * static_cast<float>(sum.count) + above_cost[b];
      if (cost < best.cost) best = {axis, b, cost};
    }
  }

  /// Where the second part begins; neither is empty.
  static std::size_t split(Items items, bool by_cost) {
    if (!by_cost) return items.size() / 2;
    std::array<float, 3> least{HUGE_VALF, HUGE_VALF, HUGE_VALF};
    std::array<float, 3> greatest{-HUGE_VALF, -HUGE_VALF, -HUGE_VALF};
    for (const Item& item : items) {
      for (std::size_t i = 0; i < 3; ++i) {
        least[i] = std::min(least[i], item.box.middle(i));
        greatest[i] = std::max(greatest[i], item.box.middle(i));
      }
    }
    Cut best;
    std::array<float, 3> scale{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      scale[axis] = static_cast<float>(bins) / (greatest[axis] - least[axis]);
      if (!(greatest[axis] > least[axis]) || !std::isfinite(scale[axis])) continue;
      std::array<Bin, bins> filled;
      for (const Item& item : items) {
        Bin& bin = filled[bin_of(item, axis, least[axis], scale[axis])];
        bin.box.add(item.box);
        ++bin.count;
      }
      improve(best, filled, axis);
    }
    if (best.bin == 0) return items.size() / 2;
    const auto second = std::partition(items.begin(), items.end(), [&](const Item& item) {
      return bin_of(item, best.axis, least[best.axis], scale[best.axis]) < best.bin;
    });
    return static_cast<std::size_t>(second - items.begin());
  }

  /// Up to eight, in the order of the items.
  static std::vector<Items> parts_of(Items items, std::size_t depth) {
    std::vector<Items> parts{items};
    while (parts.size() < width) {
      std::size_t largest = parts.size();
      float area = -1.0F;
      for (std::size_t i = 0; i < parts.size(); ++i) {
        if (parts[i].size() <= width) continue;
        const float of_this = box_of(parts[i]).area();
        if (of_this > area) {
          area = of_this;
          largest = i;
        }
      }
      if (largest == parts.size()) break;
      const Items whole = parts[largest];
      const std::size_t second = split(whole, depth < deepest_by_cost);
      parts[largest] = whole.first(second);
      parts.insert(parts.begin() + static_cast<std::ptrdiff_t>(largest) + 1, whole.subspan(second));
    }
    return parts;
  }

  std::uint32_t leaf(Items items) {
    Leaf leaf{};
    leaf.first = static_cast<std::uint32_t>(items.data() - items_.data());
    leaf.count = static_cast<std::uint32_t>(items.size());
    for (std::size_t lane = 0; lane < width; ++lane) {
      const Triangle& triangle = tree_.triangles_[items[std::min(lane, items.size() - 1)].triangle];
      for (std::size_t k = 0; k < 3; ++k) {
        const auto place = tree_.scaled(triangle[k]);
        for (std::size_t i = 0; i < 3; ++i) leaf.corner[k][i][lane] = static_cast<float>(place[i]);
      }
    }
    tree_.leaf_of_.insert(tree_.leaf_of_.end(), items.size(), static_cast<std::uint32_t>(tree_.leaves_.size()));
    tree_.leaves_.push_back(leaf);
    return static_cast<std::uint32_t>(tree_.leaves_.size() - 1) | leaf_bit;
  }

  std::uint32_t build(Items items, std::size_t depth) {
    const auto place = static_cast<std::uint32_t>(tree_.nodes_.size());
    tree_.nodes_.emplace_back();
    Node node{};
    for (std::size_t i = 0; i < 3; ++i) {
      node.lower[i].fill(HUGE_VALF);
      node.upper[i].fill(-HUGE_VALF);
    }
    const std::vector<Items> parts = parts_of(items, depth);
    for (std::size_t lane = 0; lane < parts.size(); ++lane) {
      const Box box = box_of(parts[lane]);
      for (std::size_t i = 0; i < 3; ++i) {
        node.lower[i][lane] = box.lower[i];
        node.upper[i][lane] = box.upper[i];
      }
      node.child[lane] = parts[lane].size() <= width ? leaf(parts[lane]) : build(parts[lane], depth + 1);
    }
    tree_.nodes_[place] = node;
    return place;
  }

  /// Along the cycles of the permutation: a second list of triangles would be the largest of all that is in memory.
  void order_triangles() {
    std::vector<Triangle>& triangles = tree_.triangles_;
    std::vector<bool> ordered(triangles.size(), false);
    for (std::uint32_t first = 0; first < triangles.size(); ++first) {
      if (ordered[first]) continue;
      const Triangle kept = triangles[first];
      std::uint32_t place = first;
      for (std::uint32_t from = tree_.number_of_[place]; from != first; from = tree_.number_of_[place]) {
        triangles[place] = triangles[from];
        ordered[place] = true;
        place = from;
      }
      triangles[place] = kept;
      ordered[place] = true;
    }
  }

  WideTree& tree_;
  std::vector<Item> items_;
};

void WideTree::build() {
  Builder(*this).build();
}

}  // namespace verisq::verify
