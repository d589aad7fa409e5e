#include "peerd/daemon/loop/daemon.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <csignal>
#include <cstdint>
#include <iterator>
#include <thread>
#include <utility>
#include <vector>

#include <spdlog/fmt/fmt.h>
#include <boost/asio/post.hpp>

#include "peerd/daemon/loop/cache_warmer.hpp"
#include "peerd/net/os/net_error.hpp"
#include "peerd/net/os/os_clock.hpp"
#include "peerd/peer/control/answer.hpp"
#include "peerd/peer/control/event_line.hpp"
#include "peerd/peer/control/request.hpp"
#include "peerd/peer/feed/pose_message.hpp"

namespace peerd {

// The period of the questions to the system about its clock, whose own bound grows by 0.5 ms a second, and about the
// interface.
constexpr std::chrono::seconds kSystemPeriod{1};
// While the daemon polls busily, one of so many polls also serves timers, signals and control.
constexpr std::uint64_t kReadsPerPoll = 8;
// A process that wakes later than this has been stopped for a while. It reads the datagrams of that time before it
// judges any peer silent, but at most kStalledTurns batches, so that ticks continue in a flood.
constexpr std::chrono::milliseconds kStalled{100};
constexpr int kStalledTurns = 64;
// The period of the question whether a peer of this identity is alive.
constexpr Duration kAskAgainAfter = std::chrono::milliseconds(200);

namespace {

// Status says how many ticks ran later than each of these [ms].
constexpr std::array kLate_ms{1, 2, 5, 10, 20, 50};

// The signals on which a peer leaves: a request, a terminal that is closed, a log that nobody reads any more.
constexpr std::array kLeaveOn{SIGINT, SIGTERM, SIGHUP, SIGPIPE};

const char* name_of(int signal) {
  switch (signal) {
    case SIGINT:
      return "SIGINT";
    case SIGTERM:
      return "SIGTERM";
    case SIGHUP:
      return "SIGHUP: its terminal is closed";
    default:
      return "SIGPIPE: nobody reads its log any more";
  }
}

// Whether the peer must have begun for the request.
bool needs_begun_peer(std::string_view line) {
  const auto request = control::parse_request(line);
  return request && (std::holds_alternative<control::KeyRequest>(*request) ||
                     std::holds_alternative<control::PoseRequest>(*request));
}

// A signal that is ignored from the start (nohup) stays so.
bool is_ignored(int signal) {
  struct sigaction now {};
  return sigaction(signal, nullptr, &now) == 0 && now.sa_handler == SIG_IGN;
}

}  // namespace

Daemon::Daemon(boost::asio::io_context& io, PeerNode& node, net::Transport& transport, const net::HostClock& clock,
               Log log, std::optional<Duration> leave_after, record::CaptureWriter* capture)
    : io_(io),
      timer_(io),
      signals_(io),
      node_(node),
      transport_(transport),
      clock_(clock),
      log_(std::move(log)),
      leave_after_(leave_after),
      capture_(capture) {}

control::Answer Daemon::on_control(std::string_view line) {
  if (over_) return {control::refusal("this peer is leaving")};
  if (question_ && needs_begun_peer(line)) {
    return {control::refusal("this peer has not begun: it asks first, for a second, whether it is running already")};
  }
  const HostTime at = now();
  const Duration host_minus_wall = clock_.minus_wall();
  if (capture_) capture_->on_control(at, host_minus_wall, line);
  control::Answer answer = control::answer(node_, at, line, host_minus_wall, [this] { return more_status(); });
  drain();
  if (answer.viewer) answer.line = control::viewer_reply(viewer_url_);
  if (answer.leave) {
    boost::asio::post(io_, [this] {
      if (over_) return;
      log_({LogLevel::kInfo, "leaving: as requested"});
      leave();
    });
  }
  return answer;
}

control::More Daemon::more_status() const {
  control::More all{transport_.counters().named()};
  for (const int late_ms : kLate_ms) {
    all.counters.emplace(fmt::format("ticks_late_{}_ms", late_ms),
                         lateness_.later_than(std::chrono::milliseconds(late_ms)));
  }
  for (const control::AskMore& ask : more_status_) {
    control::More more = ask();
    all.counters.merge(more.counters);
    std::ranges::move(more.troubles, std::back_inserter(all.troubles));
  }
  return all;
}

void Daemon::on_poses(std::string_view datagram) {
  if (over_) return;
  if (question_) return node_.refuse_poses("this peer has not begun");
  const HostTime at = now();
  const Duration host_minus_wall = clock_.minus_wall();
  if (capture_) capture_->on_poses(at, host_minus_wall, datagram);
  if (const auto message = feed::parse_pose_message(datagram)) {
    (void)node_.on_poses(at, host_minus_wall, message->poses);  // a refused pose is counted, and may become a notice
  } else {
    node_.refuse_poses(message.error());
  }
  drain();
}

feed::Outcome Daemon::on_poses(std::span<const feed::FedPose> poses) {
  assert(capture_ == nullptr);
  if (over_ || question_) return {};
  // Reading the difference costs 0.5 us (two dozen clock readings), so only poses that name a Unix time pay for it.
  const bool stamped = std::ranges::any_of(poses, [](const feed::FedPose& fed) { return fed.time_s.has_value(); });
  const Duration host_minus_wall = stamped ? clock_.minus_wall() : Duration{0};
  const feed::Outcome outcome = node_.on_poses(now(), host_minus_wall, poses);
  drain();
  return outcome;
}

void Daemon::take_signals() {
  for (const int signal : kLeaveOn) {
    if (!is_ignored(signal)) signals_.add(signal);
  }
}

int Daemon::run() {
  await_signal();
  begin();
  serve();
  return exit_code_;
}

void Daemon::begin() {
  (void)now();  // no datagram counts as having come before the peer was made
  transport_.on_receive([this](const net::Arrival& arrival) { on_datagram(arrival); });
  if (question_) {
    check(transport_.join(replication::kWholeScene));
    ask(clock_.now() + kIdentityIsAskedFor);
  } else {
    take_part();
  }
}

bool Daemon::poll(Duration at_most) {
  if (!over_ && io_.poll() == 0 && at_most > Duration{0}) {
    io_.run_one_for(at_most);
    io_.poll();
  }
  return !over_;
}

void Daemon::await_signal() {
  signals_.async_wait([this](const boost::system::error_code& error, int signal) {
    if (error || over_) return;
    if (signal == SIGHUP && hangup_handler_) {
      hangup_handler_();
      return await_signal();
    }
    log_({LogLevel::kInfo, fmt::format("leaving: got {}", name_of(signal))});
    leave();
  });
}

void Daemon::take_part() {
  if (over_) return;
  question_.reset();
  drain();
  if (exit_code_ != 0) return;
  wake();
  if (begin_handler_ && !over_) begin_handler_();
}

void Daemon::ask(HostTime until) {
  if (over_) return;
  if (clock_.now() >= until) return take_part();
  transport_.send(replication::kWholeScene, replication::encode(*question_));
  transport_.flush();
  timer_.expires_after(std::min(kAskAgainAfter, until - clock_.now()));
  timer_.async_wait([this, until](const boost::system::error_code& error) {
    if (!error) ask(until);
  });
}

void Daemon::on_datagram(const net::Arrival& arrival) {
  if (over_) return;
  if (question_) {
    if (!replication::answers(arrival.datagram, *question_)) return;
    log_({LogLevel::kError, fmt::format("peer {} (id {}) is running already; end it, give this one an id of its own, "
                                        "or say --take-over",
                                        node_.name(), question_->id.value)});
    exit_code_ = kSystemFailed;
    return stop();
  }
  const HostTime at = forward_(arrival.at);
  if (capture_) capture_->on_packet(at, arrival.from, arrival.region, arrival.datagram);
  node_.on_packet(at, arrival.region, arrival.datagram);
  if (received_handler_) received_handler_();
  drain();
}

// Runs the io_context as io_.run() does, but polls for a while before it sleeps. Datagrams are urgent: most polls ask
// the sockets themselves, which takes one system call in place of two. The sender of the awaited datagram may share
// this processor: the loop yields between two polls, or both would wait until it sleeps.
void Daemon::serve() {
  while (io_.run_one() > 0) {
    HostTime done = clock_.now(), warmed_at = done;
    for (std::uint64_t attempt = 1; clock_.now() - done < busy_poll_ && !io_.stopped(); ++attempt) {
      const bool all = attempt % kReadsPerPoll == 0;
      if (all ? io_.poll() > 0 : transport_.receive_pending()) {
        done = clock_.now();
      } else if (cache_warmer_ != nullptr && clock_.now() - warmed_at >= kCacheWarmingPeriod) {
        cache_warmer_->run();
        warmed_at = clock_.now();
      } else {
        std::this_thread::yield();
      }
    }
  }
}

void Daemon::wake() {
  if (over_) return;
  const bool stalled = due_ && clock_.now() - *due_ > kStalled;
  const int turns = stalled ? kStalledTurns : 1;
  for (int turn = 0; turn < turns && !over_ && transport_.receive_pending(); ++turn) {
  }
  if (over_) return;
  const HostTime now = this->now();
  if (keeper_ && now >= keeper_->due() && !store_growth()) return stop();
  if (now >= system_due_) {
    read_os_clock_into_node(now);
    follow_interface();
    system_due_ = now + kSystemPeriod;
  }
  if (due_ && node_.peer().due_tick(now)) lateness_.add(now - *due_);
  if (capture_) capture_->on_tick(now);
  node_.on_tick(now);
  drain();
  if (over_) return;
  if (leave_after_ && node_.start() && node_.peer().clock().to_session(now) > *node_.start() + *leave_after_) {
    log_({LogLevel::kInfo, "leaving: the scenario is over"});
    return leave();
  }
  log_missing();
  due_ = node_.next_deadline();
  timer_.expires_after(std::max(Duration{0}, *due_ - clock_.now()));
  timer_.async_wait([this](const boost::system::error_code& error) {
    if (!error) wake();
  });
}

void Daemon::read_os_clock_into_node(HostTime now) {
  const auto clock = net::read_os_clock(clock_);
  if (capture_) capture_->on_os_clock(now, clock);
  node_.on_os_clock(now, clock);
}

void Daemon::follow_interface() {
  if (const auto change = transport_.follow_interface())
    log_({change->is_back ? LogLevel::kInfo : LogLevel::kError, change->sentence});
}

// Motions that don't begin would look like a fault.
void Daemon::log_missing() {
  if (missing_.empty() && node_.start()) return;
  auto missing = node_.missing();
  if (missing == missing_) return;
  missing_ = std::move(missing);
  log_(describe_missing(missing_));
}

void Daemon::leave() {
  if (over_) return;
  if (leave_handler_) leave_handler_();
  if (question_) return stop();  // its goodbye would be another's
  const HostTime at = now();
  if (capture_) capture_->on_leave(at);
  node_.leave(at);
  drain();
  if (keeper_ && (!store_growth() || !keeper_->unstored().empty())) {
    log_({LogLevel::kError,
          fmt::format("leaves with {} bytes of edits that its store does not have", keeper_->unstored().bytes())});
    exit_code_ = kSystemFailed;
  }
  stop();
}

void Daemon::stop() {
  over_ = true;
  io_.stop();
}

void Daemon::drain() {
  if (question_) return;                    // nothing leaves before the peer has begun
  std::vector<replication::Output> change;  // logged after the datagrams have left, because the log may be slow
  while (auto out = node_.poll_output()) {
    if (const auto* grown = std::get_if<replication::LogGrown>(&*out)) {
      if (keeper_) keeper_->add({grown->range, grown->last}, clock_.now());
      continue;
    }
    if (keeper_ && keeper_->must_write() && std::holds_alternative<replication::Send>(*out) && !store_growth()) {
      return stop();
    }
    if (!logs_updates_ && std::holds_alternative<replication::Published>(*out)) continue;
    if (auto* send = std::get_if<replication::Send>(&*out)) {
      if (capture_) capture_->on_send(send->region, send->datagram);
      transport_.send(send->region, send->datagram);
      node_.reuse(std::move(send->datagram));
      continue;
    }
    if (const auto* join = std::get_if<replication::Join>(&*out)) {
      check(transport_.join(join->region));
    } else if (const auto* left = std::get_if<replication::Leave>(&*out)) {
      check(transport_.leave(left->region));
    }
    change.push_back(*std::move(out));
  }
  if (keeper_ && keeper_->must_write() && !store_growth()) return stop();
  transport_.flush();
  for (const replication::Output& out : change) {
    const auto* in_use = std::get_if<replication::IdInUse>(&out);
    if (in_use != nullptr && in_use->ours_is_replaced) {  // nobody would hear this peer any more
      exit_code_ = kSystemFailed;
      stop();
    }
    if (const auto* const taken = std::get_if<replication::LineTaken>(&out); taken != nullptr && store_ != nullptr) {
      if (const auto noted = store_->note_line(taken->line); !noted) log_({LogLevel::kWarning, noted.error().text});
    }
    if (node_.goes_over() && exit_code_ == 0) {  // it leaves before it enters a session that its edits are not for
      exit_code_ = kSystemFailed;
      boost::asio::post(io_, [this] { leave(); });
    }
    publish(out);
    if (event_handler_) event_handler_(out);
    if (const auto line = describe(out, node_.scene())) log_(*line);
  }
  while (const auto key = node_.poll_key_report()) {
    for (const LogLine& line : describe(*key, node_.scene())) log_(line);
  }
  while (const auto edit = node_.poll_edit_report()) log_(describe(*edit));
  while (const auto notice = node_.poll_feed_notice()) log_(describe(*notice));
  if (capture_) keep_capture();
}

void Daemon::publish(const replication::Output& event) {
  const auto kind = control::kind_of(event);
  if (!kind) return;
  const auto wants = [kind](const control::EventSink* sink) { return sink->wanted().contains(*kind); };
  if (std::ranges::none_of(event_sinks_, wants)) return;
  const std::string line = control::event_line(event, node_);
  for (control::EventSink* const sink : event_sinks_) {
    if (wants(sink)) sink->publish(*kind, line);
  }
}

bool Daemon::store_growth() {
  assert(keeper_.has_value());
  const store::StoreKeeper::Written written = keeper_->write(clock_.now());
  if (written.own) node_.note_stored(*written.own);
  if (written.error) {
    node_.note_store_failed();
    if (written.begins_to_fail || written.must_stop) log_({LogLevel::kError, written.error->text});
  }
  if (written.is_good_again) {
    log_({LogLevel::kInfo, "the store can be written again, and has all"});
    if (!store_->author_error().empty()) log_({LogLevel::kWarning, store_->author_error()});
  }
  if (!written.begins_not_to_pack.empty()) {
    log_({LogLevel::kWarning, "the store takes more room than it needs: " + written.begins_not_to_pack});
  }
  if (written.must_stop) exit_code_ = kSystemFailed;
  return !written.must_stop;
}

// Runs after each input, so that a process that is killed leaves a capture of everything that it did. A peer whose
// capture fails continues for the sake of the session, and ends with the exit code of that failure.
void Daemon::keep_capture() {
  capture_->flush();
  if (capture_->good()) return;
  log_({LogLevel::kError, "the capture ends here: it can't be written any more; is the disk full?"});
  capture_ = nullptr;
  exit_code_ = kSystemFailed;
}

void Daemon::check(const std::expected<void, net::NetError>& done) {
  if (done) return;
  log_({LogLevel::kError, done.error().sentence});
  exit_code_ = input_error(done.error()).exit_code;
  stop();
}

}  // namespace peerd
