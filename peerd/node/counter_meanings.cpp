#include "peerd/node/counter_meanings.hpp"

#include <algorithm>
#include <array>

namespace peerd {
namespace {

struct CounterText {
  std::string_view name, text;
};

// By name.
constexpr std::array kTexts{
    CounterText{"bytes_in", "UDP payload received and used"},
    CounterText{"bytes_out", "UDP payload sent"},
    CounterText{"came_to_rest", "contacts in which two came to rest against each other"},
    CounterText{"clock_contradictions", "stamps that cannot be true together: some clock jumped"},
    CounterText{"clock_steps", "steps of session time"},
    CounterText{"contact_searches", "exact searches for a contact"},
    CounterText{"contact_searches_failed", "searches that reached their limit of steps"},
    CounterText{"contact_searches_far", "searches that bounding volumes settled"},
    CounterText{"contact_searches_overlapped", "searches that began inside another object"},
    CounterText{"contact_searches_skipped", "pairs whose last answer still held"},
    CounterText{"contact_searches_unseen", "searches put off, as nobody here sees them; each goes on later, or never"},
    CounterText{"contact_searches_unsupported", "pairs that collision cannot answer"},
    CounterText{"contacts", "contacts found, predicted ones included"},
    CounterText{"contacts_capped", "ticks with more contacts than are answered: what met stood still"},
    CounterText{"contacts_held", "contacts that another peer is to decide"},
    CounterText{"contacts_refuted", "of those, the ones that the other peer did not find"},
    CounterText{"contacts_too_late", "contacts found too late for anybody to decide"},
    CounterText{"contacts_undone", "predicted contacts that did not come true"},
    CounterText{"convergence_blocked", "ghosts whose way back would have led through something"},
    CounterText{"convergence_detours", "of those, the ones that followed their ghost's way"},
    CounterText{"datagrams_in", "datagrams received and used"},
    CounterText{"datagrams_out", "datagrams sent"},
    CounterText{"datagrams_refused", "datagrams of a baseline that were none of its messages"},
    CounterText{"decisions", "contacts decided here"},
    CounterText{"decisions_fallback", "of those, the ones whose decider said nothing in time"},
    CounterText{"decisions_late", "decisions that came after the bound at which they are shown"},
    CounterText{"decisions_overruled", "decisions that another one replaced"},
    CounterText{"decisions_repeated", "further copies of decisions sent"},
    CounterText{"feeds_silent", "external programs that sent nothing for too long"},
    CounterText{"gateway.connections", "connections to the viewer's port"},
    CounterText{"gateway.events_dropped", "events that viewers did not read in time"},
    CounterText{"gateway.frame_bytes", "bytes of poses sent to viewers"},
    CounterText{"gateway.frames", "frames of poses sent to viewers"},
    CounterText{"gateway.frames_late", "of those, the ones that waited for a slow viewer"},
    CounterText{"gateway.live", "viewers that opened a WebSocket"},
    CounterText{"gateway.messages", "messages from viewers"},
    CounterText{"gateway.requests", "requests by HTTP"},
    CounterText{"handovers", "updates of an object in another region than its last one"},
    CounterText{"inputs_lost", "inputs of players that never came to the server of a baseline"},
    CounterText{"jammed", "contacts answered for all that touched, as no two could part"},
    CounterText{"key_changes", "velocities that keys changed"},
    CounterText{"key_changes_refused", "velocities that keys could not change"},
    CounterText{"keys", "keys pressed"},
    CounterText{"keys_unheard", "keys to which no KeySensor listens"},
    CounterText{"keys_without_effect", "keys of a baseline that move nothing that their player owns"},
    CounterText{"models_changed", "how often somebody began to move what others are carried by"},
    CounterText{"net.announcements_in", "sealed announcements of peers' boots"},
    CounterText{"net.bytes_in", "UDP payload that reached the sockets"},
    CounterText{"net.bytes_out", "UDP payload that the kernel took"},
    CounterText{"net.calls_in", "system calls that read"},
    CounterText{"net.calls_out", "system calls that sent"},
    CounterText{"net.greetings_flood", "greetings of strangers beyond what these may cost"},
    CounterText{"net.greetings_in", "greetings received: of unicast, of relays, of an island with a relay"},
    CounterText{"net.greetings_out", "greetings sent: by unicast, to relays, on an island with a relay"},
    CounterText{"net.greetings_unopened", "greetings that the session's key does not open"},
    CounterText{"net.in_errors", "reads that failed"},
    CounterText{"net.in_flood", "of strangers beyond what these may cost"},
    CounterText{"net.in_forged", "of another key, damaged or forged"},
    CounterText{"net.in_impostor", "announces a peer whose number is another key's"},
    CounterText{"net.in_malformed", "without the region that unicast datagrams begin with"},
    CounterText{"net.in_no_destination", "without a destination group from the kernel"},
    CounterText{"net.in_no_member", "announces a peer whose key is no member's"},
    CounterText{"net.in_observer", "would change the world, by a member that may only look"},
    CounterText{"net.in_open", "not sealed"},
    CounterText{"net.in_other_epoch", "of another epoch: the sender has another roster, or none"},
    CounterText{"net.in_other_group", "to a group that is not joined"},
    CounterText{"net.in_other_interface", "over another interface"},
    CounterText{"net.in_other_region", "of a region that is not joined"},
    CounterText{"net.in_own", "sealed by this process"},
    CounterText{"net.in_queue_overflow", "lost: the kernel's receive buffer was full"},
    CounterText{"net.in_replayed", "sealed datagrams that came before, or too late"},
    CounterText{"net.in_stamp_refused", "stamps not used: the wall clock was set"},
    CounterText{"net.in_stranger", "by unicast, from an address that has not answered a greeting"},
    CounterText{"net.in_too_many_boots", "announces a start of a peer that was given up for later ones"},
    CounterText{"net.in_truncated", "longer than any datagram of a peer"},
    CounterText{"net.in_unproven", "sealed by a boot that has not named this one's, or recorded earlier"},
    CounterText{"net.in_unsigned", "by somebody who has the session's key, and not by its sender"},
    CounterText{"net.in_unstamped", "without a stamp of the kernel"},
    CounterText{"net.in_wrong_sender", "says another sender than it is sealed by"},
    CounterText{"net.out_blocked", "not sent: a firewall refused it"},
    CounterText{"net.out_errors", "not sent: the call failed"},
    CounterText{"net.out_no_group", "not sent: no multicast group is left for that region"},
    CounterText{"net.out_queue_full", "not sent: the send buffer or the interface's queue was full"},
    CounterText{"net.out_too_large", "not sent: longer than a datagram may be"},
    CounterText{"net.out_unreachable", "not sent: no interface or no route"},
    CounterText{"net.out_unwanted", "not sent: nobody behind the relay wants that region"},
    CounterText{"net.packets_in", "datagrams that reached the sockets"},
    CounterText{"net.packets_out", "datagrams that the kernel took"},
    CounterText{"net.peers_refused", "greetings of more peers than are kept"},
    CounterText{"net.relay_changes", "changes of the relay, to another one or to none"},
    CounterText{"objects_given", "how often operations gave an object to another peer, or to nobody"},
    CounterText{"objects_looked_at", "own objects checked for updates, summed over ticks"},
    CounterText{"operations", "edits that this peer has made"},
    CounterText{"operations_in", "edits received from others"},
    CounterText{"os_clocks_doubted", "operating systems' clocks that contradict the network"},
    CounterText{"pose_messages_refused", "messages of external programs that could not be read"},
    CounterText{"poses_refused", "poses of external programs not used"},
    CounterText{"poses_taken", "poses of external programs used"},
    CounterText{"predictions_skipped", "pairs not predicted, as one object is not received; summed over ticks"},
    CounterText{"predictions_unseen", "pairs not predicted, as nobody here sees them; summed over ticks"},
    CounterText{"proximity_refined", "tests of closeness that spheres did not settle"},
    CounterText{"proximity_tests", "tests whether two objects are close"},
    CounterText{"regions_joined", "regions joined"},
    CounterText{"regions_left", "regions left"},
    CounterText{"scene_changes", "how often edits changed the scene"},
    CounterText{"sights_lost", "objects no longer received"},
    CounterText{"snapshots_late", "snapshots older than the last one that a client of a baseline has"},
    CounterText{"snapshots_without_base", "snapshots of changes of one that the client of a baseline does not have"},
    CounterText{"states_out_of_range", "own states beyond what an update can say, sent as rest"},
    CounterText{"store_failures", "times that the store could not be written"},
    CounterText{"ticks", "ticks run"},
    CounterText{"ticks_missed", "ticks left out for want of time"},
    CounterText{"ticks_waited", "ticks that players in lockstep waited for others, summed over the ticks"},
    CounterText{"time_sensors_stopped", "TimeSensors stopped: they start each other without end"},
    CounterText{"update_bytes_out", "bytes of updates sent"},
    CounterText{"updates_at_once", "of updates_out, those sent between two ticks"},
    CounterText{"updates_duplicate", "copies of updates that were known"},
    CounterText{"updates_in", "updates received and used"},
    CounterText{"updates_late", "updates that came after the bound at which they are shown"},
    CounterText{"updates_missing", "updates in whose place a newer one came"},
    CounterText{"updates_out", "updates sent"},
    CounterText{"updates_relayed", "updates of others passed on"},
    CounterText{"updates_repeated", "second copies of updates sent"},
    CounterText{"updates_withheld", "updates due but beyond the byte budget, summed over ticks"},
};
static_assert(std::ranges::is_sorted(kTexts, {}, &CounterText::name));

// Counters whose names end with what they count.
constexpr std::array kFamilies{
    CounterText{"dropped_", "not used, for the reason in the name (docs/protocol.md, Drop reasons)"},
    CounterText{"gateway.refused_", "refused by the gateway, for the reason in the name (docs/reference/gateway.md)"},
    CounterText{"poses_refused_", "of poses_refused, those for the reason in the name"},
    CounterText{"updates_out_", "of updates_out, those of that size"},
};

}  // namespace

std::string_view meaning_of_counter(std::string_view name) {
  const auto known = std::ranges::lower_bound(kTexts, name, {}, &CounterText::name);
  if (known != kTexts.end() && known->name == name) return known->text;
  const auto family = std::ranges::find_if(kFamilies, [&](const CounterText& m) { return name.starts_with(m.name); });
  return family == kFamilies.end() ? std::string_view() : family->text;
}

}  // namespace peerd
