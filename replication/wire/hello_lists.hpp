#pragma once
#include <span>
#include <string>
#include <string_view>

#include "replication/wire/wire.hpp"

namespace peerd::replication {

// The lists of a hello as bytes: varints, one entry behind the other. proto/README.md specifies them. take_..() trusts
// nothing: it returns false for bytes that packed() does not make.

inline constexpr Duration kHeldMax = std::chrono::seconds(10);  // an older hello is not echoed

[[nodiscard]] std::string packed(const std::vector<Echo>& echoes);
[[nodiscard]] bool take_echoes(std::string_view bytes, std::vector<Echo>& echoes);
// Whether echoes without that peer's show that their sender does not receive it: there is room for more echoes, or
// they go from one before that peer to one after it.
[[nodiscard]] bool leaves_out(std::span<const Echo> echoes, PeerId peer);

// Packs object ids, which are ascending.
[[nodiscard]] std::string packed(const std::vector<ObjectId>& objects);
[[nodiscard]] bool take_objects(std::string_view bytes, std::vector<ObjectId>& objects);

// Packs contact notes, whose times count from `base`.
[[nodiscard]] std::string packed(const std::vector<ContactNote>& notes, SimTime base);
[[nodiscard]] bool take_notes(std::string_view bytes, SimTime base, std::vector<ContactNote>& notes);

}  // namespace peerd::replication
