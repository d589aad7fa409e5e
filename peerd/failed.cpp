#include <iostream>

#include "peerd/commands.hpp"

namespace peerd {

int failed(const config::InputError& error) {
  std::cerr << error.text << (error.text.ends_with('\n') ? "" : "\n");
  return error.exit_code;
}

}  // namespace peerd
