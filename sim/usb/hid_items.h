// Items of a HID report descriptor (HID 1.11, 6.2.2).
#pragma once
#include <cstdint>
#include <initializer_list>
#include <vector>

namespace hapticd::sim::usb {

class HidItems {
 public:
  enum Tag : std::uint8_t {
    input = 0x80,
    output = 0x90,
    feature = 0xb0,
    collection = 0xa0,
    end_collection = 0xc0,
    usage_page = 0x04,
    logical_minimum = 0x14,
    logical_maximum = 0x24,
    physical_minimum = 0x34,
    physical_maximum = 0x44,
    report_size = 0x74,
    report_id = 0x84,
    report_count = 0x94,
    usage = 0x08,
    usage_minimum = 0x18,
    usage_maximum = 0x28,
  };
  enum Main : std::uint8_t { data_array = 0, constant_array = 1, data = 2, constant = 3 };
  enum Collection : std::uint8_t { physical = 0, application = 1, logical = 2 };

  /// In as few bytes as its value takes. Unsigned: as many as keep the sign bit clear, where it counts.
  HidItems& item(Tag tag, std::int64_t value) {
    const bool is_signed = tag == logical_minimum || tag == logical_maximum ||
                           tag == physical_minimum || tag == physical_maximum;
    const int bytes = is_signed ? size_signed(value) : size_unsigned(value);
    bytes_.push_back(static_cast<std::uint8_t>(tag | (bytes == 4 ? 3 : bytes)));
    for (int i = 0; i < bytes; ++i)
      bytes_.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> 8 * i));
    return *this;
  }
  HidItems& open(Collection kind) { return item(collection, kind); }
  HidItems& close() {
    bytes_.push_back(end_collection);
    return *this;
  }
  HidItems& range(std::int64_t least, std::int64_t most) {
    return item(logical_minimum, least).item(logical_maximum, most);
  }
  HidItems& usages(std::initializer_list<std::uint16_t> all) {
    for (const std::uint16_t one : all) item(usage, one);
    return *this;
  }
  /// `count` numbers of `bits`.
  HidItems& fields(Tag main, unsigned bits, std::size_t count, Main kind = data) {
    return item(report_size, bits)
        .item(report_count, static_cast<std::int64_t>(count))
        .item(main, kind);
  }
  const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  static int size_signed(std::int64_t value) {
    if (value >= INT8_MIN && value <= INT8_MAX) return 1;
    return value >= INT16_MIN && value <= INT16_MAX ? 2 : 4;
  }
  static int size_unsigned(std::int64_t value) {
    return value <= UINT8_MAX ? 1 : value <= UINT16_MAX ? 2 : 4;
  }

  std::vector<std::uint8_t> bytes_;
};

}  // namespace hapticd::sim::usb
