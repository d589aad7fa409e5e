#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace peerd::gateway {

// Why a connection, a request or a message was refused.
enum class RefusalKind : std::uint8_t {
  kTooMany,
  kHost,
  kOrigin,
  kToken,
  kMethod,
  kNotFound,
  kMalformed,
  kHeaderTooLong,
  kBodyTooLong,
  kTooSlow,
};
inline constexpr std::size_t kRefusalKinds = static_cast<std::size_t>(RefusalKind::kTooSlow) + 1;

struct RefusalText {
  std::string_view name;      // in counters: gateway.refused_NAME
  unsigned status;            // of HTTP
  std::string_view sentence;  // for who has asked
  std::string_view log;       // for the log, once
};

[[nodiscard]] const RefusalText& text_of(RefusalKind kind);

}  // namespace peerd::gateway
