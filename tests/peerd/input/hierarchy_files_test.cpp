#include "peerd/input/hierarchy_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <string>

#include "collision/tree/hierarchy_file.hpp"
#include "tests/must.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::hierarchy_files_test {

using testing::HasSubstr;
using testing_support::ScratchFolder;
using testing_support::text_of;

std::string hierarchy(const std::string& rest) { return std::string(collision::kHierarchyMagic) + rest; }

TEST(HierarchyFiles, WhatIsWrittenIsMapped) {
  const ScratchFolder folder;
  const auto world = folder / "w.wrl";
  const auto load = mapped_hierarchies(world);
  EXPECT_FALSE(must(load("a.hierarchy"))) << "a missing file is no error: it is built instead";
  EXPECT_EQ(must(write_hierarchy_file(world, "a.hierarchy", hierarchy("one"))), folder / "a.hierarchy");
  const auto mapped = must(must(load("a.hierarchy")));
  const auto bytes = mapped.bytes;
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()), hierarchy("one"));
}

TEST(HierarchyFiles, AHierarchyFileIsReplacedInOneStepAndAMappedOneStays) {
  const ScratchFolder folder;
  const auto world = folder / "w.wrl";
  ASSERT_TRUE(write_hierarchy_file(world, "a", hierarchy("old")));
  const auto old = must(must(mapped_hierarchies(world)("a")));
  ASSERT_TRUE(write_hierarchy_file(world, "a", hierarchy("new")));
  const auto bytes = old.bytes;
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()), hierarchy("old"));
  EXPECT_EQ(text_of(folder / "a"), hierarchy("new"));
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) ++files;
  EXPECT_EQ(files, 1u) << "no temporary file is left";
}

TEST(HierarchyFiles, OtherFilesAreNeitherReplacedNorReached) {
  const ScratchFolder folder;
  const auto world = folder / "w.wrl";
  folder.write("notes.txt", "mine");
  EXPECT_THAT(write_hierarchy_file(world, "notes.txt", hierarchy("")).error(), HasSubstr("another file of that name"));
  EXPECT_EQ(text_of(folder / "notes.txt"), "mine");
  for (const char* outside : {"../a", "/tmp/a", "b/../../a", "%2e%2e/a"}) {
    EXPECT_THAT(write_hierarchy_file(world, outside, hierarchy("")).error(), HasSubstr("not in the folder")) << outside;
    EXPECT_FALSE(mapped_hierarchies(world)(outside)) << outside;
  }
  EXPECT_THAT(mapped_hierarchies(world)("http://a/b").error(), HasSubstr("no file of this machine"));
}

TEST(HierarchyFiles, FoldersAndEmptyFilesAreRefusedByName) {
  const ScratchFolder folder;
  folder.write("empty", "");
  std::filesystem::create_directory(folder / "folder");
  const auto load = mapped_hierarchies(folder / "w.wrl");
  EXPECT_EQ(load("empty").error(), "it is empty");
  EXPECT_EQ(load("folder").error(), "it is no regular file");
}

TEST(HierarchyFiles, APipeIsNotWaitedFor) {
  const ScratchFolder folder;
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_THAT(write_hierarchy_file(folder / "w.wrl", "pipe", hierarchy("")).error(),
              HasSubstr("another file of that name"));
}

}  // namespace peerd::hierarchy_files_test
