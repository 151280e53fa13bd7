#include "drivers/hid/report_descriptor.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>

namespace hapticd::hid {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kMostDepth = 16;  // of collections, and of push
constexpr std::size_t kMostUsages = 256;

/// Type and tag of a short item: its first byte without the size.
enum class Tag : std::uint8_t {
  input = 0x80,
  output = 0x90,
  collection = 0xa0,
  feature = 0xb0,
  end_collection = 0xc0,
  usage_page = 0x04,
  logical_minimum = 0x14,
  logical_maximum = 0x24,
  report_size = 0x74,
  report_id = 0x84,
  report_count = 0x94,
  push = 0xa4,
  pop = 0xb4,
  usage = 0x08,
  usage_minimum = 0x18,
  usage_maximum = 0x28,
  delimiter = 0xa8,
};
constexpr std::uint8_t kLongItem = 0xfe;

struct Item {
  Tag tag{};
  std::uint32_t data = 0;        ///< without sign
  std::int32_t signed_data = 0;  ///< the same bits with it
  std::size_t data_bytes = 0;
};

/// Holds until changed.
struct Global {
  std::uint16_t usage_page = 0;
  std::int64_t logical_minimum = 0;
  std::int64_t maximum_signed = 0, maximum_unsigned = 0;
  std::uint32_t report_size = 0, report_count = 0;
  std::uint8_t report_id = 0;
};

/// Holds until the next main item. A usage of less than four bytes is of the page that holds then.
struct Local {
  struct Range {
    std::uint32_t first = 0, last = 0;
    bool with_page = false;
  };
  std::vector<Range> ranges{};
  std::optional<Item> minimum{};
  bool alternatives = false;  ///< within delimiters: the first usage counts
  bool chosen = false;
};

using Trouble = const char*;  // null: none

class Parser {
 public:
  Trouble take(const Item& item) {
    switch (item.tag) {
      case Tag::input:
        return end_local(add_field(ReportKind::input, item.data));
      case Tag::output:
        return end_local(add_field(ReportKind::output, item.data));
      case Tag::feature:
        return end_local(add_field(ReportKind::feature, item.data));
      case Tag::collection:
        return end_local(open(item.data));
      case Tag::end_collection:
        return end_local(close());
      case Tag::usage:
        return add_usage({item.data, item.data, item.data_bytes == 4});
      case Tag::usage_minimum:
        local_.minimum = item;
        return nullptr;
      case Tag::usage_maximum:
        return add_usages_up_to(item);
      case Tag::delimiter:
        local_.alternatives = item.data == 1;
        local_.chosen = false;
        return nullptr;
      default:
        return take_global(item);
    }
  }

  Trouble finish() const {
    if (depth_ != 0) return "a collection is not closed";
    if (described_.fields.empty()) return "no report has a field";
    return nullptr;
  }
  ReportDescriptor& described() { return described_; }

 private:
  Trouble take_global(const Item& item) {
    switch (item.tag) {
      case Tag::usage_page:
        if (item.data > 0xffff) return "a usage page beyond 65535";
        global_.usage_page = static_cast<std::uint16_t>(item.data);
        return nullptr;
      case Tag::logical_minimum:
        global_.logical_minimum = item.signed_data;
        return nullptr;
      case Tag::logical_maximum:
        global_.maximum_signed = item.signed_data;
        global_.maximum_unsigned = item.data;
        return nullptr;
      case Tag::report_size:
        global_.report_size = item.data;
        return item.data > kMostElementBits ? "an element of more than 256 bits" : nullptr;
      case Tag::report_count:
        global_.report_count = item.data;
        return item.data > kMostReportBits ? "more elements than a report may have bits" : nullptr;
      case Tag::report_id:
        return number(item.data);
      case Tag::push:
        if (pushed_.size() == kMostDepth) return "push more than 16 deep";
        pushed_.push_back(global_);
        return nullptr;
      case Tag::pop:
        if (pushed_.empty()) return "pop without push";
        global_ = pushed_.back();
        pushed_.pop_back();
        return nullptr;
      default:
        return nullptr;  // units, strings, designators: of no use here; reserved ones are to be skipped
    }
  }

  Trouble number(std::uint32_t id) {
    if (id < 1 || id > 255) return "a report id that is not 1 to 255";
    if (!described_.numbered && !described_.fields.empty())
      return "a report id after fields without";
    described_.numbered = true;
    global_.report_id = static_cast<std::uint8_t>(id);
    return nullptr;
  }

  Trouble open(std::uint32_t type) {
    constexpr std::uint32_t kApplication = 1;
    if (depth_ == kMostDepth) return "collections more than 16 deep";
    if (depth_ == 0 && type == kApplication)
      described_.applications.push_back(local_.ranges.empty() ? 0
                                                              : complete(local_.ranges[0]).first);
    ++depth_;
    return nullptr;
  }
  Trouble close() {
    if (depth_ == 0) return "a collection is closed that is not open";
    --depth_;
    return nullptr;
  }

  Trouble add_usage(const Local::Range& range) {
    if (local_.alternatives && local_.chosen) return nullptr;
    if (local_.ranges.size() == kMostUsages) return "more than 256 usages of one item";
    local_.chosen = true;
    local_.ranges.push_back(range);
    return nullptr;
  }
  Trouble add_usages_up_to(const Item& maximum) {
    if (!local_.minimum) return "a usage maximum without minimum";
    const Item minimum = *local_.minimum;
    local_.minimum.reset();
    const bool with_page = minimum.data_bytes == 4;
    if (with_page != (maximum.data_bytes == 4) || minimum.data > maximum.data)
      return "usage minimum and maximum do not match";
    return add_usage({minimum.data, maximum.data, with_page});
  }

  UsageRange complete(const Local::Range& range) const {
    const std::uint32_t page =
        range.with_page ? 0 : static_cast<std::uint32_t>(global_.usage_page) << 16;
    return {page | range.first, page | range.last};
  }

  Trouble add_field(ReportKind kind, std::uint32_t flags) {
    if (depth_ == 0) return "a field outside of all collections";
    if (described_.numbered && global_.report_id == 0) return "a field without report id";
    std::uint32_t& bits = described_.report_bits[static_cast<std::size_t>(kind)][global_.report_id];
    const std::uint32_t before = bits != 0 ? bits : (described_.numbered ? 8U : 0U);
    const std::uint64_t more = std::uint64_t{global_.report_size} * global_.report_count;
    if (more == 0) return nullptr;
    if (before + more > kMostReportBits) return "a report of more than 4096 bytes";
    if (described_.fields.size() == kMostDescribedFields) return "more than 256 fields";
    bits = before + static_cast<std::uint32_t>(more);
    described_.fields.push_back(field_at(before, kind, flags));
    return nullptr;
  }
  ReportField field_at(std::uint32_t offset_bits, ReportKind kind, std::uint32_t flags) const {
    const bool negative = global_.logical_minimum < 0;
    ReportField field{.kind = kind,
                      .report_id = global_.report_id,
                      .offset_bits = offset_bits,
                      .element_bits = global_.report_size,
                      .count = global_.report_count,
                      .constant = (flags & 1) != 0,
                      .variable = (flags & 2) != 0,
                      .logical_least = global_.logical_minimum,
                      .logical_most = negative ? global_.maximum_signed : global_.maximum_unsigned,
                      .usages = {}};
    for (const Local::Range& range : local_.ranges) field.usages.push_back(complete(range));
    return field;
  }

  Trouble end_local(Trouble trouble) {
    local_ = {};
    return trouble;
  }

  Global global_{};
  std::vector<Global> pushed_{};
  Local local_{};
  std::size_t depth_ = 0;
  ReportDescriptor described_{};
};

Item item_of(std::uint8_t prefix, std::span<const std::uint8_t> data) noexcept {
  Item item{.tag = static_cast<Tag>(prefix & 0xfc), .data_bytes = data.size()};
  if (data.empty()) return item;
  std::memcpy(&item.data, data.data(), data.size());
  const unsigned unused = 32 - 8 * static_cast<unsigned>(data.size());
  item.signed_data = static_cast<std::int32_t>(item.data << unused) >> unused;
  return item;
}

tl::unexpected<Error> refuse(std::size_t at, const char* why) {
  return fail(ExitCode::unavailable,
              "HID report descriptor, byte " + std::to_string(at) + ": " + why);
}

/// Index of the element with that usage; nothing: none has it.
std::optional<std::uint32_t> element_of(const ReportField& field, Usage usage) noexcept {
  std::uint64_t before = 0;
  for (const UsageRange& range : field.usages) {
    if (usage >= range.first && usage <= range.last) before += usage - range.first;
    if (before >= field.count) return std::nullopt;
    if (usage >= range.first && usage <= range.last) return static_cast<std::uint32_t>(before);
    before += std::uint64_t{range.last} - range.first + 1;
  }
  return std::nullopt;
}

bool within(const Place& place, std::uint32_t bits) noexcept {
  return place.offset_bits <= bits && place.width_bits <= bits - place.offset_bits;
}

/// The report that the map means: its bits, or why there is none.
struct Meant {
  Fit fit = Fit::ok;
  std::uint32_t bits = 0;
};
Meant report_of(const ReportDescriptor& descriptor, ReportKind kind, std::optional<std::uint8_t> id,
                std::size_t bytes) noexcept {
  const std::uint8_t number = id.value_or(0);
  const std::size_t described = descriptor.report_bytes(kind, number);
  if (described == 0) return {Fit::no_such_report, 0};
  if (described != bytes) return {Fit::report_length, 0};
  return {Fit::ok, descriptor.report_bits[static_cast<std::size_t>(kind)][number]};
}

template <class Fields>
bool all_within(const Fields& fields, std::uint32_t bits) noexcept {
  return std::all_of(fields.begin(), fields.end(),
                     [&](const auto& field) { return within(field.place, bits); });
}

}  // namespace

Result<ReportDescriptor> parse_descriptor(std::span<const std::uint8_t> bytes) {
  if (bytes.size() > kMostDescriptorBytes) return refuse(bytes.size(), "more than 4096 bytes");
  Parser parser;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::uint8_t prefix = bytes[at];
    const auto rest = bytes.subspan(at + 1);
    const bool is_long = prefix == kLongItem;
    if (is_long && rest.size() < 2) return refuse(at, "an item is cut off");
    const std::size_t size = is_long ? 2U + rest[0] : (prefix & 3U) == 3 ? 4U : prefix & 3U;
    if (size > rest.size()) return refuse(at, "an item is cut off");
    if (!is_long) {
      if (Trouble trouble = parser.take(item_of(prefix, rest.first(size))); trouble != nullptr)
        return refuse(at, trouble);
    }
    at += 1 + size;
  }
  if (Trouble trouble = parser.finish(); trouble != nullptr) return refuse(bytes.size(), trouble);
  return std::move(parser.described());
}

std::optional<Found> find(const ReportDescriptor& descriptor, ReportKind kind,
                          Usage usage) noexcept {
  for (const ReportField& field : descriptor.fields) {
    if (field.kind != kind || field.constant || !field.variable) continue;
    const std::optional<std::uint32_t> element = element_of(field, usage);
    if (!element) continue;
    if (field.element_bits > 64) return std::nullopt;
    return Found{field.report_id,
                 {.offset_bits = field.offset_bits + *element * field.element_bits,
                  .width_bits = field.element_bits,
                  .is_signed = field.logical_least < 0}};
  }
  return std::nullopt;
}

Fit fit(const ReportDescriptor& descriptor, const InputMap& map) noexcept {
  const Meant meant = report_of(descriptor, ReportKind::input, map.report_id, map.report_bytes);
  if (meant.fit != Fit::ok) return meant.fit;
  const bool inside = all_within(map.fields, meant.bits) &&
                      (!map.sequence || within(map.sequence->place, meant.bits));
  return inside ? Fit::ok : Fit::outside;
}

Fit fit(const ReportDescriptor& descriptor, const OutputMap& map) noexcept {
  const Meant meant = report_of(descriptor, ReportKind::output, map.report_id, map.report_bytes);
  if (meant.fit != Fit::ok) return meant.fit;
  const bool inside =
      all_within(map.fields, meant.bits) && (!map.heartbeat || within(*map.heartbeat, meant.bits));
  return inside ? Fit::ok : Fit::outside;
}

}  // namespace hapticd::hid
