#pragma once
#include <span>
#include <string>
#include <string_view>

#include "replication/wire/wire.hpp"

namespace peerd::replication {

// A hello's lists as bytes: varints, one entry behind the other. proto/README.md specifies them. take_..() trusts
// nothing: false for what put_..() does not make.

inline constexpr Duration kHeldMax = std::chrono::seconds(10);  // an older hello is not echoed

[[nodiscard]] std::string packed(const std::vector<Echo>& echoes);
[[nodiscard]] bool take_echoes(std::string_view bytes, std::vector<Echo>& echoes);
// Whether echoes without that peer's show that their sender does not hear it: there is room for more, or they go from
// one before it to one after it.
[[nodiscard]] bool leaves_out(std::span<const Echo> echoes, PeerId peer);

// Ascending.
[[nodiscard]] std::string packed(const std::vector<ObjectId>& objects);
[[nodiscard]] bool take_objects(std::string_view bytes, std::vector<ObjectId>& objects);

// Their times count from `base`.
[[nodiscard]] std::string packed(const std::vector<ContactNote>& notes, SimTime base);
[[nodiscard]] bool take_notes(std::string_view bytes, SimTime base, std::vector<ContactNote>& notes);

}  // namespace peerd::replication
