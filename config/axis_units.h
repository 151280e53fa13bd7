// Keys that come in a linear and in a rotary form: the one that fits the axis is taken, the other
// is refused.
#pragma once
#include <limits>
#include <optional>
#include <string>

#include "config/compilation.h"
#include "config/schema_axis.h"

namespace hapticd::config {

/// What stands for a value that has been refused already: no comparison with it is true, so nothing
/// is refused twice.
inline constexpr double kRefused = std::numeric_limits<double>::quiet_NaN();

template <class T>
struct Form {
  const char* key;
  const std::optional<T>& value;
};
template <class T>
Form(const char*, const std::optional<T>&) -> Form<T>;

/// The keys of one map of an axis (its encoder, its model, ...).
class AxisUnits {
 public:
  /// `path` is that of the map: "devices[0].axes[1].encoder".
  AxisUnits(Compilation& compilation, AxisKind kind, std::string path)
      : compilation_(compilation), rotary_(kind == AxisKind::rotary), path_(std::move(path)) {}

  /// Nothing if it is left out.
  template <class T>
  std::optional<T> given(Form<T> linear, Form<T> rotary) const {
    const Form<T>& wanted = rotary_ ? rotary : linear;
    const Form<T>& other = rotary_ ? linear : rotary;
    if (other.value) refuse_other(other.key, wanted.key);
    return wanted.value;
  }
  double optional(Form<double> linear, Form<double> rotary, double otherwise) const {
    return given(linear, rotary).value_or(otherwise);
  }
  /// kRefused if it is left out.
  double required(Form<double> linear, Form<double> rotary) const {
    const std::optional<double> value = given(linear, rotary);
    if (!value && !linear.value && !rotary.value) refuse_missing(key(linear, rotary));
    return value.value_or(kRefused);
  }
  /// The name of the form that fits.
  template <class T>
  const char* key(Form<T> linear, Form<T> rotary) const {
    return rotary_ ? rotary.key : linear.key;
  }
  std::string path_of(const char* key) const { return path_ + "." + key; }
  void refuse(const char* key, std::string message) const {
    compilation_.refuse(path_of(key), std::move(message));
  }
  bool rotary() const { return rotary_; }

 private:
  void refuse_other(const char* found, const char* wanted) const {
    refuse(found, std::string("this axis is ") + (rotary_ ? "rotary" : "linear") + ": expected " +
                      wanted + " instead");
  }
  void refuse_missing(const char* wanted) const {
    refuse(wanted, std::string("missing; expected here: ") + wanted + ", as the axis is " +
                       (rotary_ ? "rotary" : "linear"));
  }

  Compilation& compilation_;
  bool rotary_;
  std::string path_;
};

}  // namespace hapticd::config
