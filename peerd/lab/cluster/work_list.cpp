#include "peerd/lab/cluster/work_list.hpp"

#include <algorithm>
#include <cassert>

#include "peerd/input/number.hpp"

namespace peerd::cluster {

std::vector<ItemList> deal(const ItemList& items, std::size_t tasks) {
  assert(tasks > 0);
  const std::size_t used = std::min(tasks, items.size());
  std::vector<ItemList> dealt;
  auto next = items.begin();
  for (std::size_t task = 0; task < used; ++task) {
    const auto end = items.begin() + static_cast<std::ptrdiff_t>(items.size() * (task + 1) / used);
    dealt.emplace_back(next, end);
    next = end;
  }
  return dealt;
}

std::string range_text(const ItemList& items) {
  assert(!items.empty());
  return std::to_string(items.front()) + '-' + std::to_string(items.back());
}

std::optional<ItemRange> item_range_from(std::string_view text, std::size_t count) {
  const std::size_t dash = text.find('-');
  if (dash == std::string_view::npos || count == 0) return std::nullopt;
  const auto most = static_cast<std::int64_t>(count - 1);
  const auto first = parse_whole_number(text.substr(0, dash), 0, most);
  const auto last = parse_whole_number(text.substr(dash + 1), 0, most);
  if (!first || !last || *last < *first) return std::nullopt;
  return ItemRange{static_cast<std::size_t>(*first), static_cast<std::size_t>(*last)};
}

}  // namespace peerd::cluster
