#pragma once
#include <array>
#include <cstddef>
#include <string_view>

namespace peerd {

// A secret as it was typed or stands in a file. It is wiped where it ends, and never grows into another place, so that
// no copy of it is left behind.
class SecretText {
 public:
  static constexpr std::size_t kBytesMax = 1024;

  SecretText() = default;
  SecretText(const SecretText&) = default;
  SecretText& operator=(const SecretText&) = default;
  ~SecretText();

  // False: there is no room.
  [[nodiscard]] bool append(char c);
  [[nodiscard]] std::string_view view() const { return {text_.data(), size_}; }

 private:
  std::array<char, kBytesMax> text_{};
  std::size_t size_ = 0;
};

}  // namespace peerd
