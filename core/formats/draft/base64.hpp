#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace peerd::formats {

// Base64 (RFC 4648, with padding).
[[nodiscard]] std::string base64_encoded(std::string_view bytes);
// Returns nothing where the text is none. Missing padding is no fault.
[[nodiscard]] std::optional<std::string> base64_decoded(std::string_view text);

// Returns the bytes of a URL of the kind data:TYPE;base64,BYTES or data:TYPE,TEXT (RFC 2397), whose TEXT may have bytes
// as %XX; nothing where it is of another kind.
[[nodiscard]] std::optional<std::string> bytes_of_data_url(std::string_view url);
[[nodiscard]] std::string image_url(std::string_view bytes);  // of the media type that the bytes show
[[nodiscard]] std::string data_url(std::string_view media_type, std::string_view bytes);

}  // namespace peerd::formats
