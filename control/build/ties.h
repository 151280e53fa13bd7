// Which things are tied together, directly or through others (union-find).
#pragma once
#include <cstddef>
#include <numeric>
#include <vector>

namespace hapticd::build {

class Ties {
 public:
  explicit Ties(std::size_t things) : towards_(things) {
    std::iota(towards_.begin(), towards_.end(), std::size_t{0});
  }

  /// The lowest of those that `thing` is tied to: the name of their set.
  std::size_t first(std::size_t thing) const {
    while (towards_[thing] != thing) thing = towards_[thing];
    return thing;
  }

  void tie(std::size_t one, std::size_t other) {
    one = first(one);
    other = first(other);
    towards_[one > other ? one : other] = one > other ? other : one;
  }

 private:
  std::vector<std::size_t> towards_;
};

}  // namespace hapticd::build
