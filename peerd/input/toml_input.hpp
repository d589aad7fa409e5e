#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <toml++/toml.h>

#include "peerd/input/input_error.hpp"

namespace peerd {

// Reads one table of a configuration. Every key that is asked for is known; finish() refuses the first key that nobody
// asked for and names the key that was probably meant. The first error counts; later calls then do nothing.
class TomlReader {
 public:
  TomlReader(const toml::table& table, std::string path, std::optional<InputError>& error)
      : table_(table), path_(std::move(path)), error_(error) {}

  void read(std::string_view key, double& value, double min, double max);
  void read(std::string_view key, std::optional<double>& value, double min, double max);
  void read(std::string_view key, std::uint32_t& value, std::uint32_t min, std::uint32_t max);
  void read(std::string_view key, std::uint64_t& value);
  void read(std::string_view key, bool& value);
  void read(std::string_view key, std::string& value);
  void read(std::string_view key, std::vector<std::string>& value);
  void read(std::string_view key, std::vector<double>& value, std::size_t size);
  void read(std::string_view key, std::optional<std::uint64_t>& value);
  // The key holds a list of at least one list of `size` numbers.
  [[nodiscard]] std::vector<std::vector<double>> rows(std::string_view key, std::size_t size);
  // The key holds a list of at least one list of strings.
  [[nodiscard]] std::vector<std::vector<std::string>> word_rows(std::string_view key);
  // The key holds one of `words`; `index` becomes its index.
  void read_word(std::string_view key, std::size_t& index, std::initializer_list<std::string_view> words);
  // The sub-table, or null. The sub-table's own reader must finish() it.
  [[nodiscard]] const toml::table* table(std::string_view key);
  // The list of tables that [[KEY]] makes. It is empty where the key is missing.
  [[nodiscard]] std::vector<const toml::table*> tables(std::string_view key);
  [[nodiscard]] bool has(std::string_view key) const { return table_.contains(key); }
  // Reports an error where the key is missing.
  void require(std::string_view key);
  void finish();

  void fail(const toml::node* at, const std::string& sentence);
  // FILE:LINE:COLUMN: and a blank, of a node or, with null, of this table. It is empty where the place is unknown, as
  // with --set.
  [[nodiscard]] std::string place(const toml::node* at) const;
  [[nodiscard]] const toml::table& raw() const { return table_; }
  [[nodiscard]] std::string dotted(std::string_view key) const;
  [[nodiscard]] std::optional<InputError>& error() { return error_; }

 private:
  [[nodiscard]] const toml::node* node(std::string_view key);
  void number(std::string_view key, std::optional<double>& value, double min, double max);

  const toml::table& table_;
  std::string path_;
  std::optional<InputError>& error_;
  std::set<std::string, std::less<>> known_;
};

// FILE:LINE:COLUMN: and a blank. It is empty where the place is unknown, as with a value of --set.
[[nodiscard]] std::string place_of(const toml::source_region& at);

[[nodiscard]] Result<toml::table> parse_toml(const std::string& text, const std::string& name);
[[nodiscard]] Result<toml::table> read_toml(const std::filesystem::path& path);

// An assignment A.B=VALUE from a command line. A VALUE that is not TOML counts as a string.
struct Assignment {
  std::string key;
  toml::table holder;  // {value = VALUE}
};
[[nodiscard]] Result<Assignment> parse_assignment(const std::string& text);
// Puts a copy of `value` at a dotted key, making tables on the way. The items of a list go by number, from 0.
[[nodiscard]] Result<void> assign(toml::table& root, std::string_view dotted_key, const toml::node& value);
// The value at a dotted key, by the same rules. Null means that there is none.
[[nodiscard]] const toml::node* find(const toml::table& root, std::string_view dotted_key);
// Merges two tables; a value of `over` replaces that of `base`, table by table.
void merge(toml::table& base, const toml::table& over);

// The word of `words` that is closest to a misspelt one, if any is close.
[[nodiscard]] std::optional<std::string> did_you_mean(std::string_view word, const std::vector<std::string>& words);

}  // namespace peerd
