#include "sim/can/cia402_objects.h"

#include "sim/can/cia402_wire.h"

namespace hapticd::sim::can {
namespace {

constexpr std::uint32_t kPdoOff = 0x80000000;

bool is_pdo_id(std::uint32_t index, std::uint32_t sub) {
  return sub == 1 && ((index & ~3U) == 0x1400 || (index & ~3U) == 0x1800);
}

bool is_mapping(std::uint32_t index) {
  return (index & ~3U) == 0x1600 || (index & ~3U) == 0x1a00;
}

}  // namespace

Cia402Objects::Cia402Objects(std::uint8_t node) {
  for (std::uint32_t pdo = 0; pdo < kPdos; ++pdo) {
    const std::uint32_t off = pdo == 0 ? 0 : kPdoOff;
    add_pdo(0x1400 + pdo, 0x1600 + pdo, off | (0x200 + 0x100 * pdo + node), 0x60400010);
    add_pdo(0x1800 + pdo, 0x1a00 + pdo, off | (0x180 + 0x100 * pdo + node), 0x60410010);
  }
}

void Cia402Objects::add_pdo(std::uint32_t communication, std::uint32_t mapping, std::uint32_t id,
                            std::uint32_t word) {
  add(object_key(communication, 0), {.size = 1, .value = 2});
  add(object_key(communication, 1), {.size = 4, .writable = true, .value = id});
  add(object_key(communication, 2), {.size = 1, .writable = true, .value = 255});
  add(object_key(mapping, 0), {.size = 1, .writable = true, .value = 1});
  for (std::uint32_t sub = 1; sub <= kMapped; ++sub)
    add(object_key(mapping, sub), {.size = 4, .writable = true, .value = sub == 1 ? word : 0});
}

const Cia402Object* Cia402Objects::find(std::uint32_t key) const {
  const auto found = objects_.find(key);
  return found == objects_.end() ? nullptr : &found->second;
}

bool Cia402Objects::has_index(std::uint32_t index) const {
  const auto first = objects_.lower_bound(object_key(index));
  return first != objects_.end() && first->first >> 8 == index;
}

void Cia402Objects::set(std::uint32_t key, std::uint32_t value) {
  Cia402Object& object = objects_.at(key);
  object.value = value & (0xffffffffU >> (8 * (4 - object.size)));
}

std::uint32_t Cia402Objects::problem(std::uint32_t key, std::uint32_t value,
                                     std::uint8_t size) const {
  const Cia402Object* object = find(key);
  if (object == nullptr) return has_index(key >> 8) ? sdo::kNoSubIndex : sdo::kNoObject;
  if (!object->writable) return sdo::kReadOnly;
  if (size > object->size) return sdo::kTooLong;
  if (size != 0 && size < object->size) return sdo::kTooShort;
  return mapping_problem(key, value);
}

// CiA 301, "PDO mapping": off first, then count 0, entries, count, on.
std::uint32_t Cia402Objects::mapping_problem(std::uint32_t key, std::uint32_t value) const {
  const std::uint32_t index = key >> 8, sub = key & 0xff;
  if (is_pdo_id(index, sub)) {
    const bool stays_on = ((*this)[key] & kPdoOff) == 0 && (value & kPdoOff) == 0;
    return stays_on && value != (*this)[key] ? sdo::kWrongState : 0;
  }
  if (!is_mapping(index)) return 0;
  if (((*this)[object_key(index - 0x200, 1)] & kPdoOff) == 0) return sdo::kWrongState;
  if (sub == 0) return count_problem(index, value);
  if ((*this)[object_key(index)] != 0) return sdo::kWrongState;
  return entry_problem(value, index >= 0x1a00);
}

std::uint32_t Cia402Objects::entry_problem(std::uint32_t entry, bool sent) const {
  const Cia402Object* object = find(entry >> 8);
  if (object == nullptr) return sdo::kNoObject;
  const bool fits = (entry & 0xff) == 8U * object->size;
  return fits && (sent ? object->tpdo : object->rpdo) ? 0 : sdo::kNotMappable;
}

std::uint32_t Cia402Objects::count_problem(std::uint32_t mapping, std::uint32_t count) const {
  if (count > kMapped) return sdo::kTooManyMapped;
  std::uint32_t bits = 0;
  for (std::uint32_t sub = 1; sub <= count; ++sub) {
    const std::uint32_t entry = (*this)[object_key(mapping, sub)];
    if (const std::uint32_t wrong = entry_problem(entry, mapping >= 0x1a00)) return wrong;
    bits += entry & 0xff;
  }
  return bits > 64 ? sdo::kTooManyMapped : 0;
}

std::size_t Cia402Objects::Pdo::bits() const {
  std::size_t sum = 0;
  for (const std::uint32_t entry : mapped) sum += entry & 0xff;
  return sum;
}

Cia402Objects::Pdo Cia402Objects::pdo_at(std::uint32_t communication, std::uint32_t mapping) const {
  const std::uint32_t id = (*this)[object_key(communication, 1)];
  Pdo pdo{.enabled = (id & kPdoOff) == 0,
          .id = id & CAN_SFF_MASK,
          .type = static_cast<std::uint8_t>((*this)[object_key(communication, 2)])};
  for (std::uint32_t sub = 1; sub <= (*this)[object_key(mapping)]; ++sub)
    pdo.mapped.push_back((*this)[object_key(mapping, sub)]);
  return pdo;
}

}  // namespace hapticd::sim::can
