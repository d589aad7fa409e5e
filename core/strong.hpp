#pragma once
#include <compare>
#include <functional>

namespace peerd {

// A Strong is an id that cannot be added, mixed up with another kind of id, or made by accident.
template <class Tag, class Rep>
struct Strong {
  Rep value{};
  friend constexpr auto operator<=>(const Strong&, const Strong&) = default;
};

}  // namespace peerd

template <class Tag, class Rep>
struct std::hash<peerd::Strong<Tag, Rep>> {
  std::size_t operator()(const peerd::Strong<Tag, Rep>& id) const noexcept { return std::hash<Rep>{}(id.value); }
};
