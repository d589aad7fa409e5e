#include "replication/session/identity.hpp"

#include <cassert>

#include "replication/wire/codec.hpp"

namespace peerd::replication {

Bytes encode(const IdentityQuestion& question) {
  assert(question.id != kNobody);
  Message m;
  m.sender = question.id;
  m.incarnation = question.incarnation;
  m.identity = IdentityCheck{question.incarnation, question.world_hash, false};
  return encode(m);
}

bool answers(std::span<const std::byte> datagram, const IdentityQuestion& question) {
  const auto m = decode(datagram, SimTime{});
  if (!m || m->sender != question.id || !m->identity) return false;
  return m->identity->answers && m->identity->asker == question.incarnation &&
         m->identity->world_hash == question.world_hash;
}

}  // namespace peerd::replication
