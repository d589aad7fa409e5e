#pragma once
#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/ids.hpp"

namespace peerd {

// An ObjectTable has a small value for each object, mostly none: objects of the world's file in a table by number, as
// there are many questions about them, the others in a map. The table has pages, of which those without any value have
// never been made.
template <class Value>
class ObjectTable {
 public:
  explicit ObjectTable(Value none) : none_(none) {}

  // Returns the value of an object; `none` where it has none.
  [[nodiscard]] Value of(ObjectId id) const {
    const std::uint64_t page = id.packed() / kPage;  // no other origin is so low
    if (page >= pages_.size()) return of_added(id);
    return pages_[page] ? (*pages_[page])[id.packed() % kPage] : none_;
  }
  void set(ObjectId id, Value value) {
    if (id.origin != 0) {
      if (value == none_) {
        added_.erase(id);
      } else {
        added_.insert_or_assign(id, value);
      }
      return;
    }
    const std::size_t page = id.number / kPage;
    if (page >= pages_.size()) {
      if (value == none_) return;
      pages_.resize(page + 1);
    }
    if (!pages_[page]) {
      if (value == none_) return;
      pages_[page] = std::make_unique<Page>(empty_page());
    }
    (*pages_[page])[id.number % kPage] = value;
  }
  void clear() {
    pages_.clear();
    added_.clear();
  }

  // Returns the first object, from this one on, that has a value.
  [[nodiscard]] std::optional<std::pair<ObjectId, Value>> from(ObjectId first) const {
    if (first.origin == 0) {
      std::size_t i = first.number;
      for (std::size_t page = i / kPage; page < pages_.size(); ++page, i = page * kPage) {
        if (!pages_[page]) continue;
        for (; i < (page + 1) * kPage; ++i) {
          const Value value = (*pages_[page])[i % kPage];
          if (value != none_) return std::pair(ObjectId{static_cast<std::uint32_t>(i)}, value);
        }
      }
    }
    const auto it = added_.lower_bound(first);
    return it == added_.end() ? std::nullopt : std::optional(std::pair(it->first, it->second));
  }

 private:
  static constexpr std::size_t kPage = 128;
  using Page = std::conditional_t<std::is_same_v<Value, bool>, std::bitset<kPage>, std::array<Value, kPage>>;

  [[nodiscard]] Page empty_page() const {
    Page page;
    if constexpr (std::is_same_v<Value, bool>) {
      if (none_) page.set();
    } else {
      page.fill(none_);
    }
    return page;
  }
  [[nodiscard, gnu::noinline]] Value of_added(ObjectId id) const {  // so that of() is small where it is called
    const auto it = added_.find(id);
    return it == added_.end() ? none_ : it->second;
  }

  Value none_;
  std::vector<std::unique_ptr<Page>> pages_;
  std::map<ObjectId, Value> added_;
};

}  // namespace peerd
