/// Items that are done with, kept for the memory that they hold: what is filled again needs no new pages.
#pragma once

#include <cstddef>
#include <mutex>
#include <utility>
#include <vector>

namespace verisq {

/// Any number of threads may use it at once.
template <class Item>
class SpareItems {
 public:
  /// No more than `most` are kept.
  explicit SpareItems(std::size_t most) : most_(most) {}

  /// One of those that were given back, as it was; a new one where there is none.
  [[nodiscard]] Item take() {
    const std::lock_guard lock(mutex_);
    if (items_.empty()) return {};
    Item item(std::move(items_.back()));  // the last one: a cache may still hold it
    items_.pop_back();
    return item;
  }

  void give_back(Item item) {
    const std::lock_guard lock(mutex_);
    if (items_.size() < most_) items_.push_back(std::move(item));
  }

 private:
  std::size_t most_;
  std::mutex mutex_;
  std::vector<Item> items_;
};

}  // namespace verisq
