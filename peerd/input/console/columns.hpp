#pragma once
#include <string>
#include <vector>

namespace peerd {

// One column of a table on the terminal.
struct Column {
  std::string group;  // heading over several columns alike: "at b"
  std::string name;
  bool numeric = true;  // aligned to the right
  std::vector<std::string> cells;
};

// The value with that number of decimals.
[[nodiscard]] std::string fixed(double value, int decimals);

// A length in the unit that suits it, such as "1.23 m", "4.5 mm" or "6.7 µm".
[[nodiscard]] std::string length_text(double length_m);

// Appends the line without the blanks at its end.
void append_line(std::string& out, std::string line);

// Appends the names, then the cells, row by row. A line of groups comes before the names where there are any.
void append_rows(std::string& out, const std::vector<Column>& columns);

}  // namespace peerd
