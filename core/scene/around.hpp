#pragma once
#include <functional>
#include <optional>
#include <string_view>

#include "core/ids.hpp"

namespace peerd::vrml {

// What is around a text that is added to a world.
struct Around {
  // Finds what a path means that names nothing in the text; null: nothing is around.
  std::function<std::optional<ObjectId>(std::string_view)> find{};
  ObjectId first_object{};  // the id of the first instance; the others count on
};

}  // namespace peerd::vrml
