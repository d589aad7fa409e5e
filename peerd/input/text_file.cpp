#include "peerd/input/text_file.hpp"

#include <fstream>
#include <ios>
#include <sstream>
#include <system_error>

namespace peerd {

Result<std::string> read_text_file(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) {
    return std::unexpected(InputError{path.string() + ": error: there is no such file"});
  }
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  const bool empty = in.peek() == std::ifstream::traits_type::eof();  // inserting nothing would count as a failure
  if (!empty) text << in.rdbuf();
  if (in.fail() || in.bad() || text.fail() || std::filesystem::is_directory(path, ignored)) {
    return std::unexpected(InputError{path.string() + ": error: can't be read; is it a file that you may read?", 3});
  }
  return text.str();
}

}  // namespace peerd
