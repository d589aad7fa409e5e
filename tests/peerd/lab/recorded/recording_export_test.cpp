#include "peerd/lab/recorded/recording_export.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "peerd/input/compression.hpp"
#include "peerd/lab/recorded/stretch_writer.hpp"

namespace peerd::recording_export_test {

using testing::HasSubstr;
using testing::Not;

view::PoseRow row_of(view::PoseKind kind, std::uint32_t owner, std::uint16_t flags) {
  return {.owner = owner, .kind = static_cast<std::uint16_t>(kind), .flags = flags};
}

// All chunks of a file, unpacked: each begins behind "zstd" and the length of what is packed.
std::string contents(const std::string& file) {
  std::string all;
  for (std::size_t at = file.find("zstd"); at != std::string::npos; at = file.find("zstd", at + 1)) {
    std::size_t length = 0;
    for (int i = 7; i >= 0; --i) length = length << 8 | static_cast<unsigned char>(file.at(at + 4 + i));
    if (length > file.size()) continue;
    if (const auto part = decompress(std::string_view(file).substr(at + 12, length), 1 << 24)) all += *part;
  }
  return all;
}

// Returns the contents of the MCAP file of a recording in which peer 7 shows these rows.
std::string exported(const std::vector<view::PoseRow>& rows) {
  recorded::StretchWriter stretches;
  stretches.add(0.0, 1, 1, {}, rows);
  recorded::RecordedView view{
      .peer = PeerId{7}, .name = "a", .scenes = {}, .stretches = stretches.finish(), .events = {}, .errors = {}};
  view.scenes.push_back({.revision = 1, .glb = "", .why_not = "", .nodes = {{ObjectId{5}, "CAR"}}});
  view.events.push_back({0.5, R"({"event":"joined"})"});
  recorded::Recording recording;
  recording.views.push_back(view);
  std::ostringstream out;
  RecordingExport(out).add(recording, {});
  return contents(out.str());
}

TEST(RecordingExport, NamesFramesByViewAndPath) {
  using enum view::PoseKind;
  const std::string text =
      exported({row_of(kShown, 7, view::kOwn), row_of(kGhost, 7, 0), row_of(kTruth, 7, view::kOwn)});
  for (const char* const frame : {R"("child_frame_id":"a/CAR")", R"("child_frame_id":"a/ghost/CAR")",
                                  R"("child_frame_id":"truth/CAR")", R"("child_frame_id":"world")", "/a/events"}) {
    EXPECT_THAT(text, HasSubstr(frame));
  }
}

// In other views an object's truth is the same one: its owner's view says it.
TEST(RecordingExport, SaysATruthOnce) {
  EXPECT_THAT(exported({row_of(view::PoseKind::kTruth, 8, 0)}), Not(HasSubstr("truth/CAR")));
}

}  // namespace peerd::recording_export_test
