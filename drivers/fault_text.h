// Why a device cannot go on, for people: put together by the servo thread without the heap, read by any other. A text
// stays as it is; the next one is written beside it.
#pragma once
#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <cstddef>
#include <string_view>

namespace hapticd::drivers {

class FaultText {
 public:
  /// Begins a text; it is seen once publish() is called.
  FaultText& begin() noexcept {
    next_ = (next_ + 1) % kTexts;
    texts_[next_].size = 0;
    return *this;
  }
  FaultText& add(std::string_view text) noexcept {
    Text& now = texts_[next_];
    const std::size_t count = std::min(text.size(), now.letters.size() - now.size);
    std::copy_n(text.begin(), count, now.letters.begin() + static_cast<std::ptrdiff_t>(now.size));
    now.size += count;
    return *this;
  }
  FaultText& add(long long number, int base = 10) noexcept {
    std::array<char, 24> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number, base).ptr;
    return add(std::string_view(digits.data(), static_cast<std::size_t>(end - digits.data())));
  }
  void publish() noexcept { shown_.store(&texts_[next_], std::memory_order_release); }

  std::string_view view() const noexcept {
    const Text* text = shown_.load(std::memory_order_acquire);
    return text == nullptr ? std::string_view{}
                           : std::string_view{text->letters.data(), text->size};
  }

 private:
  struct Text {
    std::array<char, 240> letters{};
    std::size_t size = 0;
  };
  static constexpr std::size_t kTexts = 8;  // so many faults would have to come while one is read
  std::array<Text, kTexts> texts_{};
  std::size_t next_ = 0;
  std::atomic<const Text*> shown_{nullptr};
};

}  // namespace hapticd::drivers
