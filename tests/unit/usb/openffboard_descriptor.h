// The report descriptor of an OpenFFBoard as far as the driver looks at it: the reports, their lengths, their usages.
#pragma once
#include <cstdint>
#include <vector>

namespace hapticd::hid::test {

struct BoardBuild {
  int axes = 1;           ///< with force
  bool wide = false;      ///< their positions have 32 bits
  std::int32_t most = 0;  ///< of a wide position; 0: all of its bits
  std::size_t offsets =
      1;  ///< type specific ones of 16 bits at the end of Set Effect, for each axis
};

/// Short items, one after the other.
class DescriptorText {
 public:
  DescriptorText& item(std::uint8_t tag, std::uint32_t value, int bytes) {
    constexpr std::uint8_t kSizes[] = {0, 1, 2, 0, 3};
    text_.push_back(static_cast<std::uint8_t>(tag | kSizes[bytes]));
    for (int i = 0; i < bytes; ++i, value >>= 8) text_.push_back(static_cast<std::uint8_t>(value));
    return *this;
  }
  DescriptorText& page(std::uint32_t page) { return item(0x04, page, 2); }
  DescriptorText& usage(std::uint32_t usage) { return item(0x08, usage, 1); }
  DescriptorText& id(std::uint32_t id) { return item(0x84, id, 1); }
  DescriptorText& range(std::int32_t least, std::int32_t most) {
    return item(0x14, static_cast<std::uint32_t>(least), 4)
        .item(0x24, static_cast<std::uint32_t>(most), 4);
  }
  DescriptorText& fields(std::uint8_t kind, std::uint32_t bits, std::uint32_t count) {
    return item(0x74, bits, 1).item(0x94, count, 1).item(kind, 2, 1);
  }
  DescriptorText& open(std::uint32_t type) { return item(0xa0, type, 1); }
  DescriptorText& close() { return item(0xc0, 0, 0); }
  const std::vector<std::uint8_t>& text() const { return text_; }

 private:
  std::vector<std::uint8_t> text_;
};

inline std::vector<std::uint8_t> board_descriptor(const BoardBuild& build) {
  constexpr std::uint8_t kInput = 0x80, kOutput = 0x90, kFeature = 0xb0;
  const auto axes = static_cast<std::uint32_t>(build.axes);
  DescriptorText text;
  text.page(1).usage(4).open(1).id(1);
  text.page(9).item(0x18, 1, 1).item(0x28, 64, 1).range(0, 1).fields(kInput, 1, 64);
  text.page(1);
  std::uint32_t wide = 0;
  if (build.wide) {
    for (; wide < axes; ++wide) text.usage(0x30 + wide);
    const std::int32_t most = build.most != 0 ? build.most : 0x7fffffff;
    text.range(-most, most).fields(kInput, 32, axes);
  }
  for (const std::uint32_t usage : {0x30U, 0x31U, 0x32U, 0x33U, 0x34U, 0x35U, 0x37U, 0x36U})
    if (usage >= 0x30 + wide) text.usage(usage);
  text.range(-32767, 32767).fields(kInput, 16, 8 - wide);
  text.page(0xff00).usage(0).open(1).id(0xa1).range(0, 4);
  text.usage(1).fields(kOutput, 8, 24).usage(1).fields(kInput, 8, 24).close();
  text.page(15).usage(0x92).open(2).id(2).range(0, 1);
  for (const std::uint32_t usage : {0x9fU, 0xa0U, 0xa4U, 0xa6U, 0x94U}) text.usage(usage);
  text.fields(kInput, 1, 5).item(0x94, 3, 1).item(kInput, 3, 1).close();
  text.usage(0x21)
      .open(2)
      .id(1)
      .usage(0x22)
      .fields(kOutput, 8, 1)
      .usage(0x25)
      .fields(kOutput, 8, 1);
  for (const std::uint32_t usage : {0x50U, 0x54U, 0x51U, 0xa7U}) text.usage(usage);
  text.fields(kOutput, 16, 4).usage(0x52).fields(kOutput, 8, 1).usage(0x53).fields(kOutput, 8, 1);
  text.page(1).usage(0x30).usage(0x31).fields(kOutput, 1, axes);
  text.page(15).usage(0x56).fields(kOutput, 1, 1).item(0x94, 7 - axes, 1).item(kOutput, 3, 1);
  text.page(10).usage(1).usage(2).fields(kOutput, 16, axes);
  if (build.offsets != 0)
    text.usage(1).usage(2).fields(kOutput, 16, axes * static_cast<std::uint32_t>(build.offsets));
  text.close().page(15);
  for (const auto& [id, bytes] : {std::pair{0x05U, 3U}, {0x0aU, 3U}, {0x0cU, 1U}, {0x0dU, 1U}})
    text.id(id).usage(0x22).fields(kOutput, 8, bytes);
  text.id(0x11).usage(0x25).fields(kFeature, 8, 3).id(0x12).usage(0x22).fields(kFeature, 8, 4);
  return text.close().text();
}

}  // namespace hapticd::hid::test
