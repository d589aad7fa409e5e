#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace peerd::cluster {

// Indices of items, ascending, each once.
using ItemList = std::vector<std::size_t>;

// Deals the items out to `tasks` tasks at most, in order, as evenly as it goes. No task is empty.
[[nodiscard]] std::vector<ItemList> deal(const ItemList& items, std::size_t tasks);

// A task is given the range that its items span, as a word of a command line such as "2-5": all other items of the
// range have results by then.
struct ItemRange {
  std::size_t first = 0, last = 0;
};
[[nodiscard]] std::string range_text(const ItemList& items);  // of one item at least
// Parses what range_text writes, of indices below `count`; none: it is no such range.
[[nodiscard]] std::optional<ItemRange> item_range_from(std::string_view text, std::size_t count);

}  // namespace peerd::cluster
