#include "peerd/lab/chaos/simulated_disk.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>

namespace peerd::chaos::simulated_disk_test {

class SimulatedDiskTest : public testing::Test {
 protected:
  static SimulatedDisk disk_of(std::uint64_t seed) { return SimulatedDisk(Random(seed, 0)); }
  static std::string content(const SimulatedDisk& disk, const char* name) {
    const auto file = disk.find(name);
    if (!file) return "none";
    const auto bytes = disk.read(*file, 0, 1'000'000).value();
    return {bytes.begin(), bytes.end()};
  }
};

TEST_F(SimulatedDiskTest, AFileHasWhatWasWritten) {
  SimulatedDisk disk = disk_of(1);
  const auto file = disk.make("a").value();
  ASSERT_FALSE(disk.write(*file, 0, std::string_view("hello")));
  ASSERT_FALSE(disk.write(*file, 7, std::string_view("you")));
  EXPECT_EQ(content(disk, "a"), std::string("hello\0\0you", 10));
  ASSERT_FALSE(disk.truncate(*file, 2));
  EXPECT_EQ(content(disk, "a"), "he");
  ASSERT_FALSE(disk.rename("a", "b"));
  EXPECT_EQ(content(disk, "a"), "none");
  EXPECT_EQ(content(disk, "b"), "he");
  ASSERT_FALSE(disk.remove("b"));
  ASSERT_FALSE(disk.remove("b")) << "a file that is not there is no error";
  EXPECT_EQ(disk.rename("b", "c"), std::errc::no_such_file_or_directory);
}

TEST_F(SimulatedDiskTest, AnEndOfTheProcessLosesNothingAndAPowerCutWhatWasNotSynchronised) {
  std::set<std::string> contents;
  for (std::uint64_t seed = 1; seed <= 64; ++seed) {
    SimulatedDisk disk = disk_of(seed);
    const auto file = disk.make("a").value();
    const std::string first(2 * SimulatedDisk::kSector_bytes, 'x'), second(2 * SimulatedDisk::kSector_bytes, 'y');
    ASSERT_FALSE(disk.write(*file, 0, first));
    ASSERT_FALSE(disk.synchronise(*file));
    ASSERT_FALSE(disk.synchronise_names());
    ASSERT_FALSE(disk.write(*file, 0, second));
    disk.die();
    EXPECT_EQ(disk.write(*file, 0, first), std::errc::io_error);
    EXPECT_FALSE(disk.read(*file, 0, 1));
    disk.revive(false);
    ASSERT_EQ(content(disk, "a"), second);
    disk.revive(true);
    const std::string left = content(disk, "a");
    ASSERT_EQ(left.size(), first.size());
    contents.insert(left.substr(0, 1) + left.substr(SimulatedDisk::kSector_bytes, 1));
    EXPECT_EQ(left.substr(0, SimulatedDisk::kSector_bytes).find_first_not_of(left[0]), std::string::npos);
    disk.revive(true);
    EXPECT_EQ(content(disk, "a"), left) << "what is on the disk stays";
  }
  EXPECT_THAT(contents, testing::UnorderedElementsAre("xx", "xy", "yx", "yy"));
}

TEST_F(SimulatedDiskTest, NamesThatWereNotSynchronisedOutlastAPowerCutInTheirOrder) {
  std::set<std::string> seen;
  for (std::uint64_t seed = 1; seed <= 64; ++seed) {
    SimulatedDisk disk = disk_of(seed);
    ASSERT_TRUE(disk.make("old"));
    ASSERT_FALSE(disk.synchronise_names());
    ASSERT_TRUE(disk.make("new"));
    ASSERT_FALSE(disk.rename("new", "old"));
    ASSERT_FALSE(disk.remove("old"));
    disk.die();
    disk.revive(true);
    seen.insert(std::string(disk.find("old") ? "old " : "") + (disk.find("new") ? "new" : ""));
  }
  EXPECT_THAT(seen, testing::UnorderedElementsAre("old ", "old new", ""));
}

TEST_F(SimulatedDiskTest, AProcessEndsInTheMiddleOfAWrite) {
  std::set<std::size_t> sizes;
  for (std::uint64_t seed = 1; seed <= 64; ++seed) {
    SimulatedDisk disk = disk_of(seed);
    const auto file = disk.make("a").value();
    disk.die_at_write(2);
    ASSERT_FALSE(disk.write(*file, 0, std::string_view("ab")));
    ASSERT_TRUE(disk.write(*file, 2, std::string_view("cd")));
    ASSERT_TRUE(disk.is_dead());
    disk.revive(false);
    ASSERT_FALSE(disk.is_dead());
    sizes.insert(content(disk, "a").size());
  }
  EXPECT_THAT(sizes, testing::UnorderedElementsAre(2u, 3u, 4u));
}

TEST_F(SimulatedDiskTest, AFullDiskTakesWhatNeedsNoRoom) {
  SimulatedDisk disk = disk_of(1);
  const auto file = disk.make("a").value();
  ASSERT_FALSE(disk.write(*file, 0, std::string_view("ab")));
  disk.set_room(1);
  EXPECT_EQ(disk.write(*file, 2, std::string_view("cd")), std::errc::no_space_on_device);
  EXPECT_FALSE(disk.write(*file, 1, std::string_view("cd")));
  EXPECT_FALSE(disk.write(*file, 0, std::string_view("xyz")));
  EXPECT_EQ(disk.write(*file, 3, std::string_view("!")), std::errc::no_space_on_device);
  disk.set_room(std::nullopt);
  EXPECT_FALSE(disk.write(*file, 3, std::string_view("!")));
}

TEST_F(SimulatedDiskTest, ErrorsChangeNothing) {
  SimulatedDisk disk = disk_of(1);
  const auto file = disk.make("a").value();
  disk.set_error_rate(1.0);
  EXPECT_EQ(disk.write(*file, 0, std::string_view("ab")), std::errc::io_error);
  EXPECT_EQ(disk.synchronise(*file), std::errc::io_error);
  EXPECT_EQ(disk.remove("a"), std::errc::io_error);
  EXPECT_EQ(content(disk, "a"), "");
  EXPECT_FALSE(disk.is_dead());
  EXPECT_EQ(disk.counters().refused_error, 3u);
}

}  // namespace peerd::chaos::simulated_disk_test
