#include "ping_pong.hpp"

#include <sched.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <new>
#include <stdexcept>

namespace peerd::bench {
namespace {

double us_between(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double, std::micro>(to - from).count();
}

class SharedStamps {
 public:
  explicit SharedStamps(std::size_t pings)
      : memory_(mmap(nullptr, sizeof(Stamps), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)) {
    if (memory_ == MAP_FAILED) throw std::bad_alloc();
    if (pings > kPingsMax) throw std::length_error("more pings than there is room for");
    (new (memory_) Stamps)->pings = pings;
  }
  SharedStamps(const SharedStamps&) = delete;
  SharedStamps& operator=(const SharedStamps&) = delete;
  ~SharedStamps() { munmap(memory_, sizeof(Stamps)); }
  Stamps& operator*() { return *static_cast<Stamps*>(memory_); }

 private:
  void* memory_;
};

// This process on that core alone, as long as the object lives.
class Pinned {
 public:
  explicit Pinned(int core) {
    if (sched_getaffinity(0, sizeof before_, &before_) != 0) throw std::runtime_error("no affinity");
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(core, &one);
    if (sched_setaffinity(0, sizeof one, &one) != 0) throw std::runtime_error("no such core");
  }
  Pinned(const Pinned&) = delete;
  Pinned& operator=(const Pinned&) = delete;
  ~Pinned() { sched_setaffinity(0, sizeof before_, &before_); }

 private:
  cpu_set_t before_;
};

// The process that answers. It is gone with the object.
class Answering {
 public:
  Answering(const std::function<void(Stamps&)>& pong, Stamps& stamps, int core) {
    std::fflush(nullptr);  // or what is buffered would be written by both
    child_ = fork();
    if (child_ < 0) throw std::runtime_error("no second process");
    if (child_ > 0) return;
    try {
      const Pinned pinned(core);
      pong(stamps);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "pong: %s\n", error.what());
      _exit(1);
    }
    _exit(0);
  }
  Answering(const Answering&) = delete;
  Answering& operator=(const Answering&) = delete;
  ~Answering() {
    if (child_ <= 0) return;
    kill(child_, SIGKILL);
    waitpid(child_, nullptr, 0);
  }
  void join() {
    int status = 0;
    waitpid(child_, &status, 0);
    child_ = -1;
    if (status != 0) throw std::runtime_error("the process that answers failed");
  }

 private:
  pid_t child_;
};

}  // namespace

Cores two_cores() {
  cpu_set_t usable;
  if (sched_getaffinity(0, sizeof usable, &usable) != 0) throw std::runtime_error("no affinity");
  std::vector<int> cores;
  for (int core = 0; core < CPU_SETSIZE && cores.size() < 2; ++core) {
    if (CPU_ISSET(core, &usable)) cores.push_back(core);
  }
  return {cores.front(), cores.back()};
}
Cores one_core() {
  const int core = two_cores().ping;
  return {core, core};
}

Latencies ping_pong(std::size_t pings, Cores cores, const std::function<void(Stamps&)>& ping,
                    const std::function<void(Stamps&)>& pong) {
  SharedStamps shared(pings);
  Stamps& stamps = *shared;
  Answering other(pong, stamps, cores.pong);
  {
    const Pinned pinned(cores.ping);
    ping(stamps);
  }
  other.join();
  Latencies all;
  for (std::size_t i = 0; i < pings; ++i) {
    all.half_round_trip_us.push_back(0.5 * us_between(stamps.published[i], stamps.answered[i]));
    all.one_way_us.push_back(us_between(stamps.published[i], stamps.heard[i]));
  }
  return all;
}

double percentile(std::vector<double> samples, double share) {
  const auto at = static_cast<std::ptrdiff_t>(std::floor(share * static_cast<double>(samples.size() - 1)));
  std::ranges::nth_element(samples, samples.begin() + at);
  return samples[static_cast<std::size_t>(at)];
}

}  // namespace peerd::bench
