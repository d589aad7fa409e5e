#include "peerd/lab/baselines/participant.hpp"

namespace peerd::baselines {

Participant::Participant(const Setup& setup, std::size_t self, SimTime start) : setup_(setup), self_(self) {
  const config::PeerSettings& settings = setup.run.peers[self];
  log_.peer = PeerId{settings.id};
  log_.name = settings.name;
  log_.start = start;
  setup.rows.enter(log_);
}

void Participant::send(SimTime now, RegionId region, std::span<const std::byte> datagram) {
  setup_.rows.add(log_, PeerLog::Datagram{now, static_cast<std::uint32_t>(datagram.size())});
  count("datagrams_out");
  count("bytes_out", datagram.size());
  sent_.push_back({region, replication::Bytes(datagram.begin(), datagram.end())});
}

void Participant::note_update(SimTime now, ObjectId object, std::size_t bytes, const char* what) {
  setup_.rows.add(log_, PeerLog::Update{now, object, static_cast<std::uint32_t>(bytes), 0.0, what});
}

void Participant::note_sample(SimTime now, ObjectId object, const KinematicState& state, const Pose& shown) {
  const std::size_t owner = setup_.owner_of(object);
  setup_.rows.add(log_, PeerLog::ObjectSample{now, HostTime{now.time_since_epoch()}, object,
                                              PeerId{setup_.run.peers[owner].id}, state, shown});
}

void Participant::note_contact(SimTime now, const char* kind, const replication::ContactEvent& contact) {
  log_.contacts.push_back(
      {contact.at, kind, contact.collider, contact.collidee, contact.normal, now, contact.type, contact.polygons});
}

}  // namespace peerd::baselines
