#include "peerd/daemon/log/standard_output.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <utility>

#include "peerd/daemon/log/log.hpp"

namespace peerd::standard_output_test {
namespace {

// Standard output as a pipe of 4 KiB that nobody reads until somebody does.
class Pipe {
 public:
  Pipe() {
    std::fflush(stdout);
    EXPECT_EQ(pipe(ends_), 0);
    fcntl(ends_[1], F_SETPIPE_SZ, 4096);
    kept_ = dup(STDOUT_FILENO);
    dup2(ends_[1], STDOUT_FILENO);
    close(ends_[1]);
  }
  ~Pipe() {
    end();
    close(ends_[0]);
  }
  void end() {
    if (kept_ < 0) return;
    dup2(kept_, STDOUT_FILENO);
    close(std::exchange(kept_, -1));
  }
  // Returns what there is to read, and waits for it at most that long.
  std::string read(int at_most_ms) {
    std::string all;
    pollfd in{ends_[0], POLLIN, 0};
    while (poll(&in, 1, at_most_ms) > 0) {
      char some[4096];
      const ssize_t size = ::read(ends_[0], some, sizeof some);
      if (size <= 0) break;
      all.append(some, static_cast<std::size_t>(size));
    }
    return all;
  }

 private:
  int ends_[2]{};
  int kept_ = -1;
};

// A log that waits for its reader would stop the peer.
TEST(StandardOutput, ALogThatNobodyReadsDropsLinesAndCountsThem) {
  Pipe out;
  constexpr int kLines = 20'000;
  std::atomic<int> written = 0;
  std::optional<Log> log(std::in_place, "ada", Log::Options{.format = LogFormat::kJournal, .verbose = true},
                         [] { return HostTime{}; });
  std::thread peer([&] {
    for (int i = 0; i < kLines; ++i) {
      (*log)(LogLevel::kDebug, "line " + std::to_string(i));
      ++written;
    }
  });
  for (int i = 0; i < 500 && written < kLines; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(written, kLines) << "it waits";
  std::string text = out.read(0);
  peer.join();
  for (int i = 0; i < 100 && text.find("dropped") == std::string::npos; ++i) {
    log->report_left_out();
    text += out.read(0);
  }
  (*log)(LogLevel::kInfo, "and goes on");
  log.reset();
  text += out.read(0);
  out.end();
  int line = 0, dropped = 0, lines = 0;
  std::istringstream in(text);
  for (std::string each; std::getline(in, each); ++lines) {
    if (std::sscanf(each.c_str(), "<7>line %d", &line) == 1) {
      EXPECT_EQ(line, lines) << "whole lines, and the first ones";
    } else if (std::sscanf(each.c_str(), "<4>%d lines were dropped: nobody read the log", &dropped) != 1) {
      EXPECT_EQ(each, "<6>and goes on");
    }
  }
  EXPECT_GT(dropped, 0);
  EXPECT_EQ(lines - 2 + dropped, kLines);
}

TEST(StandardOutput, ASlowReaderGetsAllThatWaits) {
  Pipe out;
  std::thread reader;
  std::string text;
  {
    Log log("ada", {.format = LogFormat::kJournal, .verbose = true}, [] { return HostTime{}; });
    for (int i = 0; i < 2000; ++i) log(LogLevel::kDebug, "line " + std::to_string(i));
    reader = std::thread([&] { text = out.read(300); });
  }
  reader.join();
  out.end();
  EXPECT_EQ(std::ranges::count(text, '\n'), 2000);
  EXPECT_TRUE(text.ends_with("<7>line 1999\n"));
}

}  // namespace
}  // namespace peerd::standard_output_test
