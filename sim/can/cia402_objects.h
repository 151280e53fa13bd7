// The object dictionary of an emulated CiA 402 drive.
#pragma once
#include <cstdint>
#include <map>
#include <vector>

namespace hapticd::sim::can {

/// Index and sub-index, as a PDO mapping has them in its upper 24 bits.
constexpr std::uint32_t object_key(std::uint32_t index, std::uint32_t sub = 0) {
  return index << 8 | sub;
}

struct Cia402Object {
  std::uint8_t size = 4;  ///< bytes
  bool writable = false;
  bool rpdo = false, tpdo = false;  ///< can be mapped
  std::uint32_t value = 0;
};

class Cia402Objects {
 public:
  static constexpr std::uint32_t kPdos = 4, kMapped = 8;

  Cia402Objects() = default;
  /// With the default PDOs of `node`, all with the control or status word only.
  explicit Cia402Objects(std::uint8_t node);

  void add(std::uint32_t key, const Cia402Object& object) { objects_[key] = object; }
  const Cia402Object* find(std::uint32_t key) const;
  bool has_index(std::uint32_t index) const;
  /// Of an object that is there.
  std::uint32_t operator[](std::uint32_t key) const { return objects_.at(key).value; }
  /// Of an object that is there; cut to its size.
  void set(std::uint32_t key, std::uint32_t value);

  /// What is wrong with a write over SDO: an abort code; 0: nothing. `size` 0: not said.
  std::uint32_t problem(std::uint32_t key, std::uint32_t value, std::uint8_t size) const;

  /// Number `pdo` (from 0) of those that are received or sent.
  struct Pdo {
    bool enabled = false;
    std::uint32_t id = 0;
    std::uint8_t type = 0;
    std::vector<std::uint32_t> mapped{};  ///< as in the dictionary: key << 8 | bits
    std::size_t bits() const;
  };
  Pdo rpdo(std::uint32_t pdo) const { return pdo_at(0x1400 + pdo, 0x1600 + pdo); }
  Pdo tpdo(std::uint32_t pdo) const { return pdo_at(0x1800 + pdo, 0x1a00 + pdo); }

 private:
  void add_pdo(std::uint32_t communication, std::uint32_t mapping, std::uint32_t id,
               std::uint32_t word);
  Pdo pdo_at(std::uint32_t communication, std::uint32_t mapping) const;
  std::uint32_t mapping_problem(std::uint32_t key, std::uint32_t value) const;
  std::uint32_t entry_problem(std::uint32_t entry, bool sent) const;
  std::uint32_t count_problem(std::uint32_t mapping, std::uint32_t count) const;

  std::map<std::uint32_t, Cia402Object> objects_;
};

}  // namespace hapticd::sim::can
