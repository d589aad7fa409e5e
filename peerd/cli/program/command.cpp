#include "peerd/cli/program/command.hpp"

namespace peerd {

std::string exit_codes(const std::string& finding) {
  return "Exit codes: 0 good, 1 " + finding + ", 2 wrong use or configuration, 3 the environment";
}

const InstalledFiles& installed() {
  static const InstalledFiles files = InstalledFiles::of_this_program(PEERD_SHARE);
  return files;
}

}  // namespace peerd
