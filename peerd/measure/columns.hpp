#pragma once
#include <string>
#include <vector>

namespace peerd::report {

// One column of a table on the terminal.
struct Column {
  std::string group;  // over several columns alike: "at b"
  std::string name;
  bool numeric = true;  // to the right
  std::vector<std::string> cells;
};

// The value with so many decimals.
[[nodiscard]] std::string fixed(double value, int decimals);

// Without the blanks at its end.
void append_line(std::string& out, std::string line);

// The names, then the cells, row by row; groups over the names where there are any.
void append_rows(std::string& out, const std::vector<Column>& columns);

}  // namespace peerd::report
