#pragma once
#include <linux/netlink.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <expected>
#include <functional>
#include <span>
#include <string_view>

namespace peerd::doctor {

// One attribute of a netlink message; `type` without its flags.
struct Attribute {
  std::uint16_t type;
  std::span<const std::byte> value;

  // The number in the value's first bytes, in the byte order of this computer; 0 where it is shorter.
  template <class Number>
  [[nodiscard]] Number number() const {
    Number number{};
    if (value.size() >= sizeof number) std::memcpy(&number, value.data(), sizeof number);
    return number;
  }
  // A text up to its terminating zero.
  [[nodiscard]] std::string_view text() const;
};

// Calls `each` for the attributes in `bytes`; a cut one ends them.
void for_each_attribute(std::span<const std::byte> bytes, const std::function<void(const Attribute&)>& each);

// Sends a request for all objects of a kind (NLM_F_DUMP), whose body is `body`, and calls `each` with the type and the
// body of each message of the answer. The error is an errno.
[[nodiscard]] std::expected<void, int> dump(int family, std::uint16_t type, std::span<const std::byte> body,
                                            const std::function<void(std::uint16_t, std::span<const std::byte>)>& each);

}  // namespace peerd::doctor
