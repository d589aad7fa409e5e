#include "peerd/peer/record/recorded_transport.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace peerd::record {

RecordedTransport::RecordedTransport(std::unique_ptr<net::Transport> carrier, CaptureWriter& capture,
                                     std::function<HostTime()> clock)
    : carrier_(std::move(carrier)), capture_(capture), clock_(std::move(clock)) {
  assert(carrier_ && clock_);
}

void RecordedTransport::on_receive(ReceiveHandler handler) {
  handler_ = std::move(handler);
  carrier_->on_receive([this](const net::Arrival& arrival) {
    capture_.on_packet(not_before_last(arrival.at), arrival.from, arrival.region, arrival.datagram);
    capture_.flush();
    handler_(arrival);
  });
}

void RecordedTransport::send(RegionId region, std::span<const std::byte> datagram) {
  capture_.on_send(not_before_last(clock_()), region, datagram);
  carrier_->send(region, datagram);
}

void RecordedTransport::flush() {
  capture_.flush();
  carrier_->flush();
}

// Sockets are read one after the other, and a capture's times never decrease.
HostTime RecordedTransport::not_before_last(HostTime at) { return last_ = std::max(last_, at); }

}  // namespace peerd::record
