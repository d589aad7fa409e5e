#include "peerd/net/nats/subjects.hpp"

#include <cassert>

#include <spdlog/fmt/fmt.h>

#include "peerd/net/settings/nats_settings.hpp"

namespace peerd::nats {
namespace {

bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
}

}  // namespace

Subjects::Subjects(std::string_view prefix, std::string_view world, std::uint64_t session) {
  assert(net::is_subject(prefix) && !world.empty());
  const std::string of_world = fmt::format("{}.{}.", prefix, token(world));
  whole_scene_ = of_world + "any.0";
  regions_ = fmt::format("{}{:016x}.", of_world, session);
}

std::string Subjects::of(RegionId region) const {
  return region.value == 0 ? whole_scene_ : regions_ + std::to_string(region.value);
}

std::string token(std::string_view text) {
  std::string plain;
  for (const char c : text) {
    if (is_plain(c)) {
      plain += c;
    } else {
      plain += fmt::format("%{:02x}", static_cast<unsigned char>(c));
    }
  }
  return plain;
}

}  // namespace peerd::nats
