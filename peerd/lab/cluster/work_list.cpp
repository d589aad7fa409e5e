#include "peerd/lab/cluster/work_list.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

#include "peerd/input/number.hpp"

namespace peerd::cluster {
namespace {

std::optional<std::size_t> index_from(std::string_view text) {
  const auto index = parse_whole_number(text, 0, std::numeric_limits<std::int64_t>::max());
  return index ? std::optional(static_cast<std::size_t>(*index)) : std::nullopt;
}

}  // namespace

std::string to_text(std::span<const std::size_t> items) {
  std::string text;
  for (std::size_t i = 0; i < items.size();) {
    std::size_t last = i;
    while (last + 1 < items.size() && items[last + 1] == items[last] + 1) ++last;
    text += (text.empty() ? "" : ",") + std::to_string(items[i]);
    if (last > i) text += '-' + std::to_string(items[last]);
    i = last + 1;
  }
  return text;
}

std::optional<ItemList> item_list_from(std::string_view text, std::size_t count) {
  ItemList items;
  for (bool more = true; more;) {
    const std::size_t comma = text.find(',');
    const std::string_view part = text.substr(0, comma);
    more = comma != std::string_view::npos;
    text.remove_prefix(more ? comma + 1 : text.size());
    const std::size_t dash = part.find('-');
    const auto first = index_from(part.substr(0, dash));
    const auto last = dash == std::string_view::npos ? first : index_from(part.substr(dash + 1));
    if (!first || !last || *last < *first || *last >= count) return std::nullopt;
    if (!items.empty() && *first <= items.back()) return std::nullopt;
    for (std::size_t item = *first; item <= *last; ++item) items.push_back(item);
  }
  return items;
}

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

}  // namespace peerd::cluster
