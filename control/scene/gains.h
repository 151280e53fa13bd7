// Products with the constant matrices of a group.
#pragma once
#include <array>
#include <cstddef>

#include "control/core/capacity.h"
#include "control/plan.h"

namespace hapticd::control {

/// One number per row of a group.
using Rows = std::array<double, kMaxCoordinates>;

/// out += sign * gain * in; nothing for an empty gain.
inline void add_product(const Plan& plan, const Gain& gain, const double* in, double* out,
                        double sign = 1) noexcept {
  const double* value = plan.gains.data() + gain.offset;
  for (std::size_t i = 0; i < gain.rows; ++i) {
    double sum = 0;
    for (std::size_t j = 0; j < gain.columns; ++j) sum += *value++ * in[j];
    out[i] += sign * sum;
  }
}

/// in' gain in, of a square gain.
inline double quadratic(const Plan& plan, const Gain& gain, const double* in) noexcept {
  const double* value = plan.gains.data() + gain.offset;
  double total = 0;
  for (std::size_t i = 0; i < gain.rows; ++i) {
    double sum = 0;
    for (std::size_t j = 0; j < gain.columns; ++j) sum += *value++ * in[j];
    total += in[i] * sum;
  }
  return total;
}

/// Of a group's square gain: the part that maps a vector on contact `from` to one on contact `to`.
inline Vec3 block_times(const Plan& plan, const GroupPlan& group, const Gain& gain,
                        const ContactPlan& to, const ContactPlan& from, const Vec3& v) noexcept {
  Vec3 product;
  for (std::size_t i = 0; i < to.coordinates; ++i) {
    const double* row = plan.gains.data() + gain.offset +
                        std::size_t{to.first_row + i} * group.coordinates + from.first_row;
    double sum = 0;
    for (std::size_t j = 0; j < from.coordinates; ++j) sum += row[j] * v[from.direction[j]];
    product[to.direction[i]] = sum;
  }
  return product;
}

/// The point of a contact with these coordinates [m].
inline Vec3 point_of(const ContactPlan& contact, const double* coordinates) noexcept {
  Vec3 point = contact.fixed;
  for (std::size_t i = 0; i < contact.coordinates; ++i)
    point[contact.direction[i]] = coordinates[i];
  return point;
}

/// A vector on a contact: zero in the directions that it has not.
inline Vec3 vector_of(const ContactPlan& contact, const double* coordinates) noexcept {
  Vec3 v;
  for (std::size_t i = 0; i < contact.coordinates; ++i) v[contact.direction[i]] = coordinates[i];
  return v;
}

inline void put(const ContactPlan& contact, const Vec3& v, double* coordinates) noexcept {
  for (std::size_t i = 0; i < contact.coordinates; ++i) coordinates[i] = v[contact.direction[i]];
}

}  // namespace hapticd::control
