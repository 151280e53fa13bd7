// Which sort of value a field of a config is; for the visitors of config/describe.h.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "config/schema_coupling.h"

namespace hapticd::config {

template <class T>
inline constexpr bool kIsOptional = false;
template <class T>
inline constexpr bool kIsOptional<std::optional<T>> = true;

template <class T>
inline constexpr bool kIsVector = false;
template <class T>
inline constexpr bool kIsVector<std::vector<T>> = true;

template <class T>
inline constexpr bool kIsArray = false;
template <class T, std::size_t N>
inline constexpr bool kIsArray<std::array<T, N>> = true;

template <class T>
inline constexpr bool kIsVariant = false;
template <class... T>
inline constexpr bool kIsVariant<std::variant<T...>> = true;

template <class T>
inline constexpr bool kIsText = std::is_same_v<T, std::string>;
template <class T>
inline constexpr bool kIsBool = std::is_same_v<T, bool>;
template <class T>
inline constexpr bool kIsWhole = std::is_integral_v<T> && !kIsBool<T>;
template <class T>
inline constexpr bool kIsReal = std::is_floating_point_v<T>;

template <class T>
inline constexpr bool kIsGains = std::is_same_v<T, Gains>;

/// A struct that has a describe().
template <class T>
inline constexpr bool kIsStruct = std::is_class_v<T> && !kIsText<T> && !kIsOptional<T> &&
                                  !kIsVector<T> && !kIsArray<T> && !kIsVariant<T> && !kIsGains<T>;

/// Calls `action(Alternative{})` for every alternative of a variant type.
template <class Variant, class Action>
void for_each_alternative(Action&& action) {
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (action(std::variant_alternative_t<I, Variant>{}), ...);
  }
  (std::make_index_sequence<std::variant_size_v<Variant>>{});
}

}  // namespace hapticd::config
