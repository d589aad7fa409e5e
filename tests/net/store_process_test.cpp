// The real program with a store, killed at random moments, on a full disk and on damaged files: what it has called
// stored is there afterwards.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mount.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iostream>
#include <random>
#include <set>
#include <sstream>
#include <thread>

#include <nlohmann/json.hpp>

#include "tests/net/controlled_peers.hpp"
#include "tests/net/listener.hpp"

namespace peerd::store_process_test {

using net::testing_support::own_port;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing_support::Process;

// The number that an environment variable has.
unsigned number_in(const char* variable, unsigned otherwise) {
  const char* const text = std::getenv(variable);
  return text == nullptr ? otherwise : static_cast<unsigned>(std::strtoul(text, nullptr, 10));
}

class StoreProcess : public testing_support::ControlledPeers {
 protected:
  StoreProcess() {
    folder.write("world.wrl", "#VRML V2.0 utf8\nDEF A Transform { children Shape { geometry Box { } } }\n");
  }

  [[nodiscard]] std::filesystem::path store_of(const std::string& name) const { return folder / ("store-" + name); }
  [[nodiscard]] std::filesystem::path socket_of(const std::string& name) const { return folder / (name + ".sock"); }
  Process start(const std::string& name = "a") const {
    return ControlledPeers::start(
        name,
        {"run", "--world", (folder / "world.wrl").string(), "--id", std::to_string(name[0] - 'a' + 1), "--interface",
         "lo", "--port", std::to_string(own_port(9)), "--store", store_of(name).string(), "--take-over"});
  }
  // The peer's answer to an edit right after it has made it; null: it is dead.
  [[nodiscard]] json made(const json& request, const std::string& name = "a") const {
    const json edit = ask(name, request);
    if (!edit.is_object() || !edit.value("done", false)) return {};
    json question = edit.at("operation");
    question["do"] = "operation";
    return ask(name, question);
  }
  [[nodiscard]] bool is_stored(const json& request, const std::string& name = "a") const {
    const json state = made(request, name);
    return state.is_object() && state.value("stored", false);
  }
  static json adding(const std::string& node, const std::string& field = "") {
    return {{"do", "add"}, {"text", "DEF " + node + " Transform { " + field + " }"}};
  }
  [[nodiscard]] std::string error_of_check(int exit_code) const {
    Process check(folder, "check", PEERD_PROGRAM, {"store", "check", store_of("a").string()});
    EXPECT_EQ(check.exit_code(20), exit_code) << check.out() << check.err();
    return check.err();
  }
};

// Two processes: what one of them sets and sends, a client of the other one is given as it comes.
TEST_F(StoreProcess, EventsArePushedToWhoHasSubscribed) {
  const Process a = start("a"), b = start("b");
  ASSERT_TRUE(is_in_session("a") && is_in_session("b"));
  ASSERT_TRUE(wait_until([&] { return members_of("a") == 1; }));
  const std::vector<std::string> subscribe{"ctl",       "--control", socket_of("b").string(),
                                           "subscribe", "data",      "messages"};
  std::vector<std::string> one = subscribe;
  one.insert(one.end(), {"--count", "1"});
  Process events(folder, "events", PEERD_PROGRAM, subscribe), first(folder, "first", PEERD_PROGRAM, one);
  const auto ctl = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"ctl", "--control", socket_of("a").string()});
    Process process(folder, "ctl", PEERD_PROGRAM, words);
    EXPECT_EQ(process.exit_code(20), 0) << process.err();
    return process.out();
  };
  // Until the clients have subscribed.
  ASSERT_TRUE(wait_until([&] {
    (void)ask("a", {{"do", "send"}, {"topic", "t"}, {"text", "early"}});
    return !events.out().empty() && !first.running();
  }));
  EXPECT_EQ(first.exit_code(1), 0) << first.err();
  EXPECT_EQ(std::ranges::count(first.out(), '\n'), 1);
  EXPECT_THAT(ctl({"data", "A", "seat", "3"}), HasSubstr("done, and stored"));
  EXPECT_EQ(ctl({"data", "A", "seat"}), "3\n");
  EXPECT_THAT(ctl({"undo"}), HasSubstr("undo of operation"));
  (void)ctl({"send", "chat", "last"});
  ASSERT_TRUE(wait_until([&] { return events.out().find("\"last\"") != std::string::npos; })) << events.out();
  std::istringstream lines(events.out());
  std::vector<json> values;
  for (std::string line; std::getline(lines, line);) {
    const json event = json::parse(line, nullptr, false);
    ASSERT_TRUE(event.is_object()) << line;
    if (event["event"] == "data") values.push_back(event["value"]);
  }
  EXPECT_EQ(values, (std::vector<json>{"3", nullptr}));
  EXPECT_EQ(ctl({"conflicts"}), "");
}

// Adds nodes one by one and removes older ones, so that the world stays small.
class KilledPeer : public StoreProcess {
 protected:
  static constexpr int kKept = 20;

  static std::string node(int number) { return "N" + std::to_string(number); }
  // Until the peer does not answer any more.
  void edit_until_killed() {
    for (;; ++next_) {
      if (const int old = next_ - kKept; old >= 0) {
        tried_to_remove_.insert(old);
        const json state = made({{"do", "remove"}, {"path", node(old)}});
        if (state.is_object() && state.value("stored", false)) {
          removed_.insert(old);
          ++stored_;
        }
      }
      const json state = made(adding(node(next_)));
      if (!state.is_object()) break;
      if (state.value("stored", false)) {
        added_.insert(next_);
        ++stored_;
      }
    }
    ++next_;  // it may be there, or not
  }
  void expect_all_in(const std::string& world) const {
    for (const int each : added_) {
      if (tried_to_remove_.contains(each)) continue;
      EXPECT_THAT(world, HasSubstr("DEF " + node(each) + " "));
    }
    for (const int each : removed_) EXPECT_THAT(world, Not(HasSubstr("DEF " + node(each) + " ")));
  }

  int next_ = 0;
  std::set<int> added_, removed_, tried_to_remove_;  // removed_ and added_: called stored
  std::atomic<unsigned> stored_ = 0;                 // of both
};

TEST_F(KilledPeer, WhatIsStoredIsThereAfterwards) {
  const unsigned kills = number_in("PEERD_STORE_KILLS", 20), seed = number_in("PEERD_STORE_SEED", 1);
  std::cout << "PEERD_STORE_KILLS=" << kills << " PEERD_STORE_SEED=" << seed << std::endl;
  std::mt19937 random(seed);
  std::uniform_int_distribution<unsigned> edits(0, 6), later_us(0, 30'000);
  unsigned killed = 0;
  for (; killed < kills && !HasFailure(); ++killed) {
    Process peer = start();
    if (killed % 4 == 3) {  // while it opens its store
      std::this_thread::sleep_for(std::chrono::microseconds(later_us(random)));
    } else {
      ASSERT_TRUE(is_in_session("a")) << killed << ": " << peer.out() << peer.err();
      expect_all_in(world_of("a"));
      const unsigned enough = stored_ + edits(random);
      std::jthread editor([&] { edit_until_killed(); });
      EXPECT_TRUE(wait_until([&] { return stored_ >= enough; })) << peer.out();
      std::this_thread::sleep_for(std::chrono::microseconds(later_us(random)));
      peer.signal(SIGKILL);
    }
    peer.signal(SIGKILL);
    ASSERT_EQ(peer.exit_code(20), -1) << peer.out() << peer.err();
  }
  std::cout << "killed " << killed << " times; " << stored_ << " edits were called stored" << std::endl;
  EXPECT_GT(stored_, 0U);
  (void)error_of_check(0);
  Process exported(folder, "export", PEERD_PROGRAM,
                   {"store", "export", store_of("a").string(), "--world", (folder / "world.wrl").string()});
  EXPECT_EQ(exported.exit_code(60), 0) << exported.err();
  expect_all_in(exported.out());
}

TEST_F(StoreProcess, AllAreKilledAtOnceAndFindTheSameWorldAgain) {
  std::string before;
  {
    Process a = start("a"), b = start("b");
    ASSERT_TRUE(is_in_session("a") && is_in_session("b")) << a.out() << b.out();
    ASSERT_TRUE(is_stored(adding("N1", "translation 1 2 3"), "a"));
    ASSERT_TRUE(wait_until([&] { return world_of("b").find("DEF N1 ") != std::string::npos; }));
    ASSERT_TRUE(is_stored({{"do", "set"}, {"path", "N1"}, {"field", "translation"}, {"value", "4 5 6"}}, "b"));
    ASSERT_TRUE(is_stored({{"do", "remove"}, {"path", "A"}}, "b"));
    ASSERT_TRUE(wait_until([&] {
      before = world_of("a");
      return before.find("4 5 6") != std::string::npos && before.find("DEF A ") == std::string::npos;
    }));
    std::this_thread::sleep_for(std::chrono::milliseconds(300));  // what the other has made is written, too
    a.signal(SIGKILL);
    b.signal(SIGKILL);
    EXPECT_EQ(a.exit_code(20), -1);
    EXPECT_EQ(b.exit_code(20), -1);
  }
  for (const std::string alone : {"a", "b"}) {
    Process peer = start(alone);
    ASSERT_TRUE(is_in_session(alone)) << peer.out() << peer.err();
    EXPECT_EQ(world_of(alone), before) << alone;
    peer.signal(SIGTERM);
    EXPECT_EQ(peer.exit_code(20), 0) << peer.out() << peer.err();
  }
}

// Without a configuration a peer has a store in its user's folders, `--fresh` puts it aside, and "" is none.
TEST_F(StoreProcess, APeerWithoutAConfigurationHasAStoreOfItsOwn) {
  setenv("XDG_STATE_HOME", (folder / "state").c_str(), 1);
  const auto run = [&](std::vector<std::string> more) {
    std::vector<std::string> words{"run",
                                   "--world",
                                   (folder / "world.wrl").string(),
                                   "--name",
                                   "a",
                                   "--interface",
                                   "lo",
                                   "--port",
                                   std::to_string(own_port(9)),
                                   "--control",
                                   socket_of("a").string(),
                                   "--take-over"};
    words.insert(words.end(), more.begin(), more.end());
    return Process(folder, "peer", PEERD_PROGRAM, words);
  };
  const auto leaves = [&](Process& peer) {
    peer.signal(SIGTERM);
    return peer.exit_code(20) == 0;
  };
  {
    Process peer = run({});
    ASSERT_TRUE(is_in_session("a")) << peer.out() << peer.err();
    EXPECT_TRUE(is_stored(adding("N1")));
    EXPECT_TRUE(leaves(peer));
  }
  {
    Process peer = run({"--store", ""});
    ASSERT_TRUE(is_in_session("a")) << peer.out() << peer.err();
    EXPECT_THAT(world_of("a"), Not(HasSubstr("DEF N1 ")));
    EXPECT_FALSE(is_stored(adding("N2")));
    EXPECT_TRUE(leaves(peer));
  }
  {
    Process peer = run({});
    ASSERT_TRUE(is_in_session("a")) << peer.out() << peer.err();
    EXPECT_THAT(world_of("a"), AllOf(HasSubstr("DEF N1 "), Not(HasSubstr("DEF N2 "))));
    EXPECT_TRUE(leaves(peer));
  }
  Process peer = run({"--fresh"});
  ASSERT_TRUE(is_in_session("a")) << peer.out() << peer.err();
  EXPECT_THAT(world_of("a"), Not(HasSubstr("DEF N1 ")));
  EXPECT_THAT(peer.out(), AllOf(HasSubstr("the store before is now"), HasSubstr("a.before")));
  EXPECT_TRUE(leaves(peer));
  unsetenv("XDG_STATE_HOME");
  Process wrong(folder, "wrong", PEERD_PROGRAM,
                {"run", "--world", (folder / "world.wrl").string(), "--store", "", "--fresh"});
  EXPECT_EQ(wrong.exit_code(20), 2);
  EXPECT_THAT(wrong.err(), HasSubstr("say --store DIR"));
}

// A session that was begun anew does not get the edits of a joining peer that has a store of before.
class ASessionThatWasBegunAnew : public StoreProcess {
 protected:
  Process start(const std::string& name, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"run",
                                   "--world",
                                   (folder / "world.wrl").string(),
                                   "--world-name",
                                   world,
                                   "--id",
                                   std::to_string(name[0] - 'a' + 1),
                                   "--interface",
                                   "lo",
                                   "--port",
                                   std::to_string(own_port(9)),
                                   "--store",
                                   store_of(name).string(),
                                   "--take-over"};
    words.insert(words.end(), more.begin(), more.end());
    return ControlledPeers::start(name, words);
  }
  Process start_fresh(const std::string& name) const { return start(name, {"--fresh"}); }
  void leave(Process& peer) const {
    peer.signal(SIGTERM);
    EXPECT_EQ(peer.exit_code(20), 0) << peer.out() << peer.err();
  }
  // A peer that was alone once, and has a store with that node.
  void edit_alone(const std::string& name, const std::string& node) const {
    Process peer = start(name);
    ASSERT_TRUE(is_in_session(name)) << peer.out() << peer.err();
    ASSERT_TRUE(add(name, node));
    leave(peer);
  }
  [[nodiscard]] std::filesystem::path aside_of(const std::string& name) const {
    return store_of(name).string() + ".before";
  }

  const std::string world = "anew-" + std::to_string(getpid());  // called as nobody else's on this computer
};

TEST_F(ASessionThatWasBegunAnew, TakesNoOldEdits) {
  edit_alone("b", "OLD");
  {
    Process a = start_fresh("a");
    ASSERT_TRUE(is_in_session("a")) << a.out() << a.err();
    Process b = start("b");
    ASSERT_TRUE(wait_until([&] { return members_of("a") == 1 && members_of("b") == 1; })) << b.out() << b.err();
    ASSERT_TRUE(is_in_session("b")) << b.out();
    EXPECT_TRUE(b.says("brings its edits in", 1)) << b.out();
    ASSERT_TRUE(add("a", "NEW1") && add("b", "NEW2"));
    expect_one_world({"a", "b"}, {"NEW1", "NEW2"}, "both have edited");
    EXPECT_THAT(world_of("a"), Not(HasSubstr("OLD")));
    leave(a);
    leave(b);
  }
  {  // the new line goes on, whichever peer is first
    Process b = start("b");
    ASSERT_TRUE(is_in_session("b"));
    Process a = start("a");
    expect_one_world({"a", "b"}, {"NEW1", "NEW2"}, "both have come again");
    EXPECT_THAT(world_of("a"), Not(HasSubstr("OLD")));
    leave(a);
    leave(b);
  }
  ASSERT_TRUE(std::filesystem::exists(aside_of("b")));
  Process merge(folder, "merge", PEERD_PROGRAM, {"store", "merge", aside_of("b").string(), store_of("b").string()});
  EXPECT_EQ(merge.exit_code(20), 0) << merge.err();
  const Process a = start("a"), b = start("b");
  ASSERT_TRUE(is_in_session("a") && is_in_session("b"));
  expect_one_world({"a", "b"}, {"NEW1", "NEW2", "OLD"}, "the old edits were brought in");
}

TEST_F(ASessionThatWasBegunAnew, TakesNoOldEditsByJoin) {
  edit_alone("b", "OLD");
  const Process a = start_fresh("a");
  ASSERT_TRUE(is_in_session("a")) << a.out() << a.err();
  ASSERT_TRUE(add("a", "NEW"));
  const Process b = ControlledPeers::start(
      "b", {"join", world, "--interface", "lo", "--store", store_of("b").string(), "--take-over"});
  ASSERT_TRUE(wait_until([&] { return members_of("a") == 1 && members_of("b") == 1; })) << b.out() << b.err();
  expect_one_world({"a", "b"}, {"NEW"}, "the other one has joined");
  EXPECT_THAT(world_of("a"), Not(HasSubstr("OLD")));
  EXPECT_TRUE(std::filesystem::exists(aside_of("b"))) << b.out();
}

// A peer that begins anew where a session is here has the session's edits.
TEST_F(ASessionThatWasBegunAnew, IsJoinedByOneThatBeginsAnew) {
  edit_alone("b", "OLD");
  const Process a = start_fresh("a");
  ASSERT_TRUE(is_in_session("a") && add("a", "NEW")) << a.out() << a.err();
  const Process b = start_fresh("b");
  ASSERT_TRUE(wait_until([&] { return members_of("a") == 1 && members_of("b") == 1; })) << b.out() << b.err();
  expect_one_world({"a", "b"}, {"NEW"}, "the other one has come");
}

// A file system in memory of a few pages, which needs a privileged user.
class SmallDisk {
 public:
  SmallDisk(std::filesystem::path at, const char* size) : at_(std::move(at)) {
    std::filesystem::create_directories(at_);
    is_mounted_ = mount("peerd-test", at_.c_str(), "tmpfs", MS_NODEV | MS_NOSUID, size) == 0;
    if (!is_mounted_) why_ = std::strerror(errno);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  ~SmallDisk() {
    if (is_mounted_) umount2(at_.c_str(), MNT_DETACH);
  }
  [[nodiscard]] bool is_mounted() const { return is_mounted_; }
  [[nodiscard]] const std::string& why() const { return why_; }
  [[nodiscard]] bool make_read_only() const {
    return mount("peerd-test", at_.c_str(), "tmpfs", MS_REMOUNT | MS_RDONLY | MS_NODEV | MS_NOSUID, nullptr) == 0;
  }
  [[nodiscard]] bool resize(const char* size) const {
    return mount("peerd-test", at_.c_str(), "tmpfs", MS_REMOUNT | MS_NODEV | MS_NOSUID, size) == 0;
  }

 private:
  std::filesystem::path at_;
  bool is_mounted_ = false;
  std::string why_;
};

class FullDisk : public StoreProcess {
 protected:
  // Adds until nothing more is stored, several times: the file `author` that goes makes room once. Returns the nodes
  // that are stored.
  std::vector<std::string> fill() const {
    const std::string room = "children DEF X" + std::string(1500, 'x') + " Group { }";
    std::vector<std::string> stored;
    for (int i = 0, refused = 0; i < 400 && refused < 3; ++i) {
      const std::string node = "N" + std::to_string(i);
      if (is_stored(adding(node, room))) {
        stored.push_back(node);
        refused = 0;
      } else {
        ++refused;
      }
    }
    return stored;
  }
  static int count_of(const std::string& words, const std::string& text) {
    int count = 0;
    for (auto at = text.find(words); at != std::string::npos; at = text.find(words, at + 1)) ++count;
    return count;
  }
  [[nodiscard]] json counters() const { return ask("a", {{"do", "status"}}).value("counters", json::object()); }

  SmallDisk disk{store_of("a"), "size=256k"};
};

TEST_F(FullDisk, IsSaidOnceAndLosesNothingThatWasStored) {
  if (!disk.is_mounted()) GTEST_SKIP() << "cannot mount: " << disk.why();
  std::vector<std::string> stored;
  {
    Process peer = start();
    ASSERT_TRUE(is_in_session("a")) << peer.out() << peer.err();
    stored = fill();
    ASSERT_GT(stored.size(), 5U) << peer.out();
    ASSERT_LT(stored.size(), 390U);
    EXPECT_FALSE(is_stored(adding("LOST")));
    ASSERT_TRUE(peer.says("cannot be written", 20)) << peer.out();
    EXPECT_EQ(count_of("is the disk full?", peer.out()), 1 + count_of("can be written again", peer.out()));
    EXPECT_GE(counters().value("store_failures", 0), 4);
    EXPECT_FALSE(std::filesystem::exists(store_of("a") / "author"));
    peer.signal(SIGKILL);
    EXPECT_EQ(peer.exit_code(20), -1);
  }
  ASSERT_TRUE(disk.resize("size=16m"));
  Process peer = start();
  ASSERT_TRUE(is_in_session("a")) << peer.out() << peer.err();
  const std::string world = world_of("a");
  for (const std::string& node : stored) EXPECT_THAT(world, HasSubstr("DEF " + node + " "));
  EXPECT_TRUE(is_stored(adding("LATER")));
}

// The store of a running system that is mounted read-only, or of a backup.
TEST_F(StoreProcess, AStoreThatCanBeReadAloneIsCheckedAndExported) {
  const SmallDisk disk(folder / "disk", "size=4m");
  if (!disk.is_mounted()) GTEST_SKIP() << "cannot mount: " << disk.why();
  std::filesystem::create_directory_symlink(folder / "disk" / "store", store_of("a"));
  std::filesystem::create_directory(folder / "disk" / "store");
  {
    Process peer = start();
    ASSERT_TRUE(is_in_session("a") && add("a", "BALL")) << peer.out() << peer.err();
    peer.signal(SIGTERM);
    ASSERT_EQ(peer.exit_code(20), 0);
  }
  ASSERT_TRUE(disk.make_read_only());
  Process check(folder, "check", PEERD_PROGRAM, {"store", "check", store_of("a").string()});
  EXPECT_EQ(check.exit_code(20), 0) << check.err();
  EXPECT_THAT(check.out(), HasSubstr("1 operation"));
  Process written(folder, "export", PEERD_PROGRAM, {"store", "export", store_of("a").string()});
  EXPECT_EQ(written.exit_code(20), 0) << written.err();
  EXPECT_THAT(written.out(), HasSubstr("DEF BALL "));
  Process peer = start();
  ASSERT_TRUE(is_in_session("a")) << peer.out() << peer.err();
  EXPECT_TRUE(peer.says("keeps no edits from now on: its file system is read-only", 5)) << peer.out();
  EXPECT_THAT(world_of("a"), HasSubstr("DEF BALL "));
  EXPECT_TRUE(add("a", "CUBE")) << "it goes on without its store";
}

TEST_F(StoreProcess, ADiskThatIsFullAtTheStartIsSaid) {
  const SmallDisk disk(folder / "disk", "size=16k");
  if (!disk.is_mounted()) GTEST_SKIP() << "cannot mount: " << disk.why();
  std::ofstream(folder / "disk" / "full") << std::string(64 * 1024, 'x');
  std::filesystem::create_directory_symlink(folder / "disk" / "store", store_of("a"));
  std::error_code ignored;
  std::filesystem::create_directory(folder / "disk" / "store", ignored);
  Process peer = start();
  ASSERT_TRUE(is_in_session("a")) << peer.out() << peer.err();
  EXPECT_TRUE(peer.says("its disk is full", 5)) << peer.out();
}

// The name of a file may be no world's name.
TEST_F(StoreProcess, AWorldIsCalledByAnyFile) {
  const std::string shape = "#VRML V2.0 utf8\nDEF A Transform { children Shape { geometry Box { } } }\n";
  for (const std::string& name : {std::string(240, 'y') + "\n\xFF"}) {
    folder.write(name + ".wrl", shape);
    Process peer =
        ControlledPeers::start("n", {"run", "--world", (folder / (name + ".wrl")).string(), "--interface", "lo",
                                     "--port", std::to_string(own_port(10)), "--store", "", "--take-over"});
    ASSERT_TRUE(is_in_session("n")) << peer.out() << peer.err();
    Process ls(folder, "ls", PEERD_PROGRAM, {"ls", "--interface", "lo", "--json"});
    ASSERT_EQ(ls.exit_code(20), 0) << ls.err();
    std::string called;
    const json found = json::parse(ls.out());
    for (const json& world : found.at("worlds")) {
      const std::string each = world.at("name");
      if (each.find('~') != std::string::npos && each.substr(0, 3) == name.substr(0, 3)) called = each;
    }
    ASSERT_FALSE(called.empty()) << ls.out();
    Process joining = ControlledPeers::start("m", {"join", called, "--interface", "lo", "--store", "", "--take-over"});
    EXPECT_TRUE(is_in_session("m")) << joining.out() << joining.err();
  }
}

}  // namespace peerd::store_process_test
