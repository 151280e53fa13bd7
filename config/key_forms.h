// Keys that come in a linear and in a rotary form, for config/describe.h.
#pragma once
#include "config/key.h"

namespace hapticd::config {

/// One form of a key that has a linear and a rotary one.
template <class T>
struct FormOf {
  const char* name;
  T& field;
  const char* unit;
};
template <class T>
FormOf(const char*, T&, const char*) -> FormOf<T>;

/// Both forms: the same range, in their units.
template <class V, class T>
void both(V& v, FormOf<T> linear, FormOf<T> rotary, Key key) {
  key.unit = linear.unit;
  v.optional(linear.name, linear.field, key);
  key.unit = rotary.unit;
  v.optional(rotary.name, rotary.field, key);
}

}  // namespace hapticd::config
