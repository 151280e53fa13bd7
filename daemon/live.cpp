#include "daemon/live.h"

#include <bit>
#include <cstring>

namespace hapticd::daemon {
namespace {

template <class T>
T read(const std::byte* record, std::size_t offset) {
  T value;
  std::memcpy(&value, record + offset, sizeof value);
  return value;
}

std::vector<double> doubles(const std::byte* record, control::RecordArray array) {
  std::vector<double> values;
  for (std::size_t i = 0; i < array.count; ++i)
    values.push_back(read<double>(record, array.offset + i * sizeof(double)));
  return values;
}

}  // namespace

void Live::begin(const control::RecordLayout& layout) {
  const std::lock_guard lock(mutex_);
  layout_ = layout;
  record_.assign(layout.bytes, std::byte{});
  known_ = false;
  while (ages_.size() < layout.age_ns.count) ages_.emplace_back();
}

void Live::add(const std::byte* record) {
  const std::lock_guard lock(mutex_);
  std::memcpy(record_.data(), record, record_.size());
  known_ = true;
  for (std::size_t i = 0; i < layout_.age_ns.count; ++i) {
    const auto freshness = static_cast<Freshness>(record[layout_.freshness.offset + i]);
    if (freshness != Freshness::missing)
      ages_[i].add(read<std::int64_t>(record, layout_.age_ns.offset + 8 * i));
  }
  auto bits = read<std::uint32_t>(record, offsetof(control::RecordHeader, limits));
  for (; bits != 0; bits &= bits - 1)
    ++limit_ticks_[static_cast<std::size_t>(std::countr_zero(bits))];
}

LiveView Live::view() const {
  const std::lock_guard lock(mutex_);
  LiveView view{.known = known_, .limit_ticks = limit_ticks_};
  if (!known_) return view;
  const std::byte* record = record_.data();
  for (const Histogram& ages : ages_) {
    view.ages.push_back({.samples = ages.count(),
                         .p50_s = 1e-9 * static_cast<double>(ages.percentile_ns(0.5)),
                         .p999_s = 1e-9 * static_cast<double>(ages.percentile_ns(0.999)),
                         .max_s = 1e-9 * static_cast<double>(ages.max_ns())});
  }
  view.work_J = doubles(record, layout_.work);
  view.fade = doubles(record, layout_.fade);
  for (std::size_t i = 0; i < layout_.homed.count; ++i)
    view.homed.push_back(record[layout_.homed.offset + i] != std::byte{0});
  for (std::size_t i = 0; i < layout_.aux.count; ++i) {
    view.digital.push_back(
        read<std::uint32_t>(record, layout_.aux.offset + i * sizeof(Aux) + offsetof(Aux, digital)));
  }
  return view;
}

}  // namespace hapticd::daemon
