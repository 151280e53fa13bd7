#include "config/digest.h"

#include <cstdint>

namespace hapticd::config {
namespace {

class Fnv1a {
 public:
  void add(std::string_view text) {
    for (const char c : text) {
      hash_ ^= static_cast<unsigned char>(c);
      hash_ *= 0x100000001b3U;
    }
  }
  std::string digits() const {
    constexpr std::string_view hexadecimal = "0123456789abcdef";
    std::string written(16, '0');
    std::uint64_t rest = hash_;
    for (std::size_t i = 16; i-- > 0; rest >>= 4U) written[i] = hexadecimal[rest & 15U];
    return written;
  }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325U;
};

}  // namespace

std::string digest_of(std::string_view text) {
  Fnv1a hash;
  hash.add(text);
  return hash.digits();
}

std::string digest_of_rest(std::string_view text) {
  Fnv1a hash;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end == std::string_view::npos ? end : end + 1);
    if (!line.starts_with("digest:")) hash.add(line);
    text.remove_prefix(line.size());
  }
  return hash.digits();
}

}  // namespace hapticd::config
