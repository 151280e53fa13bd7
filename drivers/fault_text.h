// Why a device cannot go on, for people: put together by one thread without the heap, read by any other.
#pragma once
#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <string>
#include <string_view>

#include "control/rt/latest.h"

namespace hapticd::drivers {

class FaultText {
 public:
  /// Begins a text, up to 240 letters; it is seen once publish() is called.
  FaultText& begin() noexcept {
    text_.size = 0;
    return *this;
  }
  FaultText& add(std::string_view text) noexcept {
    const std::size_t count = std::min(text.size(), text_.letters.size() - text_.size);
    std::copy_n(text.begin(), count,
                text_.letters.begin() + static_cast<std::ptrdiff_t>(text_.size));
    text_.size += count;
    return *this;
  }
  FaultText& add(long long number, int base = 10) noexcept {
    std::array<char, 24> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number, base).ptr;
    return add(std::string_view(digits.data(), static_cast<std::size_t>(end - digits.data())));
  }
  void publish() noexcept { shown_.store(text_); }

  /// Any thread but the loop's: it allocates, and tries again while a text is being published. Empty: there is none, or who
  /// publishes it does not get to its end.
  std::string text() const {
    constexpr int kTries = 10'000;
    Text text;
    for (int i = 0; i < kTries && !shown_.load(text); ++i) {
    }
    return {text.letters.data(), text.size};
  }

 private:
  struct Text {
    std::size_t size = 0;
    std::array<char, 240> letters{};
  };
  Text text_{};  ///< of who writes
  rt::Latest<Text> shown_;
};

}  // namespace hapticd::drivers
