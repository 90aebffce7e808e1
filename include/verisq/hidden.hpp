/// The state of a class that its header does not show.
#pragma once

#include <memory>
#include <utility>

namespace verisq {

/// Owns a state, or none. Moved, not copied: so is a class that has one, which need not declare how.
template <class State>
class Hidden {
 public:
  Hidden() = default;

  [[nodiscard]] State* get() const { return owner_.get(); }
  [[nodiscard]] State* operator->() const { return owner_.get(); }
  [[nodiscard]] State& operator*() const { return *owner_; }
  explicit operator bool() const { return owner_ != nullptr; }

 private:
  // Knows how to delete a state where its definition is not known.
  using Owner = std::unique_ptr<State, void (*)(State*)>;

  explicit Hidden(Owner owner) : owner_(std::move(owner)) {}

  template <class AnyState, class... Arguments>
  friend Hidden<AnyState> hidden(Arguments&&... arguments);

  Owner owner_{nullptr, nullptr};
};

/// A state made from its arguments, where it is defined: the only way to make one.
template <class State, class... Arguments>
[[nodiscard]] Hidden<State> hidden(Arguments&&... arguments) {
  return Hidden<State>({new State(std::forward<Arguments>(arguments)...), [](State* state) { delete state; }});
}

}  // namespace verisq
