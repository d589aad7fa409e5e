#pragma once
#include <filesystem>
#include <string>

#include "peerd/input/input_error.hpp"

namespace peerd::store {

// A sentence whose subject is the store in a folder.
[[nodiscard]] inline InputError store_error(const std::filesystem::path& folder, const std::string& sentence,
                                            int exit_code) {
  return {"error: the store " + folder.string() + " " + sentence, exit_code};
}

[[nodiscard]] inline InputError in_use(const std::filesystem::path& folder) {
  return store_error(folder, "is in use by another process; end that one, or give this peer a store of its own", 3);
}

}  // namespace peerd::store
