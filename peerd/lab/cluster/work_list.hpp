#pragma once
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace peerd::cluster {

// Indices of items, ascending, each once.
using ItemList = std::vector<std::size_t>;

// The list in words of a command line, such as "0-2,5".
[[nodiscard]] std::string to_text(std::span<const std::size_t> items);
// Parses what to_text writes, of indices below `count`; none: it is no such list, or an empty one.
[[nodiscard]] std::optional<ItemList> item_list_from(std::string_view text, std::size_t count);

// Deals the items out to `tasks` tasks at most, in order, as evenly as it goes. No task is empty.
[[nodiscard]] std::vector<ItemList> deal(const ItemList& items, std::size_t tasks);

}  // namespace peerd::cluster
