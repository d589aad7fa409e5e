#pragma once
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "peerd/view/picture/drawn_scene.hpp"

namespace peerd::view {

// Gathers what a picture leaves out: each place by its path, and beyond kNamed of a kind their number.
class UndrawnList {
 public:
  static constexpr std::uint32_t kNamed = 1000;

  // `path()` is asked for only where it is named.
  template <class Path>
  void add(const Path& path, const std::string& what, const std::string& why) {
    Kind& kind = kinds_[{what, why}];
    if (++kind.count > kNamed + 1) {
      ++all_[kind.last].count;
      return;
    }
    kind.last = all_.size();
    all_.push_back({path(), what, why, 1});
  }
  [[nodiscard]] std::vector<Undrawn> take() { return std::move(all_); }

 private:
  struct Kind {
    std::uint32_t count = 0;
    std::size_t last = 0;  // into all_
  };
  std::map<std::pair<std::string, std::string>, Kind> kinds_;
  std::vector<Undrawn> all_;
};

}  // namespace peerd::view
