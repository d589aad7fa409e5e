#include "peerd/view/gateway/refusal_kind.hpp"

#include <cassert>

namespace peerd::gateway {
namespace {

constexpr std::array<RefusalText, kRefusalKinds> kTexts{{
    {"too_many", 503, "this peer serves as many connections as it may", "a connection is one too many"},
    {"host", 421, "\"Host\" must be an address or \"localhost\", with the port of this server",
     "a request names another host: a page elsewhere may pretend to be here, or a tunnel has another port"},
    {"origin", 403, "the request comes from a page of another origin", "a page of another origin asks"},
    {"token", 401, "this changes something, and needs the token that the peer's log says",
     "a request that changes something has no token, or a wrong one"},
    {"method", 405, "no such method here", "a request has a method that is not for its place"},
    {"not_found", 404, "there is nothing of that name", "a request names nothing that is here"},
    {"malformed", 400, "the request can't be understood", "a request can't be understood"},
    {"header_too_long", 431, "the header is longer than 8 KiB", "a header is too long"},
    {"body_too_long", 413, "the body is too long", "a body or a message is too long"},
    {"too_slow", 408, "the request took too long", "a client sends or reads too slowly"},
}};

}  // namespace

const RefusalText& text_of(RefusalKind kind) {
  assert(static_cast<std::size_t>(kind) < kTexts.size());
  return kTexts.at(static_cast<std::size_t>(kind));
}

}  // namespace peerd::gateway
