#pragma once
#include <span>
#include <string_view>

namespace peerd {

// The events of a sensor that a viewer's page makes edits of, as people work it (docs/viewer.md): those that come
// seldom, and of a drag where it ends. Empty where a page does not work that type of node.
[[nodiscard]] std::span<const std::string_view> events_by_people(std::string_view node_type);

}  // namespace peerd
