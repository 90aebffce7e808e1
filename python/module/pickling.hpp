/// How results are pickled and copied: as tuples of what their structs are made of, bit for bit.
#pragma once

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <concepts>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>
#include <verisq/version.hpp>

namespace verisq::python {

/// Converts to any member of a struct, so that the compiler can count how many a struct takes.
struct AnyMember {
  template <class T>
  operator T() const;  // declared alone: only types are asked for
};

template <class T, std::size_t... I>
constexpr bool takes(std::index_sequence<I...> /*members*/) {
  return requires {
    T{(static_cast<void>(I), AnyMember{})...};
  };
}

inline constexpr std::size_t most_members = 16;

/// The largest number of members that an aggregate takes: all of its own. One more than the most where it has more.
template <class T, std::size_t most = most_members + 1>
constexpr std::size_t count_members() {
  if constexpr (most == 0 || takes<T>(std::make_index_sequence<most>())) {
    return most;
  } else {
    return count_members<T, most - 1>();
  }
}

template <class T>
inline constexpr std::size_t member_count = count_members<T>();

/// Structs, which are pickled member by member.
template <class T>
concept HasMembers = std::is_class_v<T> && std::is_aggregate_v<T>;

/// References to all members, in their order.
template <HasMembers T>
auto members(const T& value) {
  constexpr std::size_t count = member_count<T>;
  static_assert(count <= most_members);
  if constexpr (count == 1) {
    const auto& [a] = value;
    return std::tie(a);
  } else if constexpr (count == 2) {
    const auto& [a, b] = value;
    return std::tie(a, b);
  } else if constexpr (count == 3) {
    const auto& [a, b, c] = value;
    return std::tie(a, b, c);
  } else if constexpr (count == 4) {
    const auto& [a, b, c, d] = value;
    return std::tie(a, b, c, d);
  } else if constexpr (count == 5) {
    const auto& [a, b, c, d, e] = value;
    return std::tie(a, b, c, d, e);
  } else if constexpr (count == 6) {
    const auto& [a, b, c, d, e, f] = value;
    return std::tie(a, b, c, d, e, f);
  } else if constexpr (count == 7) {
    const auto& [a, b, c, d, e, f, g] = value;
    return std::tie(a, b, c, d, e, f, g);
  } else if constexpr (count == 8) {
    const auto& [a, b, c, d, e, f, g, h] = value;
    return std::tie(a, b, c, d, e, f, g, h);
  } else if constexpr (count == 9) {
    const auto& [a, b, c, d, e, f, g, h, i] = value;
    return std::tie(a, b, c, d, e, f, g, h, i);
  } else if constexpr (count == 10) {
    const auto& [a, b, c, d, e, f, g, h, i, j] = value;
    return std::tie(a, b, c, d, e, f, g, h, i, j);
  } else if constexpr (count == 11) {
    const auto& [a, b, c, d, e, f, g, h, i, j, k] = value;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k);
  } else if constexpr (count == 12) {
    const auto& [a, b, c, d, e, f, g, h, i, j, k, l] = value;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l);
  } else if constexpr (count == 13) {
    const auto& [a, b, c, d, e, f, g, h, i, j, k, l, m] = value;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m);
  } else if constexpr (count == 14) {
    const auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n] = value;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n);
  } else if constexpr (count == 15) {
    const auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o] = value;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o);
  } else {
    const auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p] = value;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p);
  }
}

template <class T>
concept Enumeration = std::is_enum_v<T>;

/// Between a T and what stands for it in a pickle. This one: numbers, texts, and classes of the module.
template <class T>
struct Packing {
  static pybind11::object packed(const T& value) { return pybind11::cast(value); }
  static T unpacked(const pybind11::handle& state) { return state.cast<T>(); }
};

template <class T>
pybind11::object packed(const T& value) {
  return Packing<T>::packed(value);
}

template <class T>
T unpacked(const pybind11::handle& state) {
  return Packing<T>::unpacked(state);
}

template <std::derived_from<pybind11::object> T>
struct Packing<T> {
  static pybind11::object packed(const T& value) { return value; }
  static T unpacked(const pybind11::handle& state) { return state.cast<T>(); }
};

template <Enumeration T>
struct Packing<T> {
  static pybind11::object packed(T value) { return pybind11::int_(static_cast<int>(value)); }
  static T unpacked(const pybind11::handle& state) { return static_cast<T>(state.cast<int>()); }
};

template <HasMembers T>
struct Packing<T> {
  static pybind11::object packed(const T& value) {
    return std::apply([](const auto&... all) { return pybind11::make_tuple(python::packed(all)...); }, members(value));
  }

  static T unpacked(const pybind11::handle& state) {
    const auto parts = state.cast<pybind11::tuple>();
    if (parts.size() != member_count<T>) throw pybind11::value_error("pickled by another build of verisq");
    return of(parts, std::make_index_sequence<member_count<T>>());
  }

 private:
  using Tied = decltype(members(std::declval<const T&>()));

  template <std::size_t... I>
  static T of(const pybind11::tuple& parts, std::index_sequence<I...> /*members*/) {
    return T{python::unpacked<std::remove_cvref_t<std::tuple_element_t<I, Tied>>>(parts[I])...};
  }
};

template <class T>
struct Packing<std::vector<T>> {
  static pybind11::object packed(const std::vector<T>& values) {
    pybind11::tuple result(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) result[i] = python::packed<T>(values[i]);
    return result;
  }

  static std::vector<T> unpacked(const pybind11::handle& state) {
    std::vector<T> result;
    for (const pybind11::handle& each : state.cast<pybind11::tuple>()) result.push_back(python::unpacked<T>(each));
    return result;
  }
};

template <class T, std::size_t N>
struct Packing<std::array<T, N>> {
  static pybind11::object packed(const std::array<T, N>& values) {
    return Packing<std::vector<T>>::packed(std::vector<T>(values.begin(), values.end()));
  }

  static std::array<T, N> unpacked(const pybind11::handle& state) {
    const auto parts = state.cast<pybind11::tuple>();
    std::array<T, N> result{};
    for (std::size_t i = 0; i < N; ++i) result[i] = python::unpacked<T>(parts[i]);
    return result;
  }
};

template <class T>
struct Packing<std::optional<T>> {
  static pybind11::object packed(const std::optional<T>& value) {
    return value ? python::packed(*value) : pybind11::none();
  }

  static std::optional<T> unpacked(const pybind11::handle& state) {
    if (state.is_none()) return std::nullopt;
    return python::unpacked<T>(state);
  }
};

template <class T>
struct Packing<std::shared_ptr<const T>> {
  static pybind11::object packed(const std::shared_ptr<const T>& value) {
    return value ? python::packed(*value) : pybind11::none();
  }

  static std::shared_ptr<const T> unpacked(const pybind11::handle& state) {
    if (state.is_none()) return nullptr;
    return std::make_shared<const T>(python::unpacked<T>(state));
  }
};

/// What a class needs for pickle, copy and multiprocessing: `.def(pickled<T>())`. Raises ValueError for what another
/// version of verisq pickled, whose results may be made of other members.
template <HasMembers T>
auto pickled() {
  return pybind11::pickle(
      [](const T& self) { return pybind11::make_tuple(VERISQ_VERSION, packed(self)); },
      [](const pybind11::tuple& state) {
        const auto version = state[0].cast<std::string>();
        if (version != VERISQ_VERSION)
          throw pybind11::value_error(fmt::format("pickled by verisq {}, this is {}", version, VERISQ_VERSION));
        return unpacked<T>(state[1]);
      });
}

}  // namespace verisq::python
