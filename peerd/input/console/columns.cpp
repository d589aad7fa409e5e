#include "peerd/input/console/columns.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>

namespace peerd {
namespace {

// The width on a terminal is taken as the number of code points. Paths and names rarely have wider characters.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) { return (c & 0xc0) != 0x80; }));
}

std::string padded(const std::string& text, std::size_t width, bool right) {
  const std::string space(width - std::min(width, width_of(text)), ' ');
  return right ? space + text : text + space;
}

}  // namespace

std::string fixed(double value, int decimals) {
  std::array<char, 400> text{};  // 1e308 has 309 digits
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, decimals).ptr;
  return {text.data(), end};
}

std::string length_text(double length_m) {
  if (length_m >= 1.0) return fixed(length_m, 2) + " m";
  if (length_m >= 1e-3) return fixed(length_m * 1e3, 1) + " mm";
  return fixed(length_m * 1e6, 1) + " µm";
}

void append_line(std::string& out, std::string line) {
  line.erase(line.find_last_not_of(' ') + 1);
  out += line + '\n';
}

void append_rows(std::string& out, const std::vector<Column>& columns) {
  std::vector<std::size_t> widths;
  for (const Column& c : columns) {
    std::size_t width = width_of(c.name);
    for (const std::string& cell : c.cells) width = std::max(width, width_of(cell));
    widths.push_back(width);
  }
  std::string groups;
  std::string names;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const bool starts_group = !columns[c].group.empty() && (c == 0 || columns[c - 1].group != columns[c].group);
    const std::string gap(c == 0 ? 0 : starts_group ? 4 : 2, ' ');
    if (starts_group) groups = padded(groups, width_of(names) + gap.size(), false) + columns[c].group;
    names += gap + padded(columns[c].name, widths[c], columns[c].numeric);
  }
  if (!groups.empty()) append_line(out, groups);
  append_line(out, names);
  const std::size_t rows = columns.front().cells.size();
  for (std::size_t r = 0; r < rows; ++r) {
    std::string line;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const bool starts_group = !columns[c].group.empty() && columns[c - 1].group != columns[c].group;
      line += std::string(c == 0         ? 0
                          : starts_group ? 4
                                         : 2,
                          ' ') +
              padded(columns[c].cells[r], widths[c], columns[c].numeric);
    }
    append_line(out, line);
  }
}

}  // namespace peerd
