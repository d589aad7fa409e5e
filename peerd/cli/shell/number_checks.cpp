#include "peerd/cli/shell/number_checks.hpp"

#include <string>

namespace peerd {

CLI::Validator number_in(NumberRange range) {
  const auto check = [range](std::string& text) {
    const auto number = parse_number(text, range);
    return number ? std::string() : number.error();
  };
  return {check, ""};
}

CLI::Validator whole_number_in(std::int64_t min, std::int64_t max) {
  const auto check = [min, max](std::string& text) {
    const auto number = parse_whole_number(text, min, max);
    if (!number) return number.error();
    text = std::to_string(*number);
    return std::string();
  };
  return {check, ""};
}

}  // namespace peerd
