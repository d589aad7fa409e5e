#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "peerd/input/input_error.hpp"

namespace peerd::seal {

// A text that is wiped where it ends.
class Secret {
 public:
  explicit Secret(std::string text);
  Secret(const Secret&) = delete;
  Secret& operator=(const Secret&) = delete;
  Secret(Secret&&) = default;
  Secret& operator=(Secret&&) = delete;
  ~Secret();

  // Without the end of its last line.
  [[nodiscard]] std::string_view line() const {
    return std::string_view(text_).substr(0, text_.size() - (text_.ends_with('\n') ? 1 : 0));
  }
  void cut(std::size_t bytes) { text_.resize(bytes); }

 private:
  std::string text_;
};

// A file with one secret line. `what` it is, in errors: "key".
struct SecretFile {
  std::filesystem::path path;
  std::string what;

  // The error "error: the key FILE is no file".
  [[nodiscard]] InputError wrong(const std::string& predicate, int code) const;
};
inline constexpr std::size_t kSecretMax_bytes = 255;

// A file that others may read or write is refused.
[[nodiscard]] Result<Secret> read_secret(const SecretFile& file);
// Makes the file, which only this user may read, with that line. One that is there stays as it is.
[[nodiscard]] Result<void> make_secret(const SecretFile& file, const Secret& line);

}  // namespace peerd::seal
