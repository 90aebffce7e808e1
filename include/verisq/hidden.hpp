/// The state of a class that its header does not show.
#pragma once

#include <memory>
#include <utility>

namespace verisq {

/// Deletes a state where its header is not known, by the function that knew it.
template <class State>
struct Forget {
  void (*forget)(State*) = nullptr;

  void operator()(State* state) const { forget(state); }
};

/// Moved, not copied. So is a class that has one, which need not declare how.
template <class State>
using Hidden = std::unique_ptr<State, Forget<State>>;

/// A state made from its arguments, where it is defined.
template <class State, class... Arguments>
[[nodiscard]] Hidden<State> hidden(Arguments&&... arguments) {
  return {new State(std::forward<Arguments>(arguments)...), {[](State* state) { delete state; }}};
}

}  // namespace verisq
